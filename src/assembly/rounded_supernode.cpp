#include "kluft/assembly/rounded_supernode.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "kluft/core/memory.hpp"

// Wide registers where the processor has them, as the BLAS takes them too.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define KLUFT_WIDE_REGISTERS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define KLUFT_WIDE_REGISTERS
#endif

namespace kluft {

namespace {

constexpr int width = rounded_padding + 1;
using Wide = double __attribute__((vector_size(width * sizeof(double))));
using WideFloat = float __attribute__((vector_size(width * sizeof(float))));

inline void load(const float* from, Wide& to) {
    WideFloat values;
    std::memcpy(&values, from, sizeof values);
    to = __builtin_convertvector(values, Wide);
}

inline void load(const double* from, Wide& to) { std::memcpy(&to, from, sizeof to); }

inline void store(const Wide& from, double* to) { std::memcpy(to, &from, sizeof from); }

constexpr int ahead = 256; ///< numbers (measured: 64 to 1 024 are alike)

/// Asks the memory for as many numbers as eight rows of four columns have, before they are needed: a factor is larger than
/// the caches, and a processor by itself follows its short columns too late (measured: 19 MB take twice the time).
inline void ask_for(const float* numbers) {
    constexpr int line = 16;
    __builtin_prefetch(numbers);
    __builtin_prefetch(numbers + line);
}

inline double sum(const Wide& v) { return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7])); }

} // namespace

float* round_in_place(double* values, std::size_t n) {
    constexpr std::size_t chunk = 1024;
    std::array<float, chunk> rounded{};
    auto* const bytes = reinterpret_cast<char*>(values);
    for (std::size_t first = 0; first < n; first += chunk) {
        const std::size_t size = std::min(chunk, n - first);
        for (std::size_t i = 0; i < size; ++i) rounded[i] = static_cast<float>(values[first + i]);
        std::memcpy(bytes + sizeof(float) * first, rounded.data(), sizeof(float) * size);
    }
    const std::array<float, rounded_padding> zeros{};
    std::memcpy(bytes + sizeof(float) * n, zeros.data(), sizeof zeros);
    give_back_pages(bytes + sizeof(float) * n + sizeof zeros, (sizeof(double) - sizeof(float)) * n - sizeof zeros);
    return reinterpret_cast<float*>(values);
}

// Four columns at a time, so that x is read and written once for four; by whole registers, up to `rounded_padding`
// numbers beyond the end, which count for nothing.

KLUFT_WIDE_REGISTERS void eliminate_forward(int n_columns, int n_rows, const float* l, double* x) {
    int j = 0;
    Wide la, lb, lc, ld, xi;
    for (; j + 4 <= n_columns; j += 4) {
        const float* const a = l + static_cast<std::ptrdiff_t>(j) * n_rows;
        const float* const b = a + n_rows;
        const float* const c = b + n_rows;
        const float* const d = c + n_rows;
        const double xa = x[j] / a[j];
        const double xb = (x[j + 1] - a[j + 1] * xa) / b[j + 1];
        const double xc = (x[j + 2] - a[j + 2] * xa - b[j + 2] * xb) / c[j + 2];
        const double xd = (x[j + 3] - a[j + 3] * xa - b[j + 3] * xb - c[j + 3] * xc) / d[j + 3];
        x[j] = xa;
        x[j + 1] = xb;
        x[j + 2] = xc;
        x[j + 3] = xd;
        const float* const next = d + n_rows + ahead;
        for (int i = j + 4; i < n_rows; i += width) {
            ask_for(next + 4 * (i - j - 4));
            load(a + i, la);
            load(b + i, lb);
            load(c + i, lc);
            load(d + i, ld);
            load(x + i, xi);
            store(xi - (la * xa + lb * xb + lc * xc + ld * xd), x + i);
        }
    }
    for (; j < n_columns; ++j) {
        const float* const a = l + static_cast<std::ptrdiff_t>(j) * n_rows;
        const double xa = x[j] / a[j];
        x[j] = xa;
        for (int i = j + 1; i < n_rows; i += width) {
            load(a + i, la);
            load(x + i, xi);
            store(xi - la * xa, x + i);
        }
    }
}

KLUFT_WIDE_REGISTERS void substitute_back(int n_columns, int n_rows, const float* l, double* x) {
    std::fill_n(x + n_rows, rounded_padding, 0.0);
    int end = n_columns;
    Wide la, lb, lc, ld, xi;
    for (; end % 4 != 0; --end) {
        const float* const a = l + static_cast<std::ptrdiff_t>(end - 1) * n_rows;
        Wide sum_a{};
        for (int i = end; i < n_rows; i += width) {
            load(a + i, la);
            load(x + i, xi);
            sum_a += la * xi;
        }
        x[end - 1] = (x[end - 1] - sum(sum_a)) / a[end - 1];
    }
    for (; end > 0; end -= 4) {
        const int j = end - 4;
        const float* const a = l + static_cast<std::ptrdiff_t>(j) * n_rows;
        const float* const b = a + n_rows;
        const float* const c = b + n_rows;
        const float* const d = c + n_rows;
        const float* const next = a - 4 * static_cast<std::ptrdiff_t>(n_rows) - ahead;
        Wide sum_a{}, sum_b{}, sum_c{}, sum_d{};
        for (int i = end; i < n_rows; i += width) {
            ask_for(next + 4 * (i - end));
            load(a + i, la);
            load(b + i, lb);
            load(c + i, lc);
            load(d + i, ld);
            load(x + i, xi);
            sum_a += la * xi;
            sum_b += lb * xi;
            sum_c += lc * xi;
            sum_d += ld * xi;
        }
        x[j + 3] = (x[j + 3] - sum(sum_d)) / d[j + 3];
        x[j + 2] = (x[j + 2] - sum(sum_c) - c[j + 3] * x[j + 3]) / c[j + 2];
        x[j + 1] = (x[j + 1] - sum(sum_b) - b[j + 2] * x[j + 2] - b[j + 3] * x[j + 3]) / b[j + 1];
        x[j] = (x[j] - sum(sum_a) - a[j + 1] * x[j + 1] - a[j + 2] * x[j + 2] - a[j + 3] * x[j + 3]) / a[j];
    }
}

} // namespace kluft

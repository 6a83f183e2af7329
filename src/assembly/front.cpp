#include "kluft/assembly/front.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "kluft/assembly/blas.hpp"

// Wide registers where the processor has them, as the BLAS takes them too.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define KLUFT_WIDEST_REGISTERS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define KLUFT_WIDEST_REGISTERS
#endif

namespace kluft {

namespace {

constexpr int panel_width = 128; ///< columns that are eliminated together
constexpr int chunk_rows = 256;  ///< rows of a panel that one call treats
constexpr int tile_width = 256;  ///< of the rest
constexpr int tile_rows = 1024;
constexpr int narrow = 12; ///< columns that the loops here treat, without the BLAS

constexpr int n_lanes = 16;
using Lanes = float __attribute__((vector_size(n_lanes * sizeof(float))));

std::ptrdiff_t at(int row, int column, int ld) { return row + static_cast<std::ptrdiff_t>(column) * ld; }

inline void load(const float* from, Lanes& to) { std::memcpy(&to, from, sizeof to); }
inline void store(const Lanes& from, float* to) { std::memcpy(to, &from, sizeof from); }

/// X := X L'^-1 for `width` columns and n rows, sixteen rows at a time.
template <int width>
inline __attribute__((always_inline)) void solve_lanes(int n, const float* l, int ldl, float* x, int ldx) {
    float inverse[width];
    for (int j = 0; j < width; ++j) inverse[j] = 1.0F / l[at(j, j, ldl)];
    Lanes rows[width];
    int i = 0;
    for (; i + n_lanes <= n; i += n_lanes) {
#pragma GCC unroll 12
        for (int j = 0; j < width; ++j) {
            load(x + at(i, j, ldx), rows[j]);
#pragma GCC unroll 12
            for (int k = 0; k < j; ++k) rows[j] -= rows[k] * l[at(j, k, ldl)];
            rows[j] *= inverse[j];
            store(rows[j], x + at(i, j, ldx));
        }
    }
    for (; i < n; ++i) {
        float row[width];
        for (int j = 0; j < width; ++j) {
            row[j] = x[at(i, j, ldx)];
            for (int k = 0; k < j; ++k) row[j] -= row[k] * l[at(j, k, ldl)];
            row[j] *= inverse[j];
            x[at(i, j, ldx)] = row[j];
        }
    }
}

KLUFT_WIDEST_REGISTERS void solve_narrow_rows(int width, int n, const float* l, int ldl, float* x, int ldx) {
    switch (width) {
    case 3:
        return solve_lanes<3>(n, l, ldl, x, ldx);
    case 6:
        return solve_lanes<6>(n, l, ldl, x, ldx);
    case 9:
        return solve_lanes<9>(n, l, ldl, x, ldx);
    case 12:
        return solve_lanes<12>(n, l, ldl, x, ldx);
    default:
        for (int j = 0; j < width; ++j) {
            for (int k = 0; k < j; ++k) {
                for (int i = 0; i < n; ++i) x[at(i, j, ldx)] -= x[at(i, k, ldx)] * l[at(j, k, ldl)];
            }
            for (int i = 0; i < n; ++i) x[at(i, j, ldx)] /= l[at(j, j, ldl)];
        }
    }
}

/// Columns of the first of two halves; a multiple of three, as the unknowns of a block are.
int first_half(int n) { return n / 2 / 6 * 6 >= 6 ? n / 2 / 6 * 6 : n / 2; }

/// X := X L'^-1, n rows.
void solve_rows(int width, int n, const float* l, int ldl, float* x, int ldx) {
    if (width <= narrow) return solve_narrow_rows(width, n, l, ldl, x, ldx);
    const int half = first_half(width);
    const int rest = width - half;
    solve_rows(half, n, l, ldl, x, ldx);
    subtract_product(n, rest, half, x, ldx, l + half, ldl, x + at(0, half, ldx), ldx);
    solve_rows(rest, n, l + at(half, half, ldl), ldl, x + at(0, half, ldx), ldx);
}

/// A pivot that is smaller than the least one is raised to it, which adds to `n_raised`; nothing where it is no number.
std::optional<float> raised(float pivot, float least, int& n_raised) {
    if (!(least > 0.0F && std::abs(pivot) <= std::numeric_limits<float>::max())) return std::nullopt;
    if (std::abs(pivot) >= least) return pivot;
    ++n_raised;
    return std::copysign(least, pivot);
}

/// L L' of the diagonal block of a panel. False if a pivot is too small to be raised.
bool factorize_narrow(int n, float* a, int lda, const float* least, int& n_raised) {
    for (int j = 0; j < n; ++j) {
        if (a[at(j, j, lda)] < -least[j]) return false;
        const auto pivot = raised(a[at(j, j, lda)], least[j], n_raised);
        if (!pivot) return false;
        const float root = std::sqrt(std::abs(*pivot));
        a[at(j, j, lda)] = root;
        const float inverse = 1.0F / root;
        for (int i = j + 1; i < n; ++i) a[at(i, j, lda)] *= inverse;
        for (int k = j + 1; k < n; ++k) {
            const float factor = a[at(k, j, lda)];
            for (int i = k; i < n; ++i) a[at(i, k, lda)] -= a[at(i, j, lda)] * factor;
        }
    }
    return true;
}

/// L U of the same; u: the transpose of the upper triangle.
bool factorize_narrow(int n, float* l, float* u, int ld, const float* least, int& n_raised) {
    for (int j = 0; j < n; ++j) {
        const auto pivot = raised(l[at(j, j, ld)], least[j], n_raised);
        if (!pivot) return false;
        l[at(j, j, ld)] = *pivot;
        u[at(j, j, ld)] = 1.0F;
        const float inverse = 1.0F / *pivot;
        for (int i = j + 1; i < n; ++i) u[at(i, j, ld)] *= inverse;
        for (int k = j + 1; k < n; ++k) {
            const float of_l = l[at(k, j, ld)];
            const float of_u = u[at(k, j, ld)];
            for (int i = k; i < n; ++i) l[at(i, k, ld)] -= l[at(i, j, ld)] * of_u;
            for (int i = k + 1; i < n; ++i) u[at(i, k, ld)] -= u[at(i, j, ld)] * of_l;
        }
    }
    return true;
}

/// One of the two triangles of a panel or of the rest with the other one, which of a symmetric matrix is the same.
struct Side {
    FrontTriangle own;
    FrontTriangle other;
};

/// Both triangles of an unsymmetric front, each beside the other; the only one of a symmetric front.
struct Sides {
    std::array<Side, 2> all;
    int n = 0;
    [[nodiscard]] const Side* begin() const { return all.data(); }
    [[nodiscard]] const Side* end() const { return all.data() + n; }
};

Sides sides_of(const Front& front) {
    if (front.is_symmetric()) return {{{{front.lower, front.lower}, {}}}, 1};
    return {{{{front.lower, front.upper}, {front.upper, front.lower}}}, 2};
}

/// C := C - A B', of n x n numbers; where A is B only the lower triangle.
void subtract_square_product(int n, int k, const float* a, const float* b, int ld, float* c, int ldc) {
    if (a == b) return subtract_square(n, k, a, ld, c, ldc);
    subtract_product(n, n, k, a, ld, b, ld, c, ldc);
}

/// The diagonal block of a panel; `upper` is nullptr for L L'. False if a pivot is no number or too small.
bool factorize_diagonal(int n, float* lower, float* upper, int ld, const float* least, int& n_raised) {
    const bool is_symmetric = upper == nullptr;
    if (n <= narrow) {
        return is_symmetric ? factorize_narrow(n, lower, ld, least, n_raised)
                            : factorize_narrow(n, lower, upper, ld, least, n_raised);
    }
    const int half = first_half(n);
    const int rest = n - half;
    if (!factorize_diagonal(half, lower, upper, ld, least, n_raised)) return false;
    float* const rest_of_upper = is_symmetric ? nullptr : upper + at(half, half, ld);
    if (is_symmetric) upper = lower;
    solve_rows(half, rest, upper, ld, lower + half, ld);
    if (!is_symmetric) solve_rows(half, rest, lower, ld, upper + half, ld);
    float* const rest_of_lower = lower + at(half, half, ld);
    subtract_square_product(rest, half, lower + half, upper + half, ld, rest_of_lower, ld);
    if (!is_symmetric) subtract_square_product(rest, half, upper + half, lower + half, ld, rest_of_upper, ld);
    return factorize_diagonal(rest, rest_of_lower, rest_of_upper, ld, least + half, n_raised);
}

int n_parts(int n, int size) { return (n + size - 1) / size; }

/// A part of the rest: rows of a strip of columns, from the diagonal down.
struct Tile {
    int column = 0;
    int width = 0;
    int row = 0;
    int n_rows = 0;
};

/// Number i of those that cover the lower triangle of n x n, by strips.
Tile tile(int n, int i) {
    for (int column = 0;; column += tile_width) {
        const int n_tiles = n_parts(n - column, tile_rows);
        if (i >= n_tiles) {
            i -= n_tiles;
            continue;
        }
        const int row = column + i * tile_rows;
        return {column, std::min(tile_width, n - column), row, std::min(tile_rows, n - row)};
    }
}

int n_tiles(int n) {
    int count = 0;
    for (int column = 0; column < n; column += tile_width) count += n_parts(n - column, tile_rows);
    return count;
}

void subtract_tile(const Front& front, const Side& side, const Tile& tile) {
    const int ld = front.n_rows();
    const float* const below = side.own.columns + front.n_columns;
    const float* const other_below = side.other.columns + front.n_columns;
    int row = tile.row;
    int n_rows = tile.n_rows;
    if (row == tile.column) {
        subtract_square_product(tile.width, front.n_columns, below + row, other_below + row, ld,
                                side.own.rest + at(row, row, front.n_below), front.n_below);
        row += tile.width;
        n_rows -= tile.width;
    }
    if (n_rows <= 0) return;
    subtract_product(n_rows, tile.width, front.n_columns, below + row, ld, other_below + tile.column, ld,
                     side.own.rest + at(row, tile.column, front.n_below), front.n_below);
}

/// The rows of a panel below its diagonal block, which is factorized.
void solve_panel(const Front& front, const Side& side, int first, int width, int row, int n) {
    const int ld = front.n_rows();
    float* const rows = side.own.columns + at(row, first, ld);
    if (first > 0)
        subtract_product(n, width, first, side.own.columns + row, ld, side.other.columns + first, ld, rows, ld);
    solve_rows(width, n, side.other.columns + at(first, first, ld), ld, rows, ld);
}

} // namespace

std::optional<int> factorize(const Front& front, const Sharing& share) {
    int n_raised = 0;
    const int ld = front.n_rows();
    const Sides sides = sides_of(front);
    for (int first = 0; first < front.n_columns; first += panel_width) {
        const int width = std::min(panel_width, front.n_columns - first);
        for (const Side& side : sides) {
            if (first == 0) break;
            subtract_square_product(width, first, side.own.columns + first, side.other.columns + first, ld,
                                    side.own.columns + at(first, first, ld), ld);
        }
        float* const upper = front.is_symmetric() ? nullptr : front.upper.columns + at(first, first, ld);
        if (!factorize_diagonal(width, front.lower.columns + at(first, first, ld), upper, ld,
                                front.least_pivots + first, n_raised))
            return std::nullopt;
        const int below = first + width;
        share(n_parts(ld - below, chunk_rows), [&](int i) {
            const int row = below + i * chunk_rows;
            for (const Side& side : sides) solve_panel(front, side, first, width, row, std::min(chunk_rows, ld - row));
        });
    }
    share(n_tiles(front.n_below), [&](int i) {
        for (const Side& side : sides) subtract_tile(front, side, tile(front.n_below, i));
    });
    return n_raised;
}

} // namespace kluft

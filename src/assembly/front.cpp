#include "kluft/assembly/front.hpp"

#include <algorithm>
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

/// L L' of the diagonal block of a panel. Adds to `n_raised`; false if a pivot is too small to be raised.
bool factorize_narrow(int n, float* a, int lda, const float* least, int& n_raised) {
    for (int j = 0; j < n; ++j) {
        float pivot = a[at(j, j, lda)];
        if (!(least[j] > 0.0F && pivot >= -least[j] && pivot <= std::numeric_limits<float>::max())) return false;
        if (pivot < least[j]) {
            pivot = least[j];
            ++n_raised;
        }
        const float root = std::sqrt(pivot);
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

bool factorize_diagonal(int n, float* a, int lda, const float* least, int& n_raised) {
    if (n <= narrow) return factorize_narrow(n, a, lda, least, n_raised);
    const int half = first_half(n);
    const int rest = n - half;
    if (!factorize_diagonal(half, a, lda, least, n_raised)) return false;
    solve_rows(half, rest, a, lda, a + half, lda);
    subtract_square(rest, half, a + half, lda, a + at(half, half, lda), lda);
    return factorize_diagonal(rest, a + at(half, half, lda), lda, least + half, n_raised);
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

void subtract_tile(const Front& front, const Tile& tile) {
    const int ld = front.n_columns + front.n_below;
    const float* const below = front.columns + front.n_columns;
    int row = tile.row;
    int n_rows = tile.n_rows;
    if (row == tile.column) {
        subtract_square(tile.width, front.n_columns, below + row, ld, front.rest + at(row, row, front.n_below),
                        front.n_below);
        row += tile.width;
        n_rows -= tile.width;
    }
    if (n_rows <= 0) return;
    subtract_product(n_rows, tile.width, front.n_columns, below + row, ld, below + tile.column, ld,
                     front.rest + at(row, tile.column, front.n_below), front.n_below);
}

} // namespace

std::optional<int> factorize(const Front& front, const Sharing& share) {
    int n_raised = 0;
    const int n_rows = front.n_columns + front.n_below;
    for (int first = 0; first < front.n_columns; first += panel_width) {
        const int width = std::min(panel_width, front.n_columns - first);
        float* const diagonal = front.columns + at(first, first, n_rows);
        const float* const before = front.columns + first; // rows of L in the columns before
        if (first > 0) subtract_square(width, first, before, n_rows, diagonal, n_rows);
        if (!factorize_diagonal(width, diagonal, n_rows, front.least_pivots + first, n_raised)) return std::nullopt;
        const int below = first + width;
        share(n_parts(n_rows - below, chunk_rows), [&](int i) {
            const int row = below + i * chunk_rows;
            const int n = std::min(chunk_rows, n_rows - row);
            float* const rows = front.columns + at(row, first, n_rows);
            if (first > 0) subtract_product(n, width, first, front.columns + row, n_rows, before, n_rows, rows, n_rows);
            solve_rows(width, n, diagonal, n_rows, rows, n_rows);
        });
    }
    share(n_tiles(front.n_below), [&](int i) { subtract_tile(front, tile(front.n_below, i)); });
    return n_raised;
}

} // namespace kluft

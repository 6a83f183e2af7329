// Partial factorization L L' or L U of a dense matrix, a front, in single precision and without pivoting. It is divided
// into parts of fixed sizes, so that the result does not depend on who computes which.
#pragma once

#include <functional>
#include <optional>

namespace kluft {

/// Does body(i) for all i < n, in any order.
using Sharing = std::function<void(int n, const std::function<void(int)>& body)>;

/// A lower triangle of a front of n_columns + n_below rows, by columns.
struct FrontTriangle {
    float* columns = nullptr; ///< (n_columns + n_below) x n_columns: those that are eliminated
    float* rest = nullptr;    ///< n_below x n_below: becomes what they leave of it
};

/// The columns of `lower` become those of L. Of an unsymmetric matrix `upper` is the transpose of its upper triangle, and
/// becomes that of a U with ones on its diagonal; of a symmetric one it is empty, and the matrix becomes L L'. What stands
/// above the diagonal of a triangle is not used, but finite.
struct Front {
    int n_columns = 0;
    int n_below = 0;
    FrontTriangle lower;
    FrontTriangle upper;
    const float* least_pivots = nullptr; ///< positive, per column

    [[nodiscard]] int n_rows() const { return n_columns + n_below; }
    [[nodiscard]] bool is_symmetric() const { return upper.columns == nullptr; }
};

/// The number of pivots that were smaller than the least one of their column, and were raised to it. Nothing if a pivot is
/// no number, or that of a symmetric matrix below the negative of the least one.
[[nodiscard]] std::optional<int> factorize(const Front& front, const Sharing& share);

} // namespace kluft

// Partial Cholesky factorization of a dense symmetric matrix, a front, in single precision. It is divided into parts of
// fixed sizes, so that the result does not depend on who computes which.
#pragma once

#include <functional>
#include <optional>

namespace kluft {

/// Does body(i) for all i < n, in any order.
using Sharing = std::function<void(int n, const std::function<void(int)>& body)>;

/// A front of n_columns + n_below rows. Its first columns become those of L; the rest, what they leave of it.
struct Front {
    int n_columns = 0;
    int n_below = 0;
    float* columns = nullptr;            ///< (n_columns + n_below) x n_columns, by columns; lower triangle
    float* rest = nullptr;               ///< n_below x n_below, by columns; lower triangle
    const float* least_pivots = nullptr; ///< positive, per column
};

/// The number of pivots that were raised to the least one of their column. Nothing if one was below the negative of that, or
/// is no number.
[[nodiscard]] std::optional<int> factorize(const Front& front, const Sharing& share);

} // namespace kluft

// Columns of a factor kept in single precision. A triangular solution is bound by the memory that it reads: with half of
// it, it takes half the time (measured at 5 000 blocks: 2.5 ms instead of 4.4). All arithmetic is in double precision, so
// that what is solved is exactly the rounded factor.
#pragma once

#include <cstddef>

namespace kluft {

inline constexpr int rounded_padding = 7; ///< numbers that may be read beyond the end of a supernode or a vector

/// Rounds n numbers in their own memory, the first half of which then holds the result, followed by `rounded_padding`
/// zeros; what is behind goes back to the system. n >= rounded_padding.
float* round_in_place(double* values, std::size_t n);

/// Forward elimination with one supernode, stored by columns (n_rows x n_columns, the upper triangle of the top not
/// used but finite). x has n_rows and room for `rounded_padding` more: the top becomes the solution, from the rest L_below x_top is subtracted.
void eliminate_forward(int n_columns, int n_rows, const float* l, double* x);

/// Back substitution: solves L_top' x_top = b_top - L_below' x_below; x holds (b_top, x_below) and becomes
/// (x_top, x_below), with room for `rounded_padding` more.
void substitute_back(int n_columns, int n_rows, const float* l, double* x);

} // namespace kluft

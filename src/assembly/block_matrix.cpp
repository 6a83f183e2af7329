#include "kluft/assembly/block_matrix.hpp"

#include <algorithm>

namespace kluft {

BlockPattern::BlockPattern(int n_blocks, const std::vector<std::pair<int, int>>& pairs) {
    std::vector<std::pair<int, int>> entries;
    entries.reserve(2 * pairs.size() + static_cast<std::size_t>(n_blocks));
    for (int b = 0; b < n_blocks; ++b) entries.emplace_back(b, b);
    for (const auto& [a, b] : pairs) {
        entries.emplace_back(a, b);
        entries.emplace_back(b, a);
    }
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    row_starts_.assign(static_cast<std::size_t>(n_blocks) + 1, 0);
    columns_.reserve(entries.size());
    for (const auto& [row, column] : entries) {
        ++row_starts_[row + 1];
        columns_.push_back(column);
    }
    for (int b = 0; b < n_blocks; ++b) row_starts_[b + 1] += row_starts_[b];
    diagonal_.reserve(static_cast<std::size_t>(n_blocks));
    for (int b = 0; b < n_blocks; ++b) diagonal_.push_back(find(b, b));
}

int BlockPattern::find(int row, int column) const {
    const auto first = columns_.begin() + row_starts_[row];
    const auto last = columns_.begin() + row_starts_[row + 1];
    const auto it = std::lower_bound(first, last, column);
    return it != last && *it == column ? static_cast<int>(it - columns_.begin()) : -1;
}

void BlockMatrix::reset(const BlockPattern& new_pattern) {
    pattern = &new_pattern;
    values.assign(static_cast<std::size_t>(new_pattern.n_entries()), Mat6::Zero());
}

void BlockMatrix::set_zero() { std::fill(values.begin(), values.end(), Mat6::Zero()); }

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    y.resize(x.size());
    for (int row = 0; row < pattern->n_blocks(); ++row) {
        Vec6 sum = Vec6::Zero();
        for (int entry = pattern->row_start(row); entry < pattern->row_start(row + 1); ++entry) {
            sum.noalias() += values[entry] * x.segment<n_block_unknowns>(n_block_unknowns * pattern->column(entry));
        }
        y.segment<n_block_unknowns>(n_block_unknowns * row) = sum;
    }
}

void BlockMatrix::multiply_transposed(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    y.setZero(x.size());
    for (int row = 0; row < pattern->n_blocks(); ++row) {
        const auto x_row = x.segment<n_block_unknowns>(n_block_unknowns * row);
        for (int entry = pattern->row_start(row); entry < pattern->row_start(row + 1); ++entry) {
            y.segment<n_block_unknowns>(n_block_unknowns * pattern->column(entry)).noalias() +=
                values[entry].transpose() * x_row;
        }
    }
}

} // namespace kluft

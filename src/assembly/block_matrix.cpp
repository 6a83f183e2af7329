#include "kluft/assembly/block_matrix.hpp"

#include <algorithm>

namespace kluft {

namespace {

template <int n, class Entries>
void multiply_entries(const BlockPattern& pattern, const Entries& entries, const Eigen::VectorXd& x,
                      Eigen::VectorXd& y) {
    for (int row = 0; row < pattern.n_blocks(); ++row) {
        Eigen::Matrix<double, n, 1> sum = Eigen::Matrix<double, n, 1>::Zero();
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            sum.noalias() += entries[entry] * x.segment<n>(n * pattern.column(entry));
        }
        y.segment<n>(n * row) = sum;
    }
}

template <int n, class Entries>
void multiply_transposed_entries(const BlockPattern& pattern, const Entries& entries, const Eigen::VectorXd& x,
                                 Eigen::VectorXd& y) {
    for (int row = 0; row < pattern.n_blocks(); ++row) {
        const auto x_row = x.segment<n>(n * row);
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            y.segment<n>(n * pattern.column(entry)).noalias() += entries[entry].transpose() * x_row;
        }
    }
}

template <class Entries> double squared_norm_of(const Entries& entries) {
    double sum = 0.0;
    for (const auto& entry : entries) sum += entry.squaredNorm();
    return sum;
}

template <class Entries> double trace_of(const BlockPattern& pattern, const Entries& entries) {
    double sum = 0.0;
    for (int b = 0; b < pattern.n_blocks(); ++b) sum += entries[pattern.diagonal(b)].trace();
    return sum;
}

} // namespace

BlockPattern::BlockPattern(int n_blocks, const std::vector<std::pair<int, int>>& pairs, Kinematics kinematics)
    : kinematics_(kinematics) {
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
    const auto n_entries = static_cast<std::size_t>(new_pattern.n_entries());
    values.resize(is_rigid() ? 0 : n_entries);
    rigid_values.resize(is_rigid() ? n_entries : 0);
    set_zero();
}

void BlockMatrix::set_zero() {
    std::fill(values.begin(), values.end(), Mat6::Zero());
    std::fill(rigid_values.begin(), rigid_values.end(), Mat3::Zero());
}

double BlockMatrix::squared_norm() const {
    return is_rigid() ? squared_norm_of(rigid_values) : squared_norm_of(values);
}

double BlockMatrix::trace() const { return is_rigid() ? trace_of(*pattern, rigid_values) : trace_of(*pattern, values); }

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    y.resize(x.size());
    if (is_rigid()) return multiply_entries<n_rigid_unknowns>(*pattern, rigid_values, x, y);
    multiply_entries<n_block_unknowns>(*pattern, values, x, y);
}

void BlockMatrix::multiply_transposed(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
    y.setZero(x.size());
    if (is_rigid()) return multiply_transposed_entries<n_rigid_unknowns>(*pattern, rigid_values, x, y);
    multiply_transposed_entries<n_block_unknowns>(*pattern, values, x, y);
}

} // namespace kluft

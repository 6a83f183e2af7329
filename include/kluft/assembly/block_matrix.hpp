// The stiffness matrix: 6 x 6 blocks on a fixed pattern of block pairs.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

/// Which pairs of blocks have an entry, row by row, columns ascending; structurally symmetric with a full diagonal.
class BlockPattern {
public:
    BlockPattern() = default;
    /// `pairs`: (a, b) with a != b, any order, duplicates allowed.
    BlockPattern(int n_blocks, const std::vector<std::pair<int, int>>& pairs);

    [[nodiscard]] int n_blocks() const { return static_cast<int>(row_starts_.size()) - 1; }
    [[nodiscard]] int n_entries() const { return static_cast<int>(columns_.size()); }
    [[nodiscard]] int row_start(int row) const { return row_starts_[row]; }
    [[nodiscard]] int column(int entry) const { return columns_[entry]; }
    [[nodiscard]] int diagonal(int row) const { return diagonal_[row]; }
    /// Entry (row, column), -1 if the pattern lacks it.
    [[nodiscard]] int find(int row, int column) const;

private:
    std::vector<int> row_starts_{0};
    std::vector<int> columns_;
    std::vector<int> diagonal_; ///< entry (row, row)
};

/// Values on a pattern; entry k is a 6 x 6 block.
struct BlockMatrix {
    const BlockPattern* pattern = nullptr;
    std::vector<Mat6> values;

    void reset(const BlockPattern& new_pattern);
    /// Gives the memory of the values back.
    void release() { values = std::vector<Mat6>(); }
    void set_zero();
    /// y = K x, sizes 6 n_blocks.
    void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
    /// y = K^T x.
    void multiply_transposed(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
};

} // namespace kluft

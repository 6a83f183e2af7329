// The stiffness matrix on a fixed pattern of block pairs: blocks of 6 x 6, or of 3 x 3 for rigid blocks.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/kinematics/affine.hpp"
#include "kluft/kinematics/rigid.hpp"

namespace kluft {

/// Which pairs of blocks have an entry, row by row, columns ascending; structurally symmetric with a full diagonal.
class BlockPattern {
public:
    BlockPattern() = default;
    /// `pairs`: (a, b) with a != b, any order, duplicates allowed.
    BlockPattern(int n_blocks, const std::vector<std::pair<int, int>>& pairs,
                 Kinematics kinematics = Kinematics::affine);

    [[nodiscard]] Kinematics kinematics() const { return kinematics_; }
    /// Unknowns per block: 6, or 3 of rigid ones.
    [[nodiscard]] int block_unknowns() const { return unknowns_per_block(kinematics_); }
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
    Kinematics kinematics_ = Kinematics::affine;
};

/// Values on a pattern; entry k is a 6 x 6 block in `values`, or on the pattern of rigid blocks a 3 x 3 block in
/// `rigid_values`; the other one is empty.
struct BlockMatrix {
    const BlockPattern* pattern = nullptr;
    std::vector<Mat6> values;
    std::vector<Mat3> rigid_values;

    void reset(const BlockPattern& new_pattern);
    /// Gives the memory of the values back.
    void release() {
        values = std::vector<Mat6>();
        rigid_values = std::vector<Mat3>();
    }
    void set_zero();
    [[nodiscard]] bool is_rigid() const { return pattern->kinematics() == Kinematics::rigid; }
    /// The sum of the squares of all entries, and of the diagonal entries alone the sum.
    [[nodiscard]] double squared_norm() const;
    [[nodiscard]] double trace() const;
    /// y = K x, sizes block_unknowns() n_blocks.
    void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
    /// y = K^T x.
    void multiply_transposed(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
};

} // namespace kluft

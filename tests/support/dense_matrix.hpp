// The dense twin of the block matrix.
#pragma once

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"

namespace kluft {

inline Eigen::MatrixXd dense(const BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    const int nu = pattern.block_unknowns();
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(nu * pattern.n_blocks(), nu * pattern.n_blocks());
    for (int row = 0; row < pattern.n_blocks(); ++row) {
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            auto block = result.block(nu * row, nu * pattern.column(entry), nu, nu);
            if (matrix.is_rigid()) {
                block = matrix.rigid_values[entry];
            } else {
                block = matrix.values[entry];
            }
        }
    }
    return result;
}

} // namespace kluft

// The dense twin of the block matrix.
#pragma once

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"

namespace kluft {

inline Eigen::MatrixXd dense(const BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 * pattern.n_blocks(), 6 * pattern.n_blocks());
    for (int row = 0; row < pattern.n_blocks(); ++row) {
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            result.block<6, 6>(6 * row, 6 * pattern.column(entry)) = matrix.values[entry];
        }
    }
    return result;
}

} // namespace kluft

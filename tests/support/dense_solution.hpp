// Dense linear algebra to compare with, compiled in one place.
#pragma once

#include <Eigen/Core>

namespace kluft {

/// x of matrix x = right, by Gaussian elimination with partial pivoting.
Eigen::VectorXd dense_solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);
/// The shortest x of matrix x = right, by a complete orthogonal decomposition.
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

} // namespace kluft

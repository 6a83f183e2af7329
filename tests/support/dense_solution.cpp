#include "support/dense_solution.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

namespace kluft {

Eigen::VectorXd dense_solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
    return matrix.partialPivLu().solve(right);
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
    return matrix.completeOrthogonalDecomposition().solve(right);
}

} // namespace kluft

// Decompositions of small dense matrices by Eigen. They are compiled here alone, because each of their templates takes
// the compiler seconds wherever it is instantiated.
#pragma once

#include <Eigen/Core>

namespace kluft {

struct SymmetricEigen {
    Eigen::VectorXd values;  ///< ascending
    Eigen::MatrixXd vectors; ///< orthonormal columns in the order of `values`
};

/// Of a symmetric matrix, whose lower triangle is read.
[[nodiscard]] SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& symmetric);
/// The same without the vectors.
[[nodiscard]] Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& symmetric);

/// M = u diag(values) v' of an m x n matrix, with min(m, n) values.
struct SingularValues {
    Eigen::MatrixXd u;      ///< m x min(m, n)
    Eigen::VectorXd values; ///< descending
    Eigen::MatrixXd v;      ///< n x n: from column `rank` on a basis of the null space

    /// Number of values above this part of the largest.
    [[nodiscard]] Eigen::Index rank(double part) const { return (values.array() > part * values[0]).count(); }
};

/// Throws nothing; `matrix` has a row and a column at least.
[[nodiscard]] SingularValues singular_values(const Eigen::MatrixXd& matrix);
/// The pseudo-inverse of the matrix, n x m, with the first `rank` singular values.
[[nodiscard]] Eigen::MatrixXd pseudo_inverse(const SingularValues& of, Eigen::Index rank);

} // namespace kluft

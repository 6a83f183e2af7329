// Sparse direct solution of K x = b on a block pattern: CHOLMOD for symmetric positive definite K, UMFPACK for
// unsymmetric K. Nothing of either library is seen outside this unit.
#pragma once

#include <memory>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"

namespace kluft {

enum class Factorization {
    cholesky, ///< supernodal LL' of the lower triangle; fails on an indefinite matrix
    lu        ///< with pivoting inside fronts
};

struct LinearSolverStatistics {
    int analyses = 0;
    int factorizations = 0;
    double analyze_seconds = 0.0;
    double factorize_seconds = 0.0;
    double solve_seconds = 0.0;
};

/// The four verbs of a backend: analyze, factorize, (update,) solve. The symbolic analysis is repeated only when
/// `analyze` is called with another pattern; the ordering is METIS's nested dissection of the graph of blocks.
class LinearSolver {
public:
    LinearSolver();
    ~LinearSolver();
    LinearSolver(const LinearSolver&) = delete;
    LinearSolver& operator=(const LinearSolver&) = delete;

    /// Orders the pattern, which must live as long as it is used, and forgets earlier factors.
    void analyze(const BlockPattern& pattern);

    /// Numeric factorization; false if the matrix is singular or, for `cholesky`, not positive definite.
    /// Throws ResourceError out of memory.
    [[nodiscard]] bool factorize(const BlockMatrix& matrix, Factorization kind);

    /// x = K^-1 b with the last factor; sizes 6 n_blocks.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

    [[nodiscard]] const LinearSolverStatistics& statistics() const;

private:
    struct Backend;
    std::unique_ptr<Backend> backend_;
};

/// Nonzeros of L and flops of one factorization of the pattern by CHOLMOD's symbolic count, and bytes of the factor.
struct FactorCost {
    double nonzeros = 0.0;
    double flops = 0.0;
    double bytes = 0.0;
};
[[nodiscard]] FactorCost factor_cost(const BlockPattern& pattern);

/// Sets the number of threads of the BLAS (OpenBLAS) for the whole process.
void set_blas_threads(int n_threads);

} // namespace kluft

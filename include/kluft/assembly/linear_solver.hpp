// Sparse direct solution of K x = b on a block pattern, with the factor reused as long as K changes little: the
// L L' of a symmetric positive definite reference by CHOLMOD or the multifrontal method, or the latter's L U of an
// unsymmetric one, low-rank changes on top of it, and Krylov refinement against the K of the moment; or UMFPACK's L U of K
// itself. The only entrance to the units of either.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/low_rank_update.hpp"
#include "kluft/assembly/supernodal_factor.hpp"

namespace kluft {

enum class Factorization {
    cholesky,         ///< supernodal LL' of the lower triangle; fails on an indefinite matrix
    rounded_cholesky, ///< the same in single precision, unless the matrix is too ill-conditioned for it: to be refined
    rounded_lu, ///< in single precision without pivoting, of an unsymmetric matrix near a positive definite one: to be refined
    lu          ///< with pivoting inside fronts
};

struct LinearSolverStatistics {
    int analyses = 0;
    int factorizations = 0;
    int updates = 0;     ///< sets of changes on top of a factor
    int rank = 0;        ///< largest that stood on one factor
    int refinements = 0; ///< Krylov vectors of all solutions
    double analyze_seconds = 0.0;
    double factorize_seconds = 0.0;
    double update_seconds = 0.0;
    double solve_seconds = 0.0;
};

/// How exactly a solution must fulfil K x = b: either is enough.
struct SolveGoal {
    double residual = 0.0;         ///< |b - K x| (norm)
    double backward_error = 1e-12; ///< |b - K x| / (|K| |x| + |b|), with the norm of Frobenius
};

struct SolveReport {
    bool accepted = false;
    int refinements = 0; ///< Krylov vectors, each a solution with the factor; the first is the plain solution
};

/// The four verbs of a backend: analyze, factorize, update, solve. The symbolic analysis is repeated only when
/// `analyze` is called with another pattern.
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
    /// The same, and the values of the matrix are gone afterwards; before a factor in double precision takes its memory.
    [[nodiscard]] bool factorize(BlockMatrix&& matrix, Factorization kind);

    /// Puts low-rank changes on top of a factor that is not `lu`: the complete list of what has changed since `factorize`.
    /// False, and the factor should be renewed, if their rank exceeds max_rank() or the changed matrix is singular.
    [[nodiscard]] bool update(const std::vector<StiffnessChange>& changes);

    /// Rank beyond which a factorization is cheaper, 3 sqrt(unknowns), and what stands on the factor.
    [[nodiscard]] int max_rank() const;
    [[nodiscard]] int rank() const;

    /// x = K^-1 b with the last factor and its changes alone; sizes: all unknowns.
    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);

    /// The same, refined against `matrix` until the goal is reached or `max_refinements` Krylov vectors are used up.
    SolveReport solve(const BlockMatrix& matrix, const Eigen::VectorXd& b, const SolveGoal& goal, int max_refinements,
                      Eigen::VectorXd& x);

    /// The same without a factor, by the inverses of the diagonal blocks of an affine body's matrix: where these are much of it. The
    /// factor, if there is one, stays.
    SolveReport solve_by_blocks(const BlockMatrix& matrix, const Eigen::VectorXd& b, const SolveGoal& goal,
                                int max_refinements, Eigen::VectorXd& x);

    /// How many vectors of the refinement a factorization costs.
    [[nodiscard]] int refinements_worth_a_factorization() const;

    [[nodiscard]] const LinearSolverStatistics& statistics() const;

private:
    struct Backend;
    std::unique_ptr<Backend> backend_;
};

/// Cost of a factorization of the pattern by the symbolic count, of L U that of a Cholesky factorization. Throws
/// ResourceError out of memory.
[[nodiscard]] FactorCost factor_cost(const BlockPattern& pattern, Factorization kind);

} // namespace kluft

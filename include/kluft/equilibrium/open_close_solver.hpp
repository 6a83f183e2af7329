// Open-close iteration: Newton's method on the one residual, with contact states following from the displacements.
#pragma once

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

struct OpenCloseOptions {
    double tolerance = 1e-5; ///< of |R|/F_ref
    int max_iterations = 20; ///< linear solves per attempt: give up early, a cut step is cheaper
    TangentKind tangent = TangentKind::exact;
    double strain_limit = 0.05; ///< largest change of D per iteration, relative to the block's own size
    double motion_limit = 0.04; ///< largest motion of a block per iteration, relative to the lattice spacing
    int max_lagged_rounds = 20; ///< rounds of the lagged-limit scheme
};

enum class Termination {
    converged,      ///< q is an equilibrium
    max_iterations, ///< q is the last iterate, no equilibrium
    singular        ///< the stiffness could not be factorized: nothing holds a part of the body
};

struct OpenCloseSummary {
    Termination termination = Termination::max_iterations;
    int iterations = 0;          ///< linear solves
    double residual_ratio = 0.0; ///< |R|/F_ref at q
    double force_scale = 0.0;    ///< F_ref (N/m)
    int worst_block = -1;        ///< the block with the largest residual
    [[nodiscard]] bool converged() const { return termination == Termination::converged; }
};

class OpenCloseSolver {
public:
    OpenCloseSolver(LinearSolver& linear_solver, OpenCloseOptions options)
        : linear_solver_(linear_solver), options_(options) {}

    /// Newton with root finding on R . dq from the guess q, which becomes the last iterate. The linear solver must
    /// have analysed `pattern`.
    OpenCloseSummary solve(const EquilibriumProblem& problem, const BlockPattern& pattern, Eigen::VectorXd& q);

    /// Convex scheme: friction limits are held while the symmetric problem is solved, then taken anew, until the
    /// true residual is in tolerance. Slower, but it converges where single fragments stop Newton.
    OpenCloseSummary solve_lagged(EquilibriumProblem& problem, const BlockPattern& pattern, Eigen::VectorXd& q);

    /// Time spent so far in residuals and tangents (s).
    [[nodiscard]] double assembly_seconds() const { return assembly_seconds_; }

private:
    OpenCloseSummary iterate(const EquilibriumProblem& problem, const BlockPattern& pattern, TangentKind kind,
                             Eigen::VectorXd& q);
    void limit_increment(const BlockSystem& system);
    [[nodiscard]] double free_norm(const EquilibriumProblem& problem, const Residual& residual);
    [[nodiscard]] double step_along_root(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                         const Eigen::VectorXd& q, double slope_at_zero);
    [[nodiscard]] double step_by_halving(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                         const Eigen::VectorXd& q, double norm_at_zero);
    double slope_at(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator, const Eigen::VectorXd& q,
                    double s);

    LinearSolver& linear_solver_;
    OpenCloseOptions options_;
    double assembly_seconds_ = 0.0;
    BlockMatrix matrix_;
    Residual residual_;
    Residual trial_;
    Eigen::VectorXd prescribed_, right_side_, increment_, position_, scratch_;
};

} // namespace kluft

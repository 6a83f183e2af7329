// Open-close iteration: Newton's method on the one residual, with contact states following from the displacements.
#pragma once

#include <array>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/equilibrium/stiffness_reference.hpp"

namespace kluft {

struct OpenCloseOptions {
    double tolerance = 1e-5; ///< of |R|/F_ref
    int max_iterations = 12; ///< linear solves per attempt: give up early, a relaxation is cheaper (measured)
    TangentKind tangent = TangentKind::exact;
    bool reuse = true; ///< of the factor from one linear solve to the next; false: the exact tangent is factorized anew
    double motion_limit = 0.04; ///< largest change of a block's u or D per iteration, relative to the lattice spacing
};

enum class Aim {
    equilibrium, ///< to the tolerance
    relaxation   ///< a step on the way: a residual well below the mass-like forces is enough, and few iterations
};

enum class Termination {
    converged,      ///< q is an equilibrium
    relaxed,        ///< q is near enough to one for a relaxation
    max_iterations, ///< q is the last iterate, no equilibrium
    singular        ///< the stiffness could not be factorized: nothing holds a part of the body
};

struct OpenCloseSummary {
    Termination termination = Termination::max_iterations;
    int iterations = 0;          ///< linear solves
    double residual_ratio = 0.0; ///< |R|/F_ref at q
    double force_scale = 0.0;    ///< F_ref (N/m)
    int worst_block = -1;        ///< the block with the largest residual
    std::vector<int> restless;   ///< blocks with a large part of the residual in the last iterations
    [[nodiscard]] bool converged() const { return termination == Termination::converged; }
};

class OpenCloseSolver {
public:
    OpenCloseSolver(LinearSolver& linear_solver, OpenCloseOptions options)
        : linear_solver_(linear_solver), options_(options) {}

    /// Newton with root finding on R . dq from the guess q, which becomes the last iterate. The linear solver must
    /// have analysed `pattern`. From an `unloaded` body, whose contacts carry no force yet and therefore have no
    /// stiffness, the first increment takes the touching ones as closed.
    OpenCloseSummary solve(const EquilibriumProblem& problem, const BlockPattern& pattern, Eigen::VectorXd& q,
                           bool unloaded = false, Aim aim = Aim::equilibrium);

    void set_tolerance(double tolerance) { options_.tolerance = tolerance; }

    /// The next linear solve makes a new factor: what follows does not depend on what was solved before.
    void forget_factor() { reference_.forget(); }

    /// Time spent so far in residuals and tangents (s).
    [[nodiscard]] double assembly_seconds() const { return assembly_seconds_; }

private:
    void evaluate(EquilibriumEvaluator& evaluator, const Eigen::VectorXd& q, Residual& residual);
    [[nodiscard]] bool find_increment(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                      const Eigen::VectorXd& q, TangentKind kind);
    void assemble(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator, const Eigen::VectorXd& q,
                  TangentKind kind);
    [[nodiscard]] bool solve_anew(const EquilibriumProblem& problem, TangentKind kind);
    [[nodiscard]] bool solve_with_reuse(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                        const Eigen::VectorXd& q);
    [[nodiscard]] bool update_factor(const EquilibriumProblem& problem, const Eigen::VectorXd& q);
    [[nodiscard]] bool renew_factor(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                    const Eigen::VectorXd& q);
    [[nodiscard]] bool solve_refined(const EquilibriumProblem& problem);
    void limit_increment(const BlockSystem& system);
    void move_to(const EquilibriumProblem& problem, const Eigen::VectorXd& q, double s);
    void keep_free_part(const EquilibriumProblem& problem, const Eigen::VectorXd& q, Eigen::VectorXd& forces) const;
    void add_travel(const EquilibriumProblem& problem, double out_of_balance);
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
    int nu_ = n_block_unknowns;    ///< unknowns per block of the problem: of all vectors here but `position_`
    StiffnessReference reference_; ///< of the factor that is reused
    int analysis_of_factor_ = 0;   ///< of the linear solver, when the factor was made
    int fresh_refinements_ = -1;   ///< of the first solution with the factor, -1 before
    int excess_refinements_ = 0;   ///< of later solutions beyond it
    Residual residual_;
    Residual trial_;
    Residual of_six_numbers_; ///< of rigid blocks, before it is reduced to their unknowns
    Eigen::VectorXd prescribed_, right_side_, increment_, position_, scratch_;
    Eigen::VectorXd travel_;                                ///< motion for unit travel of a platen under a given force
    Eigen::VectorXd travel_column_, travel_row_, response_; ///< its column and row of the stiffness
    std::array<std::vector<int>, 4> restless_;              ///< blocks, of each of the last iterations
    std::vector<int> limited_;                              ///< blocks whose motion limited the last increment
    Eigen::VectorXd full_step_forces_;                      ///< residual at the end of the last full increment
};

} // namespace kluft

// One factor for many linear systems (docs/theory.md, "Reuse of the factor"): what has changed since it was made goes
// on top of it, or is met by refinement.
#pragma once

#include <Eigen/Core>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/stiffness_reference.hpp"

namespace kluft {

/// Keeps the factor of a tangent for as long as it is worth it.
class ReusedFactor {
public:
    explicit ReusedFactor(LinearSolver& linear_solver) : linear_solver_(linear_solver) {}

    /// The linear solver's factor is not, or should not be, that of a tangent any more.
    void forget() { reference_.forget(); }
    /// The same, and nothing of what earlier factors were worth is remembered.
    void forget_all() {
        forget();
        friction_is_costly_ = false;
        failed_in_succession_ = n_left_out_ = 0;
    }

    /// Whether a solution with a new factor of a symmetric tangent has taken so many vectors, because of friction or of pivots
    /// that were raised, that one of the exact tangent is worth twice the operations.
    [[nodiscard]] bool friction_is_costly() const { return friction_is_costly_; }

    /// Puts all changes of the tangent at q on top of the factor (30). False if there is no factor worth
    /// keeping.
    [[nodiscard]] bool update(const EquilibriumProblem& problem, const Eigen::VectorXd& q);
    /// Makes the factor anew of the symmetric tangent at q with the prescribed motions taken out; its values are gone
    /// then. False if it is not positive definite.
    [[nodiscard]] bool renew(const EquilibriumProblem& problem, const Eigen::VectorXd& q, BlockMatrix&& symmetric);
    /// The same of the exact tangent, which stays. False if its pivots are too small.
    [[nodiscard]] bool renew_exact(const EquilibriumProblem& problem, const Eigen::VectorXd& q,
                                   const BlockMatrix& exact);

    /// Solves matrix x = b, refined until no more than `residual` is left of b.
    SolveReport solve(const BlockMatrix& matrix, const Eigen::VectorXd& b, double residual, Eigen::VectorXd& x);
    /// Counts the refinements of a solution: the more they exceed those of the first one, the sooner the factor is made
    /// anew.
    void count(int refinements);

    /// No factor of this kind, old or new, has led to a solution: the next ones are left out, twice as many after each
    /// failure in succession.
    void note_failure();
    /// Whether this solution is one of those, which it then counts as.
    [[nodiscard]] bool is_left_out();

private:
    [[nodiscard]] bool begin(bool is_factorized, bool is_exact);

    LinearSolver& linear_solver_;
    StiffnessReference reference_;
    bool is_exact_ = false;
    bool friction_is_costly_ = false;
    int analysis_ = 0;           ///< of the linear solver, when the factor was made
    int fresh_refinements_ = -1; ///< of the first solution with the factor, -1 before
    int excess_refinements_ = 0; ///< of later solutions beyond it
    int failed_in_succession_ = 0;
    int n_left_out_ = 0; ///< solutions, still
};

} // namespace kluft

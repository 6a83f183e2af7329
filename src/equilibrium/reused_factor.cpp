#include "kluft/equilibrium/reused_factor.hpp"

#include <algorithm>
#include <utility>

namespace kluft {

namespace {

constexpr int max_refinements = 60;     ///< Krylov vectors of one linear solve
constexpr int most_beside_friction = 3; ///< of a first solution that leaves friction to the refinement
constexpr int most_held_otherwise = 6;  ///< blocks: each takes a vector or two of every solution
constexpr int most_left_out = 16;       ///< solutions after a failure
constexpr int no_analysis = -1;         ///< there is no factor

} // namespace

bool ReusedFactor::update(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    if (!reference_.taken() || analysis_ != linear_solver_.statistics().analyses ||
        excess_refinements_ > linear_solver_.refinements_worth_a_factorization() ||
        reference_.n_held_otherwise(problem) > most_held_otherwise) {
        return false;
    }
    return linear_solver_.update(reference_.changes(problem, q));
}

bool ReusedFactor::renew(const EquilibriumProblem& problem, const Eigen::VectorXd& q, BlockMatrix&& symmetric) {
    analysis_ = no_analysis; // should memory run out
    reference_.take(problem, q, TangentKind::symmetric, symmetric);
    return begin(linear_solver_.factorize(std::move(symmetric), Factorization::rounded_cholesky), false);
}

bool ReusedFactor::renew_exact(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const BlockMatrix& exact) {
    analysis_ = no_analysis;
    reference_.take(problem, q, TangentKind::exact, exact);
    return begin(linear_solver_.factorize(exact, Factorization::rounded_lu), true);
}

bool ReusedFactor::begin(bool is_factorized, bool is_exact) {
    if (!is_factorized) {
        reference_.forget();
        return false;
    }
    is_exact_ = is_exact;
    analysis_ = linear_solver_.statistics().analyses;
    fresh_refinements_ = -1;
    excess_refinements_ = 0;
    return true;
}

SolveReport ReusedFactor::solve(const BlockMatrix& matrix, const Eigen::VectorXd& b, double residual,
                                Eigen::VectorXd& x) {
    SolveGoal goal;
    goal.residual = residual;
    return linear_solver_.solve(matrix, b, goal, max_refinements, x);
}

void ReusedFactor::count(int refinements) {
    failed_in_succession_ = 0;
    if (fresh_refinements_ < 0) {
        fresh_refinements_ = refinements;
        if (!is_exact_ && refinements > most_beside_friction) friction_is_costly_ = true;
    }
    excess_refinements_ += std::max(0, refinements - fresh_refinements_);
}

void ReusedFactor::note_failure() {
    n_left_out_ = std::min(most_left_out, 1 << std::min(failed_in_succession_, 10));
    ++failed_in_succession_;
}

bool ReusedFactor::is_left_out() {
    if (n_left_out_ == 0) return false;
    --n_left_out_;
    return true;
}

} // namespace kluft

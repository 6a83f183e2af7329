#include "stopping_test.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kluft/equilibrium/left_over.hpp"

namespace kluft {

namespace {

constexpr int iterations_before_halving = 8; ///< then the norm must fall, or it is searched on
constexpr int max_short_steps = 3;           ///< in succession
constexpr int relaxation_iterations = 6;     ///< of one step: what takes more needs more mass (measured)
constexpr double block_linear_share = 0.3;   ///< of what is allowed on a block: what a linear solve may leave
constexpr double negligible = 3e-2;          ///< of the tolerance: forces that are not improved locally
constexpr double relaxed_share = 0.2;        ///< of the mass-like forces, that a step of relaxation may leave
constexpr double usual_tolerance = 1e-5;     ///< with a smaller one such a step leaves less, in proportion

int largest_block(const Coordinates& coordinates, const Eigen::VectorXd& forces) {
    int worst = 0;
    double largest = -1.0;
    for (int b = 0; b < coordinates.n_blocks(); ++b) {
        const double size = coordinates.squared_norm(forces, b);
        if (size > largest) {
            largest = size;
            worst = b;
        }
    }
    return worst;
}

UnbalancedBlocks unbalanced_blocks(const Equations& equations, const Eigen::VectorXd& q, const Eigen::VectorXd& forces,
                                   double tolerance) {
    UnbalancedBlocks result;
    if (!std::isfinite(tolerance)) return result;
    const Coordinates& coordinates = equations.evaluator.coordinates();
    const OwnForces own = own_forces(equations.problem.body, q);
    double worst = 0.0;
    for (int b = 0; b < coordinates.n_blocks(); ++b) {
        const double left = size_of(rigid_part(coordinates, *equations.problem.body.system, q, forces, b));
        const double allowed = tolerance * own.around[b] + own.roundoff[b];
        if (left <= allowed || own.around[b] == 0.0) continue; // it may touch nothing
        result.blocks.push_back(b);
        result.least_allowed = std::min(result.least_allowed, allowed);
        if (left <= worst * allowed) continue;
        worst = left / std::max(allowed, 1e-300);
        std::swap(result.blocks.front(), result.blocks.back());
    }
    return result;
}

} // namespace

StoppingTest::StoppingTest(const OpenCloseOptions& options, const IterationGoal& goal, OpenCloseSummary& summary)
    : summary_(summary), tolerance_(goal.tolerance_share * options.tolerance), block_tolerance_(goal.block_tolerance),
      relaxed_share_(relaxed_share * std::min(1.0, tolerance_ / usual_tolerance)),
      max_iterations_(options.max_iterations), relaxes_(goal.aim == Aim::relaxation) {
    if (relaxes_) max_iterations_ = std::min(relaxation_iterations, max_iterations_);
}

bool StoppingTest::finds(const Equations& equations, const Eigen::VectorXd& q, const Iterate& at) {
    summary_.force_scale = at.residual.force_scale;
    summary_.left_to_go = at.held ? 0.0 : at.prescribed.lpNorm<Eigen::Infinity>();
    summary_.residual_ratio = summary_.force_scale > 0.0 ? at.norm / summary_.force_scale : 0.0;
    unbalanced_ = {};
    if (is_equilibrium(at)) {
        unbalanced_ = unbalanced_blocks(equations, q, at.free_forces, block_tolerance_);
        if (unbalanced_.blocks.empty()) return ends_with(Termination::converged);
    }
    summary_.worst_block = unbalanced_.blocks.empty() ? largest_block(equations.evaluator.coordinates(), at.free_forces)
                                                      : unbalanced_.blocks.front();
    return false;
}

bool StoppingTest::ends(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const Iterate& at) {
    if (is_relaxed(problem, q, at)) return ends_with(Termination::relaxed);
    if (summary_.iterations < max_iterations_ && short_steps_ < max_short_steps) return false;
    return ends_with(Termination::max_iterations);
}

double StoppingTest::largest_residual() const { return block_linear_share * unbalanced_.least_allowed; }

double StoppingTest::negligible_forces(const EquilibriumProblem& problem, const Eigen::VectorXd& q,
                                       const Iterate& at) const {
    const double in_balance = std::min(negligible * tolerance_ * at.residual.force_scale, largest_residual());
    return relaxes_ ? std::max(in_balance, 0.5 * relaxed_share_ * viscous_force(problem, q).norm) : in_balance;
}

bool StoppingTest::stalls(const Iterate& at) const {
    return summary_.iterations > iterations_before_halving && at.norm >= previous_norm_;
}

void StoppingTest::note_step(const Iterate& from, double s) {
    short_steps_ = s < short_step ? short_steps_ + 1 : 0;
    previous_norm_ = from.norm;
    moved_ = true;
}

bool StoppingTest::ends_with(Termination termination) {
    summary_.termination = termination;
    return true;
}

bool StoppingTest::is_equilibrium(const Iterate& at) const {
    return at.held && at.norm <= tolerance_ * at.residual.force_scale + at.residual.roundoff;
}

bool StoppingTest::is_relaxed(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const Iterate& at) const {
    return relaxes_ && at.held && moved_ && at.norm <= relaxed_share_ * viscous_force(problem, q).norm;
}

} // namespace kluft

#include "kluft/equilibrium/held_friction.hpp"

#include <cmath>

namespace kluft {

namespace {

constexpr int max_rounds = 20;
constexpr double settled = 1e-7;       ///< change of the limits over their sum: the next solve finds little to do
constexpr double far = 1e-2;           ///< the same: the limits will change by more than what a solve leaves
constexpr double far_tolerance = 10.0; ///< of the tolerance, as long as they do
constexpr double no_slip = 1e200;      ///< Pa

/// Takes the limits at q. By how much they have changed, over their sum, with the lengths that the points stand for.
double renew_limits(const std::vector<InterfaceLaw>& laws, const Eigen::VectorXd& q, Placement& placement) {
    double change = 0.0;
    double sum = 0.0;
    for (ContactPoint& point : placement.contacts) {
        const double limit = coulomb_limit(laws, point, q);
        const double before = point.held_limit.value_or(no_slip);
        change += point.weight * (before < no_slip ? std::abs(limit - before) : limit);
        sum += point.weight * limit;
        point.held_limit = limit;
    }
    return sum > 0.0 ? change / sum : 0.0;
}

} // namespace

HeldFrictionApproach approach_with_held_friction(OpenCloseSolver& solver, const EquilibriumProblem& problem,
                                                 const BlockPattern& pattern, const HeldFrictionGoal& goal,
                                                 Eigen::VectorXd& q) {
    Placement placement = *problem.body.placement;
    EquilibriumProblem held = problem;
    held.body.placement = &placement;
    for (ContactPoint& point : placement.contacts)
        point.held_limit = goal.unloaded ? no_slip : coulomb_limit(*problem.body.laws, point, q);
    HeldFrictionApproach approach;
    double change = goal.unloaded ? 1.0 : far;
    Eigen::VectorXd next = q;
    for (int round = 0; round < max_rounds && change > settled; ++round) {
        const OpenCloseSummary found =
            solver.solve(held, pattern, next,
                         {.unloaded = goal.unloaded && round == 0,
                          .given_loads = true,
                          .tolerance_share = change > far ? far_tolerance : goal.tolerance_share});
        approach.n_solves += found.iterations;
        if (!found.converged()) break;
        q = next;
        held.start = q; // the mass-like term does not pull back to where the body stood without loads
        approach.is_moved = true;
        change = renew_limits(*problem.body.laws, q, placement);
    }
    return approach;
}

} // namespace kluft

#include "kluft/simulation/equilibrium_search.hpp"

#include <algorithm>
#include <cmath>

namespace kluft {

namespace {

constexpr double balance_rounds_per_digit = 4.0; ///< of the share that is asked for
constexpr double least_balance_progress = 0.7;   ///< of the viscous share per round, else the body is moving

OpenCloseOptions open_close_options(const SolverOptions& solver) {
    OpenCloseOptions options;
    options.tolerance = solver.tolerance;
    options.max_iterations = solver.max_iterations;
    options.reuse = solver.reuse;
    options.tangent = solver.tangent == Tangent::unsymmetric ? TangentKind::exact : TangentKind::symmetric;
    return options;
}

/// |eta M (q - q_start)|/F_ref (docs/theory.md, balance).
double viscous_share(const EquilibriumProblem& problem, const Eigen::VectorXd& q, double force_scale) {
    const double force = viscous_force(problem, q);
    return force > 0.0 ? force / std::max(force_scale, 1e-300) : 0.0;
}

} // namespace

EquilibriumSearch::EquilibriumSearch(const Model& model, const SolverOptions& options)
    : model_(model), open_close_(linear_, open_close_options(options)) {}

void EquilibriumSearch::require_pairs(const std::vector<ContactPoint>& points,
                                      std::vector<std::pair<int, int>> near_pairs) {
    const bool complete =
        pattern_.n_blocks() == model_.system.n_blocks() && std::ranges::all_of(points, [&](const ContactPoint& point) {
            return pattern_.find(point.block_a, point.block_b) >= 0;
        });
    if (!complete) order_for(std::move(near_pairs));
}

void EquilibriumSearch::order_for(std::vector<std::pair<int, int>> near_pairs) {
    near_pairs_ = std::move(near_pairs);
    std::vector<std::pair<int, int>> pairs = near_pairs_;
    for (const Interface& interface : model_.system.interfaces)
        pairs.emplace_back(interface.block_a, interface.block_b);
    pattern_ = BlockPattern(model_.system.n_blocks(), pairs, model_.kinematics);
    linear_.analyze(pattern_);
}

Equilibrium EquilibriumSearch::find(EquilibriumProblem problem, Eigen::VectorXd guess, const Balance& balance,
                                    bool unloaded) {
    Equilibrium found;
    found.displacement = std::move(guess);
    found.summary = open_close_.solve(problem, pattern_, found.displacement, unloaded);
    found.iterations = found.summary.iterations;
    found.worst_block = found.summary.worst_block;
    if (found.converged()) settle(problem, balance, found);
    found.start = std::move(problem.start);
    return found;
}

/// The mass-like term must not change the answer: solve again from the result until its share is small, and until it
/// falls or is that of a body at rest.
void EquilibriumSearch::settle(EquilibriumProblem& problem, const Balance& balance, Equilibrium& found) {
    found.viscous_share = viscous_share(problem, found.displacement, found.summary.force_scale);
    const int max_rounds = static_cast<int>(std::ceil(-balance_rounds_per_digit * std::log10(balance.share)));
    bool settles = found.viscous_share <= balance.rest_share;
    for (int round = 0; round < max_rounds && (found.viscous_share > balance.share || !settles); ++round) {
        problem.start = found.displacement;
        Eigen::VectorXd next = found.displacement;
        OpenCloseSummary summary = open_close_.solve(problem, pattern_, next);
        found.iterations += summary.iterations;
        if (!summary.converged()) break;
        const double share = viscous_share(problem, next, summary.force_scale);
        const bool stalls = share > least_balance_progress * found.viscous_share;
        found.displacement = std::move(next);
        found.summary = std::move(summary);
        found.viscous_share = share;
        settles = !stalls || share <= balance.rest_share;
        if (stalls) break;
    }
    found.balanced = settles && found.viscous_share <= balance.share;
}

Equilibrium EquilibriumSearch::move_on(EquilibriumProblem problem, bool unloaded) {
    Equilibrium moved;
    moved.displacement = problem.start;
    moved.summary = open_close_.solve(problem, pattern_, moved.displacement, unloaded, Aim::relaxation);
    moved.iterations = moved.summary.iterations;
    moved.worst_block = moved.summary.worst_block;
    moved.viscous_share = viscous_share(problem, moved.displacement, moved.summary.force_scale);
    moved.start = std::move(problem.start);
    return moved;
}

Eigen::VectorXd EquilibriumSearch::forces(const EquilibriumProblem& problem, const Eigen::VectorXd& q) const {
    Residual residual;
    EquilibriumEvaluator(problem, pattern_).residual(q, residual);
    return std::move(residual.forces);
}

void EquilibriumSearch::add_costs(RunCosts& costs) const {
    const LinearSolverStatistics& linear = linear_.statistics();
    costs.factorizations += linear.factorizations;
    costs.analyses += linear.analyses;
    costs.updates += linear.updates;
    costs.largest_rank = std::max(costs.largest_rank, linear.rank);
    costs.refinements += linear.refinements;
    costs.seconds.analysis += linear.analyze_seconds;
    costs.seconds.factorization += linear.factorize_seconds;
    costs.seconds.update += linear.update_seconds;
    costs.seconds.solution += linear.solve_seconds;
    costs.seconds.assembly += open_close_.assembly_seconds();
}

} // namespace kluft

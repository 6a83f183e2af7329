#include "kluft/simulation/equilibrium_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kluft/equilibrium/held_friction.hpp"
#include "kluft/equilibrium/left_over.hpp"
#include "kluft/simulation/mass_term.hpp"
#include "kluft/simulation/parts_at_rest.hpp"
#include "kluft/simulation/whole_body.hpp"

namespace kluft {

namespace {

constexpr double eta_decay = 0.1;    ///< from round to round: what a body that stands leaves over falls with it
constexpr int rounds_with_decay = 3; ///< then it stays: what nothing else holds needs it
constexpr int max_rounds = 40;       ///< of one search, as long as what is left over falls
constexpr double sharpening = 0.1;   ///< of the tolerance, where what a solve leaves adds up over a group of blocks
constexpr double sharpest = 1e-5;    ///< of the tolerance
constexpr int rounds_that_open = 12; ///< points of platens: then they may only close
constexpr int max_platen_rounds = 24;
constexpr double share_of_solve = 0.1; ///< of what may be left over on a block: largest residual of a solve
constexpr double share_of_change =
    3e-3; ///< of what a change of the loads has put on the blocks: what may be left over of it
constexpr double small_change = 0.02; ///< of F_ref: of a larger one less is left over anyway
constexpr double least_change = 1e-8; ///< of F_ref
constexpr int rounds_of_change = 6;
constexpr double falls_by = 0.95;         ///< with each round, of what something holds
constexpr double share_of_motion = 1e-3;  ///< of a load step's: what a round may still move a body that has caught up
constexpr double eta_of_lag = 1e-5;       ///< of eta: what holds the body back is not what finds how far
constexpr double eta_of_others = 1e4;     ///< of eta: they stay while what is followed goes on
constexpr int patience_with_lag = 3;      ///< solves
constexpr double tolerance_of_lag = 1e-3; ///< of the tolerance

OpenCloseOptions open_close_options(const SolverOptions& solver) {
    OpenCloseOptions options;
    options.tolerance = solver.tolerance;
    options.max_iterations = solver.max_iterations;
    options.reuse = solver.reuse;
    options.tangent = solver.tangent == Tangent::unsymmetric ? TangentKind::exact : TangentKind::symmetric;
    return options;
}

/// Sum of |eta M (q - q_start)| over the blocks, over F_ref (27b).
double viscous_share(const EquilibriumProblem& problem, const Eigen::VectorXd& q, double force_scale) {
    const double force = viscous_force(problem, q).sum;
    return force > 0.0 ? force / std::max(force_scale, 1e-300) : 0.0;
}

/// An equilibrium, or a step of a motion that counts.
bool is_on_the_way(const Equilibrium& found) {
    return found.converged() || found.summary.termination == Termination::relaxed;
}

bool slides(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    return std::ranges::any_of(problem.body.placement->contacts, [&](const ContactPoint& point) {
        return contact_traction(*problem.body.laws, point, q).state == ContactState::sliding;
    });
}

/// Whether the mass-like term is more than the iteration leaves, in a state where nothing slides: in small steps of load what
/// (27b) allows would be seen beside the growth of the load.
bool lags_behind(const EquilibriumProblem& problem, const Equilibrium& found, double tolerance) {
    return found.viscous_share > tolerance && !slides(problem, found.displacement);
}

/// Whether a contact may slide under a limit that follows its pressure.
bool has_friction(const LoadedBody& body) {
    return std::ranges::any_of(body.placement->contacts,
                               [&](const ContactPoint& point) { return (*body.laws)[point.law].tan_friction > 0.0; });
}

/// Of some of the blocks.
double norm_of(const std::vector<Vec3>& left, const std::vector<char>& of) {
    double sum = 0.0;
    for (std::size_t b = 0; b < left.size(); ++b)
        if (of[b] != 0) sum += left[b].squaredNorm();
    return std::sqrt(sum);
}

/// Root of the integral of the squared displacement over some of the blocks.
double motion(const BlockSystem& system, const std::vector<char>& of, const Eigen::VectorXd& moved) {
    double sum = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec6 own = moved.segment<6>(6 * b);
        if (of[b] != 0) sum += own.dot(mass_product(system.blocks[b], 0.0, own));
    }
    return std::sqrt(sum);
}

void scale_mass_term(const std::vector<char>& of, double factor, EquilibriumProblem& problem) {
    for (std::size_t b = 0; b < problem.eta.size(); ++b)
        if (of[b] != 0) problem.eta[b] *= factor;
}

/// Each block and group, and the mass-like term, which holds strains of blocks back too.
bool is_balanced(const Equilibrium& found, const BlockGoal& goal) {
    return found.verdict.balanced() && found.viscous_share <= goal.share;
}

} // namespace

EquilibriumSearch::EquilibriumSearch(const Model& model, const SolverOptions& options)
    : model_(model), viscosity_(options.viscosity), open_close_(linear_, open_close_options(options)) {}

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

/// Repeats solves with other points on the platens until these agree with what is found. A body that was held by its
/// platens alone and that they have left has the mass-like term to hold it, from where it was.
template <class Solve>
Equilibrium EquilibriumSearch::find_touching(const EquilibriumProblem& problem, Aim aim, const BlockGoal& balance,
                                             Solve solve) {
    if (problem.body.loads->platens.empty()) return solve(problem, nullptr);
    EquilibriumProblem held = problem;
    Loads loads = *problem.body.loads;
    held.body.loads = &loads;
    const auto on_platens = [&](const Eigen::VectorXd& q) { // the mass-like term is none of an equilibrium's forces
        EquilibriumProblem acting = held;
        if (aim == Aim::equilibrium) acting.eta.clear();
        return forces(acting, q);
    };
    Equilibrium found = solve(held, nullptr);
    bool changed = false;
    for (int round = 0; is_on_the_way(found); ++round) {
        if (!update_platen_points(model_.system, found.displacement, on_platens(found.displacement),
                                  round < rounds_that_open, loads))
            break;
        changed = true;
        hold_by_platens(held.body, found.displacement, loads);
        const bool is_left =
            held.eta.empty() && viscosity_ > 0.0 && !free_motions(resistance(model_.system, loads.constraints)).empty();
        if (is_left) held.eta.assign(model_.system.blocks.size(), mass_coefficient(model_, viscosity_));
        int iterations = found.iterations;
        found = solve(held, is_left ? nullptr : &found);
        if (!is_on_the_way(found) &&
            !is_left) { // what a platen has stretched before it opened may be at rest where it was
            iterations += found.iterations;
            found = solve(held, nullptr);
        }
        found.iterations += iterations;
        found.balanced = found.balanced && round < max_platen_rounds;
        if (round == max_platen_rounds) break;
    }
    if (changed && is_on_the_way(found))
        found.balanced = found.balanced && largest_pull(on_platens(found.displacement), loads) <= balance.share;
    if (changed) found.hold = {std::move(loads.platen_points), std::move(loads.constraints), std::move(loads.friction)};
    return found;
}

Equilibrium EquilibriumSearch::find(const EquilibriumProblem& problem, const Eigen::VectorXd& guess,
                                    const BlockGoal& balance, const Circumstances& circumstances) {
    return find_touching(problem, Aim::equilibrium, balance,
                         [&](const EquilibriumProblem& held, const Equilibrium* last) {
                             if (last == nullptr) return find_held(held, guess, balance, circumstances);
                             return find_held(held, last->displacement, balance,
                                              {.unloaded = false, .given_loads = circumstances.given_loads});
                         });
}

Equilibrium EquilibriumSearch::find_held(EquilibriumProblem problem, Eigen::VectorXd guess, const BlockGoal& balance,
                                         const Circumstances& circumstances) {
    const bool from_rest = circumstances.unloaded && circumstances.given_loads && has_friction(problem.body) &&
                           problem.body.kinematics == Kinematics::affine;
    int n_spent = 0;
    if (from_rest) {
        Equilibrium found = find_by_held_friction(problem, guess, balance);
        if (found.balanced) return found;
        n_spent = found.iterations; // a wedge near its limit may have slid too far under held limits
    }
    Equilibrium found;
    found.iterations = n_spent;
    found.displacement = std::move(guess);
    iterate(problem, balance, circumstances, found);
    if (found.converged()) settle(problem, balance, found);
    return found;
}

/// From the displacement that is found so far.
void EquilibriumSearch::iterate(const EquilibriumProblem& problem, const BlockGoal& balance,
                                const Circumstances& circumstances, Equilibrium& found) {
    found.summary = open_close_.solve(problem, pattern_, found.displacement,
                                      {.unloaded = circumstances.unloaded,
                                       .given_loads = circumstances.given_loads,
                                       .block_tolerance = share_of_solve * balance.share});
    found.iterations += found.summary.iterations;
    found.worst_block = found.summary.worst_block;
}

/// Of a body at rest under given loads (29d). Not balanced where this way comes to nothing.
Equilibrium EquilibriumSearch::find_by_held_friction(EquilibriumProblem problem, Eigen::VectorXd guess,
                                                     const BlockGoal& balance) {
    Equilibrium found;
    found.displacement = std::move(guess);
    const auto approach = [&](const HeldFrictionGoal& goal) {
        const auto approached = approach_with_held_friction(open_close_, problem, pattern_, goal, found.displacement);
        found.iterations += approached.n_solves;
        if (approached.is_moved) problem.start = found.displacement;
        return approached.is_moved;
    };
    constexpr Circumstances loaded{.unloaded = false, .given_loads = true};
    if (!approach({.unloaded = true})) return found;
    iterate(problem, balance, loaded, found);
    if (!found.converged()) { // by what the approach has left on a few bricks
        found.displacement = problem.start;
        if (approach({.unloaded = false, .tolerance_share = sharpening})) iterate(problem, balance, loaded, found);
    }
    if (found.converged()) settle(problem, balance, found);
    return found;
}

/// The mass-like term must not change the answer: solve again from the result until what is left over on each block and
/// group is small, or does not fall any more. Where a solve finds nothing to do, a tenth of its tolerance is asked for.
void EquilibriumSearch::settle(EquilibriumProblem& problem, const BlockGoal& balance, Equilibrium& found) {
    found.viscous_share = viscous_share(problem, found.displacement, found.summary.force_scale);
    found.blocks = block_balance(problem.body, found.displacement);
    found.verdict = judge_blocks(found.blocks, nullptr, balance);
    IterationGoal goal{.block_tolerance = share_of_solve * balance.share};
    for (int round = 0; round < max_rounds && !is_balanced(found, balance); ++round) {
        problem.start = found.displacement;
        if (round < rounds_with_decay)
            for (double& eta : problem.eta) eta *= eta_decay;
        Eigen::VectorXd next = found.displacement;
        OpenCloseSummary summary = open_close_.solve(problem, pattern_, next, goal);
        found.iterations += summary.iterations;
        if (!summary.converged()) break;
        if (next == found.displacement && goal.tolerance_share > sharpest) {
            goal.tolerance_share *= sharpening;
            continue;
        }
        BlockBalance blocks = block_balance(problem.body, next);
        found.verdict = judge_blocks(blocks, &found.blocks, balance);
        if (!found.verdict.balanced() && !found.verdict.falls) break;
        found.blocks = std::move(blocks);
        found.viscous_share = viscous_share(problem, next, summary.force_scale);
        found.displacement = std::move(next);
        found.summary = summary;
    }
    found.balanced = is_balanced(found, balance);
    if (found.balanced && lags_behind(problem, found, open_close_.options().tolerance)) {
        for (double& eta : problem.eta) eta *= eta_decay;
        catch_up(problem, balance, 1.0, 1, found);
    }
}

/// Solves once more with the problem's mass-like term, from where the body is, and as long as that takes no more than `patience` times the
/// iterations of a solve.
bool EquilibriumSearch::catch_up(EquilibriumProblem& problem, const BlockGoal& balance, double tolerance_share,
                                 int patience, Equilibrium& found) {
    problem.start = found.displacement;
    Equilibrium next = found;
    for (int attempt = 0; attempt < patience; ++attempt) {
        next.summary =
            open_close_.solve(problem, pattern_, next.displacement,
                              {.block_tolerance = share_of_solve * balance.share, .tolerance_share = tolerance_share});
        found.iterations += next.summary.iterations;
        if (next.summary.termination != Termination::max_iterations) break;
    }
    if (!next.converged()) return false;
    next.iterations = found.iterations;
    next.blocks = block_balance(problem.body, next.displacement);
    next.verdict = judge_blocks(next.blocks, &found.blocks, balance);
    next.viscous_share = viscous_share(problem, next.displacement, next.summary.force_scale);
    next.balanced = is_balanced(next, balance);
    if (!next.balanced) return false;
    found = std::move(next);
    return true;
}

/// Source: (27e), (27f).
void EquilibriumSearch::follow_loads(EquilibriumProblem problem, const Eigen::VectorXd& before,
                                     const BlockGoal& balance, Equilibrium& found) {
    const std::vector<char> followed = parts_at_rest(problem, found.displacement);
    if (std::ranges::find(followed, 1) == followed.end()) return;
    const double change = norm_of(block_balance(problem.body, before).left, followed);
    const double carried = found.summary.force_scale;
    if (change <= least_change * carried) return;
    const double allowed =
        change < small_change * carried ? share_of_change * change : std::numeric_limits<double>::infinity();
    for (double& eta : problem.eta) eta *= eta_of_others;
    scale_mass_term(followed, eta_of_lag / eta_of_others, problem);
    const Equilibrium first = found;
    double tolerance_share = 1.0;
    double left = norm_of(found.blocks.left, followed);
    bool lags = !problem.eta.empty();
    for (int round = 0; round < rounds_of_change && (left > allowed || lags); ++round) {
        if (!found.blocks.free.empty()) return;
        tolerance_share = std::max(std::min(tolerance_of_lag, tolerance_share * sharpening * allowed / left), sharpest);
        if (round > 0) scale_mass_term(followed, eta_decay, problem);
        Equilibrium next = found;
        const bool stands = catch_up(problem, balance, tolerance_share, patience_with_lag, next);
        found.iterations = next.iterations;
        if (!stands || next.displacement == found.displacement || parts_at_rest(problem, next.displacement) != followed)
            return;
        const double left_before = std::exchange(left, norm_of(next.blocks.left, followed));
        if (left > falls_by * left_before) { // nothing holds what creeps on
            const int n_spent = found.iterations;
            found = first;
            found.iterations = n_spent;
            return;
        }
        lags = motion(*problem.body.system, followed, next.displacement - found.displacement) >
               share_of_motion * motion(*problem.body.system, followed, next.displacement - before);
        found = std::move(next);
    }
}

Equilibrium EquilibriumSearch::move_on(const EquilibriumProblem& problem, const Eigen::VectorXd& guess,
                                       const BlockGoal& balance, bool unloaded) {
    return find_touching(
        problem, Aim::relaxation, balance, [&](const EquilibriumProblem& held, const Equilibrium* last) {
            return move_held(held, last != nullptr ? last->displacement : guess, balance, unloaded && last == nullptr);
        });
}

/// Where what is left over on a group of blocks adds up to more than may be left, within the tolerance for the body as a whole, a solve
/// finds nothing to do: then a tenth of that is asked for.
Equilibrium EquilibriumSearch::move_held(const EquilibriumProblem& problem, Eigen::VectorXd guess,
                                         const BlockGoal& balance, bool unloaded) {
    Equilibrium moved;
    moved.displacement = std::move(guess);
    IterationGoal goal{.aim = Aim::relaxation, .unloaded = unloaded, .block_tolerance = share_of_solve * balance.share};
    for (;; goal.tolerance_share *= sharpening) {
        moved.summary = open_close_.solve(problem, pattern_, moved.displacement, goal);
        moved.iterations += moved.summary.iterations;
        moved.blocks = block_balance(problem.body, moved.displacement);
        const bool stays = moved.summary.converged() && moved.displacement == problem.start;
        if (!stays || goal.tolerance_share <= sharpest || judge_blocks(moved.blocks, nullptr, balance).balanced())
            break;
    }
    moved.worst_block = moved.summary.worst_block;
    moved.viscous_share = viscous_share(problem, moved.displacement, moved.summary.force_scale);
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
    costs.seconds.local += open_close_.local_seconds();
}

} // namespace kluft

#include "kluft/simulation/load_step.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "kluft/simulation/breaking.hpp"
#include "kluft/simulation/contact_following.hpp"
#include "kluft/simulation/jump.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "kluft/simulation/stress_drop.hpp"

namespace kluft {

namespace {

/// Cuts the step where the first potential crack fails.
Equilibrium cut_at_failure(StepInProgress& p, const PlacedState& placed, Equilibrium found) {
    const double tolerance = p.goal.cracks.event_tolerance;
    const EventGoal event{.last_without = 1.0 + tolerance, .index = 1.0 + 0.5 * tolerance, .reach = 0.5 * tolerance};
    return cut_at_event(p, placed, std::move(found), event,
                        [&](const LoadsAt& at, const Eigen::VectorXd& q) {
                            return largest_failure_index(p, placed.placement, at, q);
                        })
        .found;
}

bool is_event(const StepInProgress& p, const PlacedState& placed, const Equilibrium& found) {
    return largest_failure_index(p, placed.placement, p.loads_at(found), found.displacement) >= 1.0;
}

/// Where none was found at the goal: the equilibrium at the first event before it, or the last one without an event that
/// halving comes to.
std::optional<Equilibrium> find_before_goal(StepInProgress& p, const PlacedState& placed) {
    std::optional<Equilibrium> without_event;
    double without = p.goal.load_factor; // no equilibrium
    for (int i = 0; i < max_trials_without; ++i) {
        const double from = without_event ? without_event->load_factor : p.load_factor();
        const double at = std::midpoint(from, without);
        Equilibrium found = find_at(p, placed, at, without_event ? without_event->displacement : p.displacement());
        if (!found.balanced) {
            without = at;
            continue;
        }
        Equilibrium cut = cut_at_failure(p, placed, found);
        if (cut.load_factor < found.load_factor || is_event(p, placed, cut)) return cut;
        without_event = std::move(found);
    }
    return without_event;
}

/// What the search found up to the first event, or after a relaxation; the step fails where there is neither.
Equilibrium advance(StepInProgress& p, PlacedState& placed) {
    const double target = p.goal.load_factor;
    Equilibrium found = find_at(p, placed, target, predicted(p, target));
    const bool by_events = p.goal.checks_cracks && p.goal.cracks.update == CrackUpdate::event;
    if (!found.balanced && by_events && !p.goal.must_rest && !p.is_at_limit) {
        p.step.smooth = false;
        if (auto before = find_before_goal(p, placed)) {
            p.is_at_limit = !is_event(p, placed, *before);
            return std::move(*before);
        }
    }
    if (!found.balanced) {
        p.step.smooth = false;
        found = recover(p, placed, target);
        if (p.failed()) return found;
        if (!found.balanced && p.bench.loads.constraints().rows().empty())
            fail(p, found, found.viscous_share, FailureKind::no_equilibrium);
    }
    if (found.balanced) follow_loads(p, placed, found);
    if (by_events && found.balanced) {
        const Eigen::VectorXd beyond = found.displacement;
        found = cut_at_failure(p, placed, std::move(found));
        if (found.load_factor < target) // the rest of the way is predicted from what it was without the event
            p.step.end.memory.rate = (beyond - found.displacement) / (target - found.load_factor);
    }
    p.step.smooth = p.step.smooth && found.load_factor == target;
    return found;
}

/// The next load step is predicted from a smooth one.
void keep_predictor(StepInProgress& p) {
    if (p.step.smooth && !p.goal.must_rest) return keep_rate(p);
    p.step.end.memory.rate.resize(0);
}

/// By way of every event before it.
void go_to_goal(StepInProgress& p) {
    const StepGoal& goal = p.goal;
    const bool by_events = goal.cracks.update == CrackUpdate::event;
    if (!p.from.is_settled) settle(p);  // where an earlier attempt has failed, at the same load
    p.is_at_limit = !p.from.is_settled; // that attempt has searched for events: a resumed run ends where it ended
    for (bool first = p.from.is_settled; !p.failed() && (first || p.load_factor() < goal.load_factor); first = false) {
        Eigen::VectorXd placed_at = p.displacement();
        PlacedState placed = place_for_load_step(p);  // 1 detect, 2 transfer
        const Equilibrium found = advance(p, placed); // 3 pose, 4 iterate, 5 judge
        if (!p.failed()) reach(p, std::move(placed), found);
        let_contacts_follow(p, std::move(placed_at)); // 1 to 5 again at the same load, where blocks have moved far
        if (!p.failed() && goal.checks_cracks && (by_events || p.load_factor() >= goal.load_factor))
            break_bonds(p); // 6 crack, 7 weaken, and back to 1 at the same load
    }
}

} // namespace

// ---- the load step -------------------------------------------------------------------------------------------------

Step take_step(const StepBench& bench, const State& from, const StepGoal& goal) {
    StepInProgress p = begin_step(bench, from, goal);
    try {
        go_to_goal(p);
    } catch (const SolvesSpent& spent) {
        fail(p, spent);
    }
    keep_predictor(p);
    return finished(std::move(p)); // 8 commit, 9 notify: the caller's
}

StepGoal goal_at(const StepBench& bench, double load_factor, bool checks_cracks) {
    StepGoal goal;
    goal.load_factor = load_factor;
    goal.balance.share = bench.solver.balance;
    goal.checks_cracks = checks_cracks;
    goal.cracks = bench.cracks;
    goal.solves_before = bench.journal.report().costs.open_close_iterations;
    goal.row = bench.journal.last_row();
    return goal;
}

void begin_load_step(const StepBench& bench) {
    if (bench.solver.repeatable) bench.search.start_anew();
}

StageEnd commit_regular_step(const StepBench& bench, Step step, bool last_of_stage, State& state) {
    const bool ends = last_of_stage || (step.balanced && has_dropped(bench.stage(state), step.end.stresses));
    commit(std::move(step), {.last_of_stage = ends}, state, bench.journal);
    return end_after(bench, state);
}

StageEnd end_after(const StepBench& bench, const State& state) {
    StageEnd end{.step = state.at.step};
    end.has_dropped =
        state.is_settled && state.unbalanced_in_succession == 0 && has_dropped(bench.stage(state), state.stresses);
    if (state.unbalanced_in_succession < bench.solver.max_unbalanced_steps) return end;
    end.failure = Failure{.worst_block = state.imbalance.worst_block,
                          .residual_ratio = state.imbalance.share,
                          .load_factor = state.at.load_factor,
                          .strength_factor = strength_factor(bench.model.loads, state.at.stage, state.at.load_factor),
                          .moving = state.imbalance.moving};
    return end;
}

bool is_checked(const StepBench& bench, const State& state, bool last_of_stage) {
    return bench.model.has_potential_cracks &&
           ((state.at.step + 1) % std::max(1, bench.cracks.every) == 0 || last_of_stage);
}

} // namespace kluft

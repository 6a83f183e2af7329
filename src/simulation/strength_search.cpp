#include "kluft/simulation/strength_search.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace kluft {

namespace {

constexpr double reduction_balance = 0.1;   ///< of the tolerance of a factor of safety: largest `balance`
constexpr double reduction_residual = 0.01; ///< of it: largest `tolerance`

StepGoal goal_with_strengths_of(const StepBench& bench, const State& state, double load_factor) {
    const double tolerance = bench.stage(state).strength_reduction->tolerance;
    StepGoal goal = goal_at(bench, load_factor, bench.model.has_potential_cracks);
    goal.balance.share = std::min(bench.solver.balance, reduction_balance * tolerance);
    goal.must_rest = true;
    return goal;
}

/// The state that the stages before have left must be in equilibrium by the tolerances of this one, too. `equilibria`:
/// what is to be told of it with the first load step.
std::optional<Failure> find_initial_equilibrium(const StepBench& bench, State& state,
                                                std::vector<StepRecord>& equilibria) {
    StepGoal goal = goal_with_strengths_of(bench, state, 0.0);
    goal.checks_cracks = false;
    begin_load_step(bench);
    Step step = take_step(bench, state, goal);
    if (step.failure) return step.failure;
    state = std::move(step.end);
    state.costs = bench.journal.costs();
    bench.journal.warn(step, state.at.step + 1);
    equilibria = std::move(step.equilibria);
    return std::nullopt;
}

/// Tries a load step and commits it, after the equilibria found before, if there is an equilibrium at its end.
std::optional<Failure> try_factor(const StepBench& bench, double load_factor, StepKind kind, State& state,
                                  Eigen::VectorXd& forces, std::vector<StepRecord>& before) {
    begin_load_step(bench);
    Step step = take_step(bench, state, goal_with_strengths_of(bench, state, load_factor));
    if (step.failure) return step.failure;
    forces = std::move(step.forces);
    step.equilibria.insert(step.equilibria.begin(), before.begin(), before.end());
    before.clear();
    commit(std::move(step), kind, state, bench.journal);
    return std::nullopt;
}

} // namespace

double reduction_tolerance(const StrengthReduction& reduction, const SolverOptions& solver) {
    return std::min(solver.tolerance, reduction_residual * reduction.tolerance);
}

StageEnd find_strength_limit(const StepBench& bench, State& state) {
    const StrengthReduction& reduction = *bench.stage(state).strength_reduction;
    const int n_steps = bench.stage(state).steps;
    StageEnd end;
    std::vector<StepRecord> before; // equilibria that are not told yet
    if (state.at.load_factor == 0.0) end.failure = find_initial_equilibrium(bench, state, before);
    if (end.failure) return {.failure = end.failure, .step = state.at.step + 1};
    double failing = 1.0; // load factor
    while (!end.failure && state.at.step_in_stage < n_steps) {
        failing = static_cast<double>(state.at.step_in_stage + 1) / n_steps;
        const bool last = state.at.step_in_stage + 1 == n_steps;
        end.failure = try_factor(bench, failing, {.last_of_stage = last}, state, end.forces, before);
    }
    if (!end.failure) {
        bench.journal.report().warnings.push_back(
            fmt::format("the factor of safety is above {:g}, the largest strength factor of stage {}", reduction.to,
                        state.at.stage));
        return end;
    }
    const auto factor = [&](double load_factor) { return reduction.factor_at(load_factor); };
    const auto is_open = [&] { // where solves were spent, it is not known whether the body stands
        return end.failure->kind != FailureKind::too_many_solves &&
               factor(failing) - factor(state.at.load_factor) > reduction.tolerance * factor(state.at.load_factor);
    };
    while (is_open()) {
        const double middle = 0.5 * (state.at.load_factor + failing);
        if (middle == state.at.load_factor || middle == failing) break; // to the last digit
        if (auto failure = try_factor(bench, middle, {.regular = false}, state, end.forces, before)) {
            end.failure = std::move(failure);
            failing = middle;
        }
    }
    end.step = state.at.step + 1;
    if (end.failure->kind != FailureKind::too_many_solves) end.factor_of_safety = factor(state.at.load_factor);
    return end;
}

} // namespace kluft

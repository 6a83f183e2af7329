#include "kluft/simulation/fixed_steps.hpp"

#include <utility>

namespace kluft {

StageEnd run_fixed_steps(const StepBench& bench, State& state) {
    const int n_steps = bench.stage(state).steps;
    StageEnd end;
    while (!end.ends_run() && state.at.step_in_stage < n_steps) {
        const bool last = state.at.step_in_stage + 1 == n_steps;
        const double target = static_cast<double>(state.at.step_in_stage + 1) / n_steps;
        begin_load_step(bench);
        Step step = take_step(bench, state, goal_at(bench, target, is_checked(bench, state, last)));
        if (step.failure) return commit_balanced_part(std::move(step), state, bench.journal);
        end = commit_regular_step(bench, std::move(step), last, state);
    }
    return end;
}

} // namespace kluft

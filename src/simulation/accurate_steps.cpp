#include "kluft/simulation/accurate_steps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "kluft/simulation/step_attempt.hpp"

namespace kluft {

namespace {

constexpr double accurate_balance = 0.03; ///< of the accuracy asked for: largest `balance`
constexpr double softening_share = 0.2;   ///< of the stress lost since the peak: the accuracy there
constexpr double least_step_size = 1e-4;  ///< load factor of a step that is accepted as it is

/// The accuracy of one load step.
struct LocalAccuracy {
    double accuracy = 0.0;
    bool past_peak = false; ///< by more than the accuracy asked for
    /// Up to this size a load step may be relaxed, and a run may end in it: the history misses no more than the accuracy.
    [[nodiscard]] double small_step() const { return std::max(accuracy, least_step_size); }
};

/// What has been lost since a peak in this stage, where the platen goes on the same way, makes accuracy pointless: the
/// path after the peak depends on every detail, and only the straight lines between the rows are judged there.
LocalAccuracy accuracy_after(const StepBench& bench, const State& state) {
    const StressHistory& stresses = state.stresses;
    const bool may_soften = prescribes_strain(bench.stage(state)) && stresses.stage_of_largest == state.at.stage;
    const double lost = may_soften ? 1.0 - std::abs(stresses.axial) / stresses.largest_axial : 0.0;
    return {std::max(bench.solver.accuracy, softening_share * lost), lost > bench.solver.accuracy};
}

// ---- the size of a step --------------------------------------------------------------------------------------------

/// From a step that was rejected and taken again with a smaller size: the part of the error in proportion to the size
/// is a lag (of the mass-like term, of the tolerance) that does not add up. Nothing where the error does not fall with
/// the size: a jump or a branch of the path.
std::optional<double> lag_from(double size, const StepError& error, double rejected_size, const StepError& rejected,
                               double lag, double accuracy) {
    if (error.chord > rejected.chord && error.chord > accuracy) return std::nullopt;
    const double rate = error.path / size;
    const double rejected_rate = rejected.path / rejected_size;
    if (rate >= rejected_rate) return error.path <= accuracy * size ? std::optional(lag) : std::nullopt;
    return std::clamp(rate - size * (rejected_rate - rate) / (rejected_size - size), 0.0, accuracy);
}

/// The error of a step that ended at an event or was relaxed counts as that of the last one that was judged: in proportion to the square
/// of the size where it is smaller, and to the size, as errors are kept, where it is larger.
void charge_unjudged(const State& before, StepControl& control, double load_factor) {
    if (control.judged_size == 0.0) return;
    const double share = (load_factor - before.at.load_factor) / control.judged_size;
    control.path_error += control.judged_error * share * std::min(share, 1.0);
}

void keep_judged(double size, const StepError& error, bool branches, double accuracy, StepControl& control) {
    control.size = branches ? size : std::max(least_step_size, next_step_size(size, error, accuracy));
    control.judged_size = size;
    control.judged_error = error.path;
    control.path_error += error.path;
}

/// Up to the peak potential cracks fail together as far as the scene has them do so, however roughly their event is met.
StepGoal accurate_goal(const StepBench& bench, const State& before, double target, const LocalAccuracy& local) {
    StepGoal goal = goal_at(bench, target, is_checked(bench, before, target == 1.0));
    goal.accuracy = local.accuracy;
    goal.cracks.event_tolerance =
        local.past_peak ? local.accuracy : std::min(local.accuracy, bench.cracks.event_tolerance);
    goal.balance.share = std::min(bench.solver.balance, accurate_balance * local.accuracy);
    return goal;
}

/// The estimate of the history's error stays at the largest stress, so far where loads are prescribed.
Step with_estimate(const StepBench& bench, const State& before, Step step) {
    StepControl& control = step.end.control;
    if (step.end.stresses.largest_axial > before.stresses.largest_axial || !prescribes_strain(bench.stage(before)))
        control.estimated_error = control.path_error + control.event_error;
    return step;
}

/// A size that was tried and rejected.
struct Rejected {
    double size = 0.0; ///< load factor; 0 where there is none, or where no equilibrium was found with it
    StepError error;
};

/// What an attempt of a size is worth.
struct Verdict {
    bool is_kept = false;
    bool branches = false; ///< the error does not fall with the size
    StepError own;         ///< of the size: without the lag, and past the peak without the path's
    double lag = 0.0;      ///< as it is known now
};

Verdict judge(const LocalAccuracy& local, double size, const StepError& error, const Rejected& rejected, double lag) {
    const bool stands = std::isfinite(error.path);
    const auto learned = stands && rejected.size > 0.0
                             ? lag_from(size, error, rejected.size, rejected.error, lag, local.accuracy)
                             : std::optional(lag);
    Verdict verdict;
    verdict.branches = !learned;
    verdict.lag = learned.value_or(lag);
    verdict.own = {stands && local.past_peak ? 0.0 : std::max(0.0, error.path - verdict.lag * size), error.chord};
    verdict.is_kept =
        verdict.branches || (stands && size <= least_step_size) || is_accurate(size, verdict.own, local.accuracy);
    return verdict;
}

/// One load step: of the size that the accuracy asks for, or up to the next event.
Step take_accurate_step(const StepBench& bench, const State& before) {
    const LocalAccuracy local = accuracy_after(bench, before);
    const double remaining = 1.0 - before.at.load_factor;
    const int solves_before = bench.journal.report().costs.open_close_iterations;
    StepControl control = before.control; // its size and its lag learn from attempts that are rejected
    Rejected rejected;
    for (bool again = false;; again = true) {
        const double size = fitted_step_size(control.size, remaining);
        StepGoal goal = accurate_goal(bench, before, size < remaining ? before.at.load_factor + size : 1.0, local);
        goal.solves_before = solves_before;
        Attempt attempt = try_step(bench, before, goal, control, local.small_step(), again);
        StepControl& reached = attempt.step.end.control;
        const bool is_last = attempt.step.failure &&
                             (size <= local.small_step() || attempt.step.failure->kind == FailureKind::too_many_solves);
        if (is_last || !attempt.error) {
            charge_unjudged(before, reached, attempt.step.end.at.load_factor);
            return with_estimate(bench, before, std::move(attempt.step));
        }
        const Verdict verdict = judge(local, size, *attempt.error, rejected, control.lag);
        control.lag = reached.lag = verdict.lag;
        if (verdict.is_kept) {
            keep_judged(size, verdict.own, verdict.branches, local.accuracy, reached);
            return with_estimate(bench, before, std::move(attempt.step));
        }
        ++bench.journal.report().costs.rejected_steps;
        control.size = next_step_size(size, verdict.own, local.accuracy);
        rejected = {std::isfinite(attempt.error->path) ? size : 0.0, *attempt.error};
    }
}

} // namespace

StageEnd run_accurate_steps(const StepBench& bench, State& state) {
    StageEnd end;
    while (!end.ends_run() && (state.at.load_factor < 1.0 || !state.is_settled)) {
        begin_load_step(bench);
        Step step = state.is_settled ? take_accurate_step(bench, state)
                                     : take_step(bench, state, goal_at(bench, state.at.load_factor, true));
        if (step.failure) return commit_balanced_part(std::move(step), state, bench.journal);
        const bool last = step.end.at.load_factor >= 1.0;
        end = commit_regular_step(bench, std::move(step), last, state);
    }
    return end;
}

} // namespace kluft

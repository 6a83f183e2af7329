// What a run has told and spent so far: the one place that talks to its observer.
#pragma once

#include <chrono>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/processor_time.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/run_report.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

class EquilibriumSearch;

/// Thrown between two solves by a run that was asked to stop.
struct Interrupted {};

/// How a stage ended.
struct StageEnd {
    std::optional<Failure> failure;         ///< the run ends here
    int step = 0;                           ///< the load step that failed, through all stages
    std::optional<double> factor_of_safety; ///< the failure is what was looked for
    std::vector<std::string> causes;        ///< of an end out of balance that are likely, in words
    bool has_dropped = false;               ///< the axial stress, by stop_after_drop of the stage: the run ends here

    /// Whether the stage has no more load steps, and the run no more stages.
    [[nodiscard]] bool ends_run() const { return failure || has_dropped; }
};

/// What a committed load step counts as.
struct StepKind {
    bool regular = true; ///< one of the steps of the stage, and not one between two of them
    bool last_of_stage = false;
};

class Journal {
public:
    /// `n_steps`: load steps of all stages, for the progress; 0 where they follow from an accuracy. `search`: whose costs
    /// count, which must outlive the journal; null without one.
    Journal(const Model& model, const State& state, StepObserver& observer, int n_steps,
            const EquilibriumSearch* search = nullptr);

    [[nodiscard]] const Gauges& gauges() const { return gauges_; }
    /// The report so far; its costs are those that costs() begins with.
    [[nodiscard]] RunReport& report() { return report_; }
    /// All that the run has spent, also before the state that it started from.
    [[nodiscard]] RunCosts costs() const;
    /// Wall-clock time of the same (s).
    [[nodiscard]] double elapsed() const;
    /// The last row that was told, or that a resumed run goes on from.
    [[nodiscard]] const StepRecord& last_row() const { return last_row_; }

    /// Tells the state before any load.
    void begin(StepRecord row, const State& state, LoadedPlacement in_place);
    /// A resumed run goes on from the load step of this row, which was told before.
    void go_on_from(StepRecord row) { last_row_ = std::move(row); }
    /// Tells the equilibria, the cracks and the jumps of a step.
    void tell(const Step& step);
    /// Keeps the warning of a load step with this number, the first of a run, and the largest index that one has checked.
    void warn(const Step& step, int number);
    [[nodiscard]] const CheckedIndex& largest_checked() const { return largest_checked_; }
    /// What a state saved now has to keep of what the run says at its end.
    [[nodiscard]] Remarks remarks() const { return {largest_checked_, report_.warnings}; }
    /// Tells the row and the state of a committed load step.
    void tell_state(const StepRecord& row, const State& state, LoadedPlacement in_place, bool last_of_stage);
    /// Tells where a load step stands: at `load_factor` on its way from the state, `row` being the last equilibrium's.
    void progress(const State& state, const StepRecord& row, double load_factor, int n_solves,
                  std::optional<double> share_of_step = std::nullopt);

    /// The report of a run that has ended in the stage of `state`, or that was cut short.
    [[nodiscard]] RunReport ended(const State& state, const StageEnd& end) const;
    [[nodiscard]] RunReport cut_short(RunStatus status, std::string why) const;

private:
    const Model& model_;
    StepObserver& observer_;
    const EquilibriumSearch* search_;
    Gauges gauges_;
    int n_steps_ = 0;
    bool warned_of_lost_contact_ = false;
    CheckedIndex largest_checked_;
    StepRecord last_row_;
    RunReport report_;
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
    double cpu_at_start_ = processor_seconds();
};

/// Makes the end of the step the state, which only this changes during a stage, and tells what happened in the step.
void commit(Step step, StepKind kind, State& state, Journal& journal);

/// Commits what there is of a load step that failed, which ends at its last balanced equilibrium (keep_balanced_part);
/// nothing where it has none, or where a resumed run has failed again without getting any further.
[[nodiscard]] StageEnd commit_balanced_part(Step step, State& state, Journal& journal);

/// "load step 9: stresses reach 1.4 times the strength of a potential crack before it is checked, since ..." where that is more than a
/// tenth; else "". Potential cracks fail at a check only: what they carry beyond their criterion until then is strength that they do not
/// have. `remedy`: what finds where each of them fails.
[[nodiscard]] std::string warning_of_late_checks(const CheckedIndex& largest, std::string_view why,
                                                 std::string_view remedy);

/// Load steps of all stages.
[[nodiscard]] int number_of_steps(const Model& model);

/// Runs what returns a report. Whatever ends it, the state is that of the last committed load step: Interrupted,
/// ResourceError and lack of memory become a status.
template <class Run> RunReport report_of(Journal& journal, Run run) {
    try {
        return run();
    } catch (const Interrupted&) {
        return journal.cut_short(RunStatus::interrupted, "");
    } catch (const ResourceError& error) {
        return journal.cut_short(RunStatus::out_of_resources, error.what());
    } catch (const std::bad_alloc&) {
        return journal.cut_short(RunStatus::out_of_resources, "out of memory");
    }
}

} // namespace kluft

// What a run reports when it has ended.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/simulation/run_costs.hpp"
#include "kluft/simulation/run_status.hpp"

namespace kluft {

/// Numbers that only some runs have.
struct RunResults {
    std::optional<double> factor_of_safety; ///< by a stage that reduces the strengths, if that found the limit
    std::optional<double> estimated_error;  ///< of the history up to its peak, where an accuracy was asked for
};

/// Calls visit(name, member) for each of them, by its name in summary.json and in the tables of a study. `results`:
/// RunResults, const or not.
template <class Results, class Visit> void visit_results(Results& results, Visit&& visit) {
    visit("factor_of_safety", results.factor_of_safety);
    visit("estimated_error", results.estimated_error);
}

struct RunReport {
    RunStatus status = RunStatus::done;
    std::string diagnosis; ///< names the blocks and interfaces concerned, or what ran out; empty for `done`
    RunResults results;
    RunCosts costs; ///< also of the parts of the run before a resumed state
    int unbalanced_steps = 0;
    int detections = 0;
    int crack_checks = 0;
    std::vector<std::string> warnings;
    std::optional<MotionReport> motion; ///< of explicit runs
};

} // namespace kluft

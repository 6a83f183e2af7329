// A run: stages of load steps, each solved to equilibrium, with cracks at their events.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/run_costs.hpp"
#include "kluft/simulation/run_status.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

struct RunReport {
    RunStatus status = RunStatus::done;
    std::string diagnosis; ///< names the blocks and interfaces concerned, or what ran out; empty for `done`
    RunCosts costs;        ///< also of the parts of the run before a resumed state
    int unbalanced_steps = 0;
    int detections = 0;
    int crack_checks = 0;
    std::optional<double> factor_of_safety; ///< by a stage that reduces the strengths, if that found the limit
    std::optional<double> estimated_error;  ///< of the history up to its peak, where an accuracy was asked for
    std::vector<std::string> warnings;
    std::optional<MotionReport> motion; ///< of explicit runs
};

/// The state before any load.
[[nodiscard]] State initial_state(const Model& model);

/// Runs the stages from `state` on, which is always left at the last committed load step. `stop` is looked at between
/// solves. Out of memory, or where the observer throws ResourceError, the run ends with `out_of_resources`. A repeatable
/// run leaves the BLAS of the process with one thread.
RunReport run_simulation(const Model& model, const CrackOptions& cracks, const SolverOptions& solver, State& state,
                         StepObserver& observer, const std::atomic<bool>& stop);

} // namespace kluft

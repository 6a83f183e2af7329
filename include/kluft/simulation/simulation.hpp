// A run: stages of load steps, each solved to equilibrium, with cracks at their events.
#pragma once

#include <atomic>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/run_report.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

/// The state before any load.
[[nodiscard]] State initial_state(const Model& model);

/// Runs the stages from `state` on, which is always left at the last committed load step. `stop` is looked at between
/// solves. Out of memory, or where the observer throws ResourceError, the run ends with `out_of_resources`. A repeatable
/// run leaves the BLAS of the process with one thread.
RunReport run_simulation(const Model& model, const CrackOptions& cracks, const SolverOptions& solver, State& state,
                         StepObserver& observer, const std::atomic<bool>& stop);

} // namespace kluft

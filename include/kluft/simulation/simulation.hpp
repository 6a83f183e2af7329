// A run: stages of load steps, each solved to equilibrium, with cracks at their events.
#pragma once

#include <atomic>
#include <string>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/run_status.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

/// Where the time of a run went (s).
struct RunSeconds {
    double detection = 0.0;
    double set_up = 0.0;   ///< bonds, pattern look-ups, constant tangent
    double assembly = 0.0; ///< residuals and tangents
    double analysis = 0.0;
    double factorization = 0.0;
    double solution = 0.0;
    double crack_check = 0.0;
    double observers = 0.0;
};

struct RunReport {
    RunStatus status = RunStatus::done;
    std::string diagnosis;         ///< names the blocks and interfaces concerned; empty for `done`
    int open_close_iterations = 0; ///< all linear solves
    int unbalanced_steps = 0;
    int relaxations = 0;
    int events = 0; ///< equilibria at which potential cracks failed
    int detections = 0;
    int crack_checks = 0;
    LinearSolverStatistics linear;
    RunSeconds seconds;
};

/// The state before any load.
[[nodiscard]] State initial_state(const Model& model);

/// Runs the stages from `state` on, which is always left at the last committed load step. `stop` is looked at between
/// solves. A repeatable run leaves the BLAS of the process with one thread. Throws ResourceError out of memory.
RunReport run_simulation(const Model& model, const CrackOptions& cracks, const SolverOptions& solver, State& state,
                         StepObserver& observer, const std::atomic<bool>& stop);

} // namespace kluft

// A run by explicit integration: the same body, laws, detection and loads as the implicit run, and nothing of its
// solver. It exists so that implicit results can be validated.
#pragma once

#include <atomic>
#include <string>

#include "kluft/simulation/simulation.hpp"

namespace kluft {

/// Runs the stages from `state` on, at rest, which is left at the last committed load step. A load step moves its load
/// smoothly from one value to the next over at least 10 crossings of the body by an elastic wave (100 in a stage with
/// fewer than ten steps), slower while the unbalanced force is above a tenth of `solver.balance`, and then waits until the
/// body and each of its blocks are at rest (docs/theory.md, "Rest"); where a block is not, it is unbalanced.
/// With `loading_rate` a platen moves at that constant velocity instead, and nothing waits: only the body as a whole is
/// judged, and a block that may fall is warned of. Of `solver` only `balance`
/// and `max_unbalanced_steps` count. Ends as run_simulation does.
RunReport run_explicit(const Model& model, const CrackOptions& cracks, const SolverOptions& solver,
                       const ExplicitOptions& options, State& state, StepObserver& observer,
                       const std::atomic<bool>& stop);

/// "stages.1: a load step takes 1.0e+12 time steps of ..., since ..." of the first stage whose load steps take more than anyone waits for;
/// "" without one.
[[nodiscard]] std::string warning_of_long_steps(const Model& model, const ExplicitOptions& options);

} // namespace kluft

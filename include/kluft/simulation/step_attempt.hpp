// A load step of a size that is tried, and what it says of its own error (docs/theory.md, "Load steps from an accuracy").
#pragma once

#include <optional>

#include "kluft/simulation/step_control.hpp"
#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

struct Attempt {
    Step step;
    std::optional<StepError>
        error; ///< nothing where the step ended at an event or was relaxed; infinite where it failed
};

/// Moves from a state towards the goal's load factor, up to the first event, with the step control as it has become.
/// A step without an event is taken once as a whole and once in two halves, which count. Where no equilibrium is found at
/// once it is relaxed only if it is no larger than `small_step` (load factor). Contacts are detected where a step is taken
/// `again`.
[[nodiscard]] Attempt try_step(const StepBench& bench, const State& from, const StepGoal& goal,
                               const StepControl& control, double small_step, bool again);

} // namespace kluft

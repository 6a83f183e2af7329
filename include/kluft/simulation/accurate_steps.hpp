// Load steps whose size follows from the accuracy asked for (docs/theory.md, "Load steps from an accuracy").
#pragma once

#include "kluft/simulation/load_step.hpp"

namespace kluft {

/// Takes load steps to the end of the stage, and commits those that are accurate enough; the others are dropped and taken
/// again with a smaller size.
[[nodiscard]] StageEnd run_accurate_steps(const StepBench& bench, State& state);

} // namespace kluft

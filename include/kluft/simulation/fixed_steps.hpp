// Load steps of equal size: as many as the stage says.
#pragma once

#include "kluft/simulation/load_step.hpp"

namespace kluft {

/// Takes the load steps of the stage that are left, and commits them.
[[nodiscard]] StageEnd run_fixed_steps(const StepBench& bench, State& state);

} // namespace kluft

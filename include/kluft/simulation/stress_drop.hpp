// The axial stresses that a run has had so far, and whether a stage ends because its stress has fallen from the largest.
#pragma once

#include "kluft/loading/load_program.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Takes in the axial stress of the next equilibrium. Unbalanced ones are never the largest.
void note_axial_stress(const Stage& stage, const StepRecord& row, StressHistory& stresses);

/// Whether the last axial stress is by `stop_after_drop` or more below the largest of the stage, both in the sense of the
/// stage's platen: positive in compression where it presses, in tension where it pulls. Never where none was above zero.
[[nodiscard]] bool has_dropped(const Stage& stage, const StressHistory& stresses);

} // namespace kluft

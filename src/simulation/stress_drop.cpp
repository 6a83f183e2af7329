#include "kluft/simulation/stress_drop.hpp"

#include <algorithm>
#include <cmath>

namespace kluft {

namespace {

double in_sense_of_platen(const Stage& stage, double axial_stress) {
    return stage.motion && stage.motion->value < 0.0 ? -axial_stress : axial_stress;
}

} // namespace

void note_axial_stress(const Stage& stage, const StepRecord& row, StressHistory& stresses) {
    stresses.axial = row.axial_stress;
    if (!row.balanced) return;
    stresses.largest_in_stage = std::max(stresses.largest_in_stage, in_sense_of_platen(stage, row.axial_stress));
    if (std::abs(row.axial_stress) <= stresses.largest_axial) return;
    stresses.largest_axial = std::abs(row.axial_stress);
    stresses.stage_of_largest = row.stage;
}

bool has_dropped(const Stage& stage, const StressHistory& stresses) {
    if (!stage.stop_after_drop || !(stresses.largest_in_stage > 0.0)) return false;
    const double left = (1.0 - *stage.stop_after_drop) * stresses.largest_in_stage;
    return in_sense_of_platen(stage, stresses.axial) <= left;
}

} // namespace kluft

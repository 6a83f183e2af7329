// Pseudo-transient continuation: the body moves at a load level until it stands, held by a larger mass-like term
// (docs/theory.md, relaxation).
#pragma once

#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// Where a search has failed: relaxes from the state that the step stands at. What is found is an equilibrium, or an
/// unbalanced state at a load that a platen's travel limits; or the step has failed. The step then stands, placed anew, where the
/// relaxation has come to.
[[nodiscard]] Equilibrium recover(StepInProgress& in_progress, PlacedState& placed, const Equilibrium& failed,
                                  double load_factor);

} // namespace kluft

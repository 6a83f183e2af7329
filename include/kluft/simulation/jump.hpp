// Where equilibrium is lost the body moves on at fixed loads, over-damped, until it stands again (docs/theory.md, Jumps).
#pragma once

#include "kluft/simulation/over_damped_motion.hpp"
#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// Whether an equilibrium found at fixed loads lies so far away that the body jumps to it.
[[nodiscard]] bool is_jump(const StepInProgress& in_progress, const Equilibrium& found);

/// Follows M dq/dt = -R from where the step stands, under the loads of the load factor, with potential cracks failing on
/// the way where the goal checks their events. What is found is an equilibrium, or an unbalanced state at a load that a
/// platen's travel limits; or the step has failed. The step then stands, placed anew, where the body has come to.
[[nodiscard]] Equilibrium follow_motion(StepInProgress& in_progress, PlacedState& placed, double load_factor,
                                        const MotionControl& control = {});

/// Where a search has found nothing, or an equilibrium that is not where the body comes to: follows its motion, and the
/// step keeps its last balanced part.
[[nodiscard]] Equilibrium recover(StepInProgress& in_progress, PlacedState& placed, double load_factor,
                                  const MotionControl& control = {});

} // namespace kluft

// Contacts detected anew at a load that stays: what a body stands on may have moved away from under it within a solve.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// Finds equilibrium at the load factor that the step stands at, with contacts detected anew, and makes it the end of the
/// step.
Equilibrium find_again(StepInProgress& in_progress);

/// Frames of contacts stay during a solve, so that a block which slides far in it may be held by a face that it has passed.
/// Under given loads a step therefore ends only where the blocks that have moved since `placed_at` (m), the displacements of
/// the last detection, stand with contacts detected anew, which leave no block or group out of balance by more than a tenth of what acts
/// on it; else they fall. Where two sets of contacts take turns in one place, the body stands with either.
void let_contacts_follow(StepInProgress& in_progress, Eigen::VectorXd placed_at);

/// What is to be said of a committed state under given loads in which contacts detected anew leave more than a tenth of what acts on a
/// block out of balance. "" of any other state.
[[nodiscard]] std::string contacts_anew_warning(const Model& model, const State& state);

} // namespace kluft

// Potential cracks that fail at the end of a load step, and the equilibrium after them.
#pragma once

#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// Makes potential cracks fail at the end of the step and finds equilibrium again at the same load, until none fails.
void break_bonds(StepInProgress& in_progress);

/// Finds equilibrium at the load factor that the step starts from, of a state in which bonds have failed and none was found
/// since, and goes on as break_bonds does.
void settle(StepInProgress& in_progress);

/// Makes potential cracks fail that do so in the placed state where the body stands, out of equilibrium. False where none
/// does.
bool break_at(StepInProgress& in_progress, const PlacedState& placed, const LoadsAt& at);

/// The largest failure index f of the potential cracks at q; at most 10, for a strength of zero makes it infinite.
[[nodiscard]] double largest_failure_index(const StepInProgress& in_progress, const Placement& placement,
                                           const LoadsAt& at, const Eigen::VectorXd& q);

} // namespace kluft

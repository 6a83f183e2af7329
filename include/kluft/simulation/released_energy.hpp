// The energy that a motion releases (docs/theory.md, Jumps).
#pragma once

#include "kluft/simulation/step_in_progress.hpp"

namespace kluft {

/// What is known of it on the way (J/m).
struct MotionEnergy {
    Eigen::VectorXd driving; ///< eta M dq of the step before (N/m); empty where the forces have just changed
    double by_forces = 0.0;  ///< released, by the work of the forces out of balance
    double available = 0.0;  ///< stored at the start, and what loads and platens have put in since
};

/// Stored where the step stands.
[[nodiscard]] MotionEnergy energy_at_start(const StepInProgress& in_progress, const PlacedState& placed,
                                           const LoadsAt& at);

/// M dq/dt, the forces out of balance at the end of a pseudo-time step (N/m).
[[nodiscard]] Eigen::VectorXd driving_forces(const BlockSystem& system, const Eigen::VectorXd& velocity);

/// Adds the work of the loads, and that of the forces out of balance by the trapezoidal rule, from where the step stands to `end`,
/// where `driving` is left of them.
void add_motion(const StepInProgress& in_progress, const PlacedState& placed, const LoadsAt& at,
                const Eigen::VectorXd& end, Eigen::VectorXd driving, MotionEnergy& energy);

/// The work of moved platens with the forces that hold the body in balance where the step stands, per unit of load factor (J/m).
[[nodiscard]] double work_of_platens(const StepInProgress& in_progress, const PlacedState& placed);

/// The way from where the step stands to `end` on which platens move by a part of the loads. What they put in against the mass-like
/// forces is not the body's: of their work only `work`, that with the forces of the last equilibrium, counts (J/m).
void add_platen_motion(const StepInProgress& in_progress, const PlacedState& placed, const LoadsAt& after,
                       const Eigen::VectorXd& end, double work, MotionEnergy& energy);

/// At the end of a motion. Contacts that are found deep in each other bring energy with them, of which no part is released: it is at
/// most what was available less what is still stored. Where the force of a platen is given that is not known.
[[nodiscard]] double released_energy(const StepInProgress& in_progress, const PlacedState& placed, const LoadsAt& at,
                                     const Eigen::VectorXd& end, const MotionEnergy& energy);

} // namespace kluft

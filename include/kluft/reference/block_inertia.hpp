// Inertia of the blocks and the time step that is stable with it.
#pragma once

#include <vector>

#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/simulation_options.hpp"

namespace kluft {

/// One 6 x 6 matrix per block. Side by side along the diagonal they bound the tangent of the whole body from above,
/// since a spring between two blocks stretches by x - y and (x - y)^2 <= 2 x^2 + 2 y^2. Every contact point counts as
/// closed and locked.
[[nodiscard]] std::vector<Mat6> stiffness_bounds(const LoadedBody& body);

/// The same for the body as it was cut, with all its interfaces closed: what inertia is scaled by.
[[nodiscard]] std::vector<Mat6> initial_stiffness_bounds(const Model& model);

/// Mass per metre of thickness of every block (kg/m). With `uniform_step` translation and deformation of each block get
/// the inertia that gives it the same largest frequency as all others; the body keeps its mass (that of 1000 kg/m3 where
/// no material has a density).
[[nodiscard]] std::vector<Mat6> block_masses(const Model& model, DensityScaling scaling);

/// An upper bound of the largest natural frequency (rad/s).
[[nodiscard]] double largest_frequency(const std::vector<Mat6>& stiffness, const std::vector<Mat6>& mass);

/// 0.8 (2/omega)/sqrt(1 + alpha): central differences are stable up to 2/omega, to which local damping adds a force
/// of alpha times the unbalanced one; a fifth is left for what the stiffness bound does not know (friction that follows
/// the pressure, rotations, follower loads) (s).
[[nodiscard]] double stable_time_step(double frequency, double damping);

/// The time a wave of the body's effective stiffness takes along its longest side (s).
[[nodiscard]] double crossing_time(const Model& model, const std::vector<Mat6>& mass);

} // namespace kluft

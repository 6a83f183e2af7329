// The ready-made study of what accuracy costs: every numerical setting of a scene and the choices of its model.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/scene/scene.hpp"

namespace kluft {

/// The text of a study file about the scene: step counts from 25 to 800 of its main stage with every crack update, then
/// one setting varied at a time about the scene's own: check interval, event tolerance, residual tolerance, detection
/// interval, accuracy, integrator; and as other models of the rock size, rotation and jitter of the hexagons, Voronoi
/// cells and the kinematics of blocks. Only what makes sense for the scene and what scenes know is varied. The main
/// stage is the last one that moves a platen or reduces strengths. Every variant of the study gives all its numerical
/// settings, so that cases can be told apart as finer and coarser, but those that its integrator refuses. Of a scene
/// that is explicit itself the cracks' interval is varied instead of what that integrator does not use; a scene's own
/// `solver.accuracy` holds in the variant of accuracies only, since elsewhere it would take other steps than those
/// given. The reference has the most steps, cuts them at
/// events to 1e-3 and has a residual tolerance of 1e-6 or the scene's own.
/// `path`: of the scene as the study file names it. `quantities`: to be compared, the first of them to be recommended
/// for; empty: peak stress, peak strain, Young's modulus and residual stress where a platen is moved, else the factor of
/// safety. Throws InputError without quantities where the scene has neither.
[[nodiscard]] std::string trade_study(const std::filesystem::path& path, const Scene& scene,
                                      const std::vector<std::string>& quantities = {});

} // namespace kluft

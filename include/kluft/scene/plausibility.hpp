// Values that a scene may have and that are hardly meant: a lost unit, a forgotten side, a key that changes nothing.
#pragma once

#include "kluft/scene/reading_context.hpp"
#include "kluft/scene/scene.hpp"

namespace kluft {

/// Warnings: a material softer than 1 MPa or stiffer than diamond, or of no rock's density; a joint stiffer than a
/// millimetre of steel or softer than a metre of clay, or with nothing that keeps it from sliding; stresses below 100 Pa, friction
/// below 2 degrees and strains above 20 %, whose units may be missing; pressures that pull; a pressure on one side of a rectangle against which nothing stands; an interface of given blocks where
/// the body is cut, a seed of strengths that do not scatter, strengths of materials that no potential
/// crack takes. `root` is the whole scene.
void warn_of_implausible_values(const SceneSection& root, const Scene& scene, ReadingContext& context);

} // namespace kluft

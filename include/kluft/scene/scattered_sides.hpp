// Boundaries whose sides lie in several places of the outline.
#pragma once

#include <string>
#include <vector>

#include "kluft/scene/scene.hpp"

namespace kluft {

/// A warning where boundaries of sides that face one way hold or press some that lie well behind the outermost ones: the face of a slope or
/// the underside of a ledge beside the sides of the body. Not where all of the outline is pressed or held.
[[nodiscard]] std::vector<std::string> scattered_sides(const Scene& scene);

} // namespace kluft

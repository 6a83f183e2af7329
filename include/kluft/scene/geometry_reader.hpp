// Reads the geometry and the boundaries of a scene.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/scene/reading_context.hpp"

namespace kluft {

/// `root` is the whole scene; the names are those of its materials and interfaces. The domain comes out
/// counter-clockwise with the same first corner, boundaries in this order: bottom, right, top, left, or as given.
/// Reads the GeoJSON files that the scene names.
[[nodiscard]] GeometrySpec read_geometry(const SceneSection& root, const std::vector<std::string>& materials,
                                         const std::vector<std::string>& interfaces, ReadingContext& context);

} // namespace kluft

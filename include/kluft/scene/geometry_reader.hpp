// Reads the geometry and the boundaries of a scene.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/scene/reading_context.hpp"

namespace kluft {

/// `root` is the whole scene; the names are those of its materials and interfaces. The domain comes out
/// counter-clockwise with the same first corner, boundaries in this order: bottom, right, top, left, or as given.
/// Of given blocks the sides count through the polygons of all blocks. Reads the maps that the scene names.
[[nodiscard]] GeometrySpec read_geometry(const SceneSection& root, const std::vector<std::string>& materials,
                                         const std::vector<std::string>& interfaces, ReadingContext& context);

/// What may be called in place of a block: the names of the sets and of the given blocks.
[[nodiscard]] std::vector<std::string> block_names(const GeometrySpec& spec);

} // namespace kluft

// The subdivision of the plane by line segments, computed with exact arithmetic.
#pragma once

#include <vector>

#include "kluft/blocks/planar_map.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

/// A piece of what cuts the body. Where segments overlap, the common part belongs to the smallest source.
struct SourceSegment {
    Vec2 a = Vec2::Zero();
    Vec2 b = Vec2::Zero();
    int source = 0;
};

/// Splits the segments at all their common points, found exactly; the vertices are then rounded to doubles. Segments
/// without length are left out. The faces keep the numbers of the exact subdivision, of which face 0 is the unbounded
/// one. Vertices of the result are the segments' ends and crossings, so an edge may end freely.
[[nodiscard]] PlanarMap arrange(const std::vector<SourceSegment>& segments);

} // namespace kluft

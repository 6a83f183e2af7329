// Measures of simple polygons given by their vertices.
#pragma once

#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// Area enclosed by the vertices (m2), positive if they run counter-clockwise. Summed about the first vertex, so that
/// a position far from the origin costs no digits.
[[nodiscard]] double signed_area(const std::vector<Vec2>& polygon);

/// Whether p lies inside the simple polygon; a point exactly on the outline counts as inside.
[[nodiscard]] bool contains(const std::vector<Vec2>& polygon, const Vec2& p);

/// Whether no two sides of the polygon have more in common than the vertex between successive ones.
[[nodiscard]] bool is_simple(const std::vector<Vec2>& polygon);

struct Box {
    Vec2 lower = Vec2::Zero();
    Vec2 upper = Vec2::Zero();
};

/// The smallest box with sides along the axes that holds the points; throws std::invalid_argument without points.
[[nodiscard]] Box bounding_box(const std::vector<Vec2>& points);

} // namespace kluft

// The outline of a domain and the groups of its sides that make boundaries.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

enum class Facing { left, right, top, bottom };

/// "left", "right", "top", "bottom".
[[nodiscard]] std::string_view facing_name(Facing facing);

/// The polygon counter-clockwise with the same first vertex.
[[nodiscard]] Polygon counter_clockwise(const Polygon& polygon);

/// Index in counter_clockwise(polygon) of side `side` (vertex `side` to the next) of a polygon with `n_sides`.
[[nodiscard]] int counter_clockwise_side(int side, int n_sides, bool was_clockwise);

/// Sides of a counter-clockwise polygon whose outward normal points within 45 degrees of a direction; exactly 45 degrees
/// counts as top or bottom, so that every side of non-zero length faces one way only.
[[nodiscard]] std::vector<int> sides_facing(const Polygon& polygon, Facing facing);

/// The first two sides that cross each other. Plain floating-point arithmetic: clear cases only; the block cutter decides
/// exactly.
[[nodiscard]] std::optional<std::pair<int, int>> crossing_sides(const Polygon& polygon);

} // namespace kluft

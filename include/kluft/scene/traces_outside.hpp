// Which lines of a scene have no part in its body.
#pragma once

#include <cstddef>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// A line that has no part in the body and none on its outline.
struct LineOutside {
    std::size_t line = 0; ///< its index
    bool in_hole = false; ///< of the domain; else it lies outside the domain
};

/// Those of the polylines that lie outside a domain with holes. One that only touches the outline lies outside, too.
[[nodiscard]] std::vector<LineOutside> lines_outside(const Polygon& domain, const std::vector<Polygon>& holes,
                                                     const std::vector<std::vector<Vec2>>& lines);

/// The same of the traces of fractures.
[[nodiscard]] std::vector<LineOutside> traces_outside(const GeometrySpec& geometry);

/// Whether a polygon has no area in common with the domain less its holes.
[[nodiscard]] bool is_outside(const Polygon& region, const Polygon& domain, const std::vector<Polygon>& holes);

} // namespace kluft

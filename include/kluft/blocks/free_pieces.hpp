// Pieces of traces that end inside a block and separate nothing.
#pragma once

#include <vector>

#include "kluft/blocks/arrangement.hpp"
#include "kluft/blocks/planar_map.hpp"

namespace kluft {

/// The edges of the map that have the same face on both sides, in the order of the map.
[[nodiscard]] std::vector<SourceSegment> free_pieces(const PlanarMap& map);

/// The pieces joined again with a map that was mended without them: pieces shorter than `reach` (m) shrink to that end that
/// lies on the map or joins more of them,
/// ends within `reach` of a vertex of the map move there, other ends within `reach` of an edge to the nearest point of it,
/// where the edge gets a vertex. A piece that comes nearer than `reach` to another line, or leaves it at less than
/// 14 degrees, is left out: no triangle fits between them.
[[nodiscard]] std::vector<SourceSegment> joined_pieces(PlanarMap& map, const std::vector<SourceSegment>& pieces,
                                                       double reach);

} // namespace kluft

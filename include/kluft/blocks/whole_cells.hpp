// Cells of a net that nothing cuts, put into a subdivision without arithmetic.
#pragma once

#include <array>
#include <vector>

#include "kluft/blocks/planar_map.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

/// A hexagon of a net. Side k runs from vertex k to vertex k + 1, counter-clockwise; `across` is the whole cell behind
/// it, -1 where a cell is that may be cut.
struct WholeCell {
    std::array<int, 6> vertices{};
    std::array<int, 6> across{};
};

struct WholeCells {
    std::vector<Vec2> vertices; ///< local coordinates (m)
    std::vector<WholeCell> cells;
};

/// Puts the cells into the faces that the other cells of the net leave for them: all sides without a whole cell across
/// are edges of the map already, between vertices with the same bits. Vertices, edges and faces of the map keep their
/// numbers, those that are added follow after them; edges get `source`. A face that the cells fill is empty from now on.
void insert_whole_cells(PlanarMap& map, const WholeCells& whole, int source);

} // namespace kluft

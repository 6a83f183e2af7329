// Outlines of blocks as drawn: deformed vertices, loops, keyhole polygons.
#pragma once

#include <utility>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

/// For each block the index of its first vertex in FieldRecord::displacement, and the total number at the end.
/// Size n_blocks + 1.
[[nodiscard]] std::vector<std::size_t> first_vertices(const BlockSystem& system);

/// The edges [begin, end) of each loop of a block.
[[nodiscard]] std::vector<std::pair<int, int>> loop_ranges(const Block& block);

/// The edge after `edge` in its loop: its start is the end of `edge`.
[[nodiscard]] int next_edge(const Block& block, int edge);

/// The block's outline as one closed polygon of edge indices (each stands for the edge's start). A hole is joined to
/// the outline by a pair of coincident bridges, so that its vertex and that of the outline come twice.
[[nodiscard]] std::vector<int> keyhole_polygon(const BlockSystem& system, const Block& block);

/// What the two sides of an interface did, at the start and at the end of block a's edge.
struct InterfaceMotion {
    Vec2 start_a; ///< displacement of side a (m)
    Vec2 end_a;
    Vec2 start_b; ///< displacement of side b at the same places (m)
    Vec2 end_b;
};

/// Displacements of both sides of an interface. `displacement` as in FieldRecord, `first` from first_vertices.
[[nodiscard]] InterfaceMotion interface_motion(const BlockSystem& system, const std::vector<std::size_t>& first,
                                               const std::vector<Vec2>& displacement, const Interface& interface);

} // namespace kluft

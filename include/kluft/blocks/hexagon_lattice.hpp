// The edges of a net of regular hexagons, from integer vertex indices.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/blocks/whole_cells.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft {

/// Edges of all hexagons that can meet `box` and whose centre `keeps`, each edge once; local coordinates (origin = the
/// lower left corner of the domain's box, from which the lattice's offset counts).
///
/// A vertex with lattice indices (p, q) lies at offset + R(rotation) (p d/2, q d/(2 sqrt 3)) + jitter(p, q), computed
/// once from p and q: hexagons that share a vertex share its bits. The jitter is uniform in a disc of radius
/// jitter * spacing and depends on (seed, p, q) only, so it is the same on every machine and for every box.
/// Throws InputError for a spacing that is not positive and finite or a jitter outside [0, 0.25).
[[nodiscard]] std::vector<std::pair<Vec2, Vec2>> hexagon_edges(const HexagonLattice& lattice, const Box& box,
                                                               const std::function<bool(const Vec2&)>& keeps);

/// A net in two parts: cells that nothing cuts, and the edges of all others.
struct HexagonNet {
    WholeCells whole;
    std::vector<std::pair<Vec2, Vec2>> edges; ///< each once
};

/// The net of `hexagon_edges`. A hexagon is whole if its centre `is_clear` and all six neighbours are kept, whole or not: all
/// sides of a whole one without another across are among `edges`, and the cells along the rim of the net are not whole. All
/// vertices of a hexagon whose centre is clear must lie in `box`.
[[nodiscard]] HexagonNet hexagon_net(const HexagonLattice& lattice, const Box& box,
                                     const std::function<bool(const Vec2&)>& keeps,
                                     const std::function<bool(const Vec2&)>& is_clear);

/// Farthest that a vertex lies from its hexagon's centre (m).
[[nodiscard]] double hexagon_reach(const HexagonLattice& lattice);

/// Area of one hexagon of spacing d: sqrt(3)/2 d^2 (m2).
[[nodiscard]] double hexagon_area(double spacing);

} // namespace kluft

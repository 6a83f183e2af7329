// The edges of a net of Voronoi cells of random points.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft {

/// Each cell of a net of Voronoi cells that can meet a box; local coordinates (origin = the lower left corner of the
/// domain's box, from which the net's offset counts).
struct VoronoiNet {
    struct Edge {
        Vec2 start;
        Vec2 end;
        int left = 0; ///< point on the left of the way from start to end
        int right = 0;
    };
    std::vector<Vec2> points; ///< of the cells
    std::vector<Edge> edges;  ///< each once; both points are among `points`
};

/// The net's cells in and around `box`, all whose edges can meet it among them.
///
/// The plane is divided into squares of side a, a^2 = sqrt(3)/2 spacing^2, with one random point each: the square's
/// middle plus the sum of three independent vectors, uniform in a square of side a about zero. One such vector would
/// leave nothing of the squares' order in the mean density (Klatt, Kim and Torquato 2020), but pairs of points, and with
/// them the edges, would still prefer the squares' directions; the sum of three is as good as isotropic.
/// Each of Lloyd's passes (Lloyd 1982) then moves every point to the centroid of its cell, which makes cells rounder,
/// more equal and their shortest edges longer. Points, centroids and vertices are integers, in units of a/65536, and
/// are computed without rounding before that to the unit, so that the net is a function of seed and passes: the same
/// for every box, on every machine. Throws InputError for a spacing that is not positive and finite, passes outside
/// 0 to most_relaxation, an offset beyond 1e9 spacings or a box of more than 60 000 cells in a row.
[[nodiscard]] VoronoiNet voronoi_net(const VoronoiCells& cells, const Box& box);

constexpr int most_relaxation = 20;

/// Farthest that a corner lies from its cell's point: 2 sqrt(2) a before any pass, less after it (m).
[[nodiscard]] double voronoi_reach(const VoronoiCells& cells);

/// Edges of the cells whose point `keeps` that can meet `box`.
[[nodiscard]] std::vector<std::pair<Vec2, Vec2>> voronoi_edges(const VoronoiCells& cells, const Box& box,
                                                               const std::function<bool(const Vec2&)>& keeps);

} // namespace kluft

// The sides of a body before loading: where they lie, which way they face, which lie across.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/loading/boundary_loads.hpp"
#include "kluft/loading/load_program.hpp"

namespace kluft {

/// Mean outward normal of a boundary before loading (unit; zero where its sides face all ways, as around a hole), and its
/// length (m).
struct BoundaryFrame {
    Vec2 normal = Vec2::Zero();
    double length = 0.0;
};
[[nodiscard]] BoundaryFrame boundary_frame(const BlockSystem& system, int boundary);

/// The boundaries whose normals are most opposite to that of `boundary`, within 1e-6 of the cosine, in their order; none if no boundary faces the
/// other way within 60 degrees.
[[nodiscard]] std::vector<int> opposite_boundaries(const BlockSystem& system, int boundary);
/// The first of them; -1 if there is none.
[[nodiscard]] int opposite_boundary(const BlockSystem& system, int boundary);
/// The boundary that rests on a fixed platen while one moves: the opposite one, or what the scene says; -1 for none.
[[nodiscard]] int resting_boundary(const BlockSystem& system, const PlatenMotion& motion);

/// Mean position of a boundary before loading, local coordinates (m).
[[nodiscard]] Vec2 mean_position(const BlockSystem& system, int boundary);

/// Mean displacement of a boundary, weighted by length (m).
[[nodiscard]] Vec2 mean_displacement(const BlockSystem& system, const Eigen::VectorXd& q, int boundary);

/// The distance of the outer edges of a boundary from those of the opposite one along its normal; without one, from the farthest point
/// of the body behind it (m).
[[nodiscard]] double distance_across(const BlockSystem& system, int boundary);

/// What a boundary has of one side of a body. The shares of its edges are their lengths across the side's direction over the height of the
/// body between its two sides, so that the sum of their places, times their shares, differs between the sides by the area between
/// them over that height: columns side by side, notches and openings included. Of two sides of different lengths the shorter counts as much as the
/// longer, by its mean place.
struct SidePart {
    int boundary = -1;
    std::vector<BoundaryEdge> edges;
    std::vector<double> shares; ///< of the edges
    double weight = 0.0;        ///< sum of the shares
    double share = 0.0;         ///< of the side's length
};
using Side = std::vector<SidePart>;
/// The two sides across `boundary`, that of its normal turned clockwise first: on each all boundaries that face it most. Both are
/// empty if there are not two.
[[nodiscard]] std::array<Side, 2> lateral_sides(const BlockSystem& system, int boundary);

/// Mean displacement of a part of a side, weighted by its shares (m).
[[nodiscard]] Vec2 mean_displacement(const BlockSystem& system, const Eigen::VectorXd& q, const SidePart& part);

/// Edges of a boundary that a platen on it can be laid on: no part of the body lies in front of them, as it does of the
/// floor and the roof of an opening.
[[nodiscard]] std::vector<BoundaryEdge> outer_edges(const BlockSystem& system, int boundary);

/// The width of these across the direction in which a platen presses (m).
[[nodiscard]] double outer_width(const BlockSystem& system, int boundary, const Vec2& lateral);

/// The place of edges that lies farthest along a direction (m).
[[nodiscard]] double outermost_place(const BlockSystem& system, const std::vector<BoundaryEdge>& edges,
                                     const Vec2& direction);

/// Mean outward normal of a side of a body (unit).
[[nodiscard]] Vec2 mean_normal(const BlockSystem& system, const Side& side);

/// How far the outer edges lie apart along the normal of the boundary (m).
[[nodiscard]] double unevenness(const BlockSystem& system, int boundary);

/// The mean width of the body under a platen on `boundary` (m): the mean distance of the lateral sides, or the width of
/// its outer edges where that is more, as with columns side by side; it grows in proportion to the former.
[[nodiscard]] PlatenForce width_across(const BlockSystem& system, int boundary);

/// The length on which a pressure on a boundary presses along its normal, as cut (m). 0 for a boundary without a normal.
[[nodiscard]] double pressed_length(const BlockSystem& system, int boundary);

} // namespace kluft

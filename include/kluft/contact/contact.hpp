// Identity, frame and memory of contact points.
#pragma once

#include <compare>
#include <optional>

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/interface_law.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

/// Who touches whom: an edge of block a against an edge of block b (the points of their overlap, from 0 on), or a vertex of
/// block a (the start of edge_a) against an edge of block b (point -1).
struct ContactKey {
    int block_a = 0;
    int edge_a = 0;
    int block_b = 0;
    int edge_b = 0;
    int point = 0;

    auto operator<=>(const ContactKey&) const = default;
};

/// Key of a point of an interface's own two edges, the lower block first.
[[nodiscard]] inline ContactKey key_of_own_edges(const Interface& i, int point) {
    return i.block_a < i.block_b ? ContactKey{i.block_a, i.edge_a, i.block_b, i.edge_b, point}
                                 : ContactKey{i.block_b, i.edge_b, i.block_a, i.edge_a, point};
}

struct ContactMemory {
    ContactKey key;
    PointHistory history;

    bool operator==(const ContactMemory&) const = default;
};

/// By how much the two points of a pair move on along the whole overlap, and the piece of it that the pair stands for.
struct OverlapPiece {
    Vec2 xi_a = Vec2::Zero();   ///< block coordinates
    Vec2 xi_b = Vec2::Zero();   ///< block coordinates
    Vec2 offset = Vec2::Zero(); ///< of X_b - X_a (m)
    double from = 0.0;          ///< from the pair, over the overlap's length
    double to = 0.0;
};

/// A pair of points of two blocks with a frame that stays fixed during a solve, so that gap and slip are linear in
/// the unknowns and the tangent is exact.
struct ContactPoint {
    int block_a = 0;
    int block_b = 0;
    Vec2 xi_a = Vec2::Zero(); ///< block coordinates of the point of a
    Vec2 xi_b = Vec2::Zero();
    Vec2 offset = Vec2::Zero();  ///< X_b - X_a before loading (m); zero where the two points were one
    Vec2 normal = Vec2::Zero();  ///< from a to b
    Vec2 tangent = Vec2::Zero(); ///< normal turned by +90 degrees
    double weight = 0.0;         ///< length that the point stands for (m)
    double along = 0.0;          ///< place in the overlap, 0 to 1; of a vertex 0
    double slip_start = 0.0;     ///< tangent . relative position where slip = 0 (m)
    OverlapPiece piece;          ///< zero for a vertex
    int law = 0;                 ///< index of the interface law
    int interface = -1;          ///< the interface of a fracture's own two edges; -1 otherwise
    PointHistory history;        ///< at the start of the load step
    std::optional<double>
        held_limit; ///< of the shear traction (Pa), in searches of an equilibrium only; else Coulomb's
    ContactKey key;
};

/// x_b - x_a at displacements q (m).
[[nodiscard]] inline Vec2 relative_position(const ContactPoint& point, const Eigen::VectorXd& q) {
    return point.offset + displacement_at(q, point.block_b, point.xi_b) - displacement_at(q, point.block_a, point.xi_a);
}

/// By how much the gap grows over the whole overlap at displacements q (m).
[[nodiscard]] inline double tilt(const ContactPoint& point, const Eigen::VectorXd& q) {
    const OverlapPiece& piece = point.piece;
    const Vec2 zero = Vec2::Zero();
    const auto moved = [&](int block, const Vec2& along) {
        return Vec2(displacement_at(q, block, along) - displacement_at(q, block, zero));
    };
    return point.normal.dot(piece.offset + moved(point.block_b, piece.xi_b) - moved(point.block_a, piece.xi_a));
}

} // namespace kluft

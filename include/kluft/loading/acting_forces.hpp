// Every force that acts on the blocks of a body, at its place: what an independent program needs to balance them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/core/vector.hpp"

namespace kluft {

struct LoadedBody;

/// What holds two blocks together at a point, or does not.
enum class MeetingState { bonded, locked, sliding, open };

/// A point where two blocks meet. It stands for a piece of the interface over which the traction is taken as even: the force on
/// block a is length (normal_traction normal + shear_traction tangent), with the tangent = normal turned by +90 degrees, at
/// place_a; on block b it is the opposite, at place_b.
struct ContactForce {
    int block_a = 0;
    int block_b = 0;
    Vec2 place_a = Vec2::Zero(); ///< at the displacements, local coordinates (m)
    Vec2 place_b =
        Vec2::Zero();    ///< apart from place_a by the opening and by what has slipped since the points were paired
    double length = 0.0; ///< m
    Vec2 normal = Vec2::Zero();   ///< from a to b
    double normal_traction = 0.0; ///< Pa, positive in tension
    double shear_traction = 0.0;  ///< Pa, positive where b has moved along the tangent against a
    MeetingState state = MeetingState::open;
    int law = 0; ///< index of the interface law
};

enum class SupportKind {
    weight,   ///< of the block, at its centroid
    pressure, ///< on an edge, at its middle
    force,    ///< on a point of the block
    platen,   ///< reaction and friction at a vertex
    support,  ///< reaction of a boundary's support at a vertex
    fixed     ///< what holds a fixed block where it is
};

/// A force on a block from outside the body.
struct SupportForce {
    int block = 0;
    int boundary = -1; ///< -1: none
    SupportKind kind = SupportKind::force;
    Vec2 force = Vec2::Zero(); ///< N per metre of thickness
    Vec2 place = Vec2::Zero(); ///< at the displacements, local coordinates (m)
};

/// All points of the bonds and contacts of the body's placement, open ones included.
[[nodiscard]] std::vector<ContactForce> contact_forces(const LoadedBody& body, const Eigen::VectorXd& q);

/// Weights, pressures, point forces and the reactions of platens, supports and fixed blocks, without those that are zero. The
/// reactions are those that leave nothing over on what they hold; of a platen under a given stress they sum up to its force as
/// far as the state is balanced.
[[nodiscard]] std::vector<SupportForce> support_forces(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft

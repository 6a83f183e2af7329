// The unknowns that a body is solved for: the six numbers of each affine block, or (u_x, u_y, w) of each rigid one.
// States are six numbers per block in either kinematics; increments and what is projected or solved have the unknowns
// alone.
#pragma once

#include <Eigen/Core>

#include "kluft/equilibrium/rigid_terms.hpp"

namespace kluft {

/// The way between displacements q, size 6 n_blocks, and the unknowns r of a body; T = dq/dr (docs/theory.md, section
/// 1).
class Coordinates {
public:
    Coordinates(const BlockSystem& system, Kinematics kinematics) : system_(&system), kinematics_(kinematics) {}

    [[nodiscard]] bool are_rigid() const { return kinematics_ == Kinematics::rigid; }
    [[nodiscard]] int per_block() const { return unknowns_per_block(kinematics_); }
    [[nodiscard]] int n_blocks() const { return system_->n_blocks(); }
    /// Number of unknowns of the body.
    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(per_block()) * n_blocks(); }

    /// Moves q by s times an increment of the unknowns; rotations of rigid blocks add up exactly. `moved` may be q
    /// itself.
    void move(const Eigen::VectorXd& q, const Eigen::VectorXd& increment, double s, Eigen::VectorXd& moved) const;
    /// |dD| of block `b` in an increment of the unknowns: how far it turns and is strained, times its size (m).
    [[nodiscard]] double distortion(const Eigen::VectorXd& increment, int b) const;
    /// The larger of |du| and |dD| of block `b` in an increment of the unknowns (m).
    [[nodiscard]] double motion(const Eigen::VectorXd& increment, int b) const;
    /// The square of the norm of block `b`'s part of a vector over the unknowns.
    [[nodiscard]] double squared_norm(const Eigen::VectorXd& v, int b) const;
    /// What round-off makes of displacements at q (m).
    [[nodiscard]] double roundoff(const Eigen::VectorXd& q) const;

    /// Sets T to that at q.
    void turn_to(const Eigen::VectorXd& q);
    /// The directions that rigid blocks have turned to; affine blocks have none.
    [[nodiscard]] const RigidTurns& turns() const { return turns_; }
    /// Forces on the unknowns, T' forces, from those on the six numbers.
    void reduce(const Eigen::VectorXd& forces, Eigen::VectorXd& reduced) const;
    /// The norm of |T|' magnitudes, sums of magnitudes on the six numbers.
    [[nodiscard]] double norm_of_magnitudes(const Eigen::VectorXd& magnitudes) const;

private:
    const BlockSystem* system_;
    Kinematics kinematics_;
    RigidTurns turns_;
};

} // namespace kluft

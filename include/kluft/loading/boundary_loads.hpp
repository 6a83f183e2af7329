// Loads and prescribed displacements on the outline of the body.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/kinematics/rigid.hpp"

namespace kluft {

/// A follower pressure on one edge of the outline (Pa, positive inward).
struct PressureEdge {
    int block = 0;
    int boundary = 0;
    Vec2 xi_middle = Vec2::Zero();
    Vec2 extent = Vec2::Zero();    ///< X_end - X_start (m)
    Vec2 xi_extent = Vec2::Zero(); ///< xi_end - xi_start
};

/// All edges of boundary `i` as pressure edges.
[[nodiscard]] std::vector<PressureEdge> pressure_edges(const BlockSystem& system, int boundary);

/// x_end - x_start of the edge at displacements q (m).
[[nodiscard]] Vec2 current_extent(const PressureEdge& edge, const Eigen::VectorXd& q);

/// The share of the pressure that acts on an edge, 1 until it has turned by 80 degrees and 0 from a right angle on, where it
/// has left the face that is under pressure; and its derivative by the current extent (1/m).
struct PressedShare {
    double value = 1.0;
    Vec2 by_extent = Vec2::Zero();
};
[[nodiscard]] PressedShare pressed_share(const PressureEdge& edge, const Vec2& extent);

/// Force of the pressure on the edge at displacements q: -pressure times the share that acts times the current outward
/// normal times length (N/m).
[[nodiscard]] Vec2 pressure_force(const PressureEdge& edge, double pressure, const Eigen::VectorXd& q);

/// direction . displacement(xi) of a block is prescribed to be target + rate * travel (m).
struct PrescribedDisplacement {
    int block = 0;
    Vec2 xi = Vec2::Zero();
    Vec2 direction = Vec2::Zero();
    int boundary = 0; ///< whose support it is; -1 for a fixed block
    double target = 0.0;
    double rate = 0.0;     ///< not zero: moves with a rigid platen whose travel is unknown
    double start = 0.0;    ///< target at the start of the stage (m)
    double velocity = 0.0; ///< of the target per unit of load factor (m)
    int platen_point = -1; ///< the point of a platen that it holds
};

/// The force on a rigid platen that its travel follows from: stress times the current width.
struct PlatenForce {
    double stress = 0.0;      ///< Pa, positive in compression
    double width = 0.0;       ///< before loading (m)
    Eigen::VectorXd widening; ///< derivative of the width by the unknowns
    [[nodiscard]] double at(const Eigen::VectorXd& q) const { return stress * (width + widening.dot(q)); }
};

/// The rows of one block.
struct ConstrainedBlock {
    int block = 0;
    std::vector<int> rows;
    Mat6 projector;                                   ///< onto the null space of the rows
    Eigen::Matrix<double, 6, Eigen::Dynamic> inverse; ///< pseudo-inverse of the rows
    Mat3 rigid_projector;                             ///< the same for a rigid block
    Eigen::Matrix<double, 3, Eigen::Dynamic> rigid_inverse;
    Mat63 motion; ///< T of a rigid block
};

/// Prescribed displacements, block by block. They hold exactly: the unknowns move in the null space of the rows.
class Constraints {
public:
    Constraints() = default;
    explicit Constraints(std::vector<PrescribedDisplacement> rows);
    /// Of rigid blocks: the increments, motions and vectors to be projected below have three unknowns per block. The rows
    /// are linearised at `q`, which is exact as long as constrained blocks keep the rotation that they have there, and
    /// they do: the two ends of a held edge fix it.
    Constraints(std::vector<PrescribedDisplacement> rows, const BlockSystem& system, const Eigen::VectorXd& q);
    [[nodiscard]] Kinematics kinematics() const { return kinematics_; }

    [[nodiscard]] const std::vector<PrescribedDisplacement>& rows() const { return rows_; }
    /// In ascending order.
    [[nodiscard]] const std::vector<ConstrainedBlock>& blocks() const { return blocks_; }
    /// Sets the targets of a load factor.
    void move_to(double load_factor);

    /// Least-norm change of q that fulfils the rows (zero where they hold), with the travel that is nearest to q. Where
    /// rows of a block contradict each other it is the least-squares compromise. Rows that miss their targets by no more than
    /// `roundoff` (m) hold: where they lie so near to each other that they hardly tell a turn from a shift, their inverse makes
    /// much of what round-off leaves.
    void correction(const Eigen::VectorXd& q, Eigen::VectorXd& dq, double roundoff = 0.0) const;
    /// The first row of a block whose rows cannot all change at their velocities; -1 if there is none.
    [[nodiscard]] int contradicting_row() const;
    /// Least-norm motion of the n unknowns for unit travel; zero without a travelling platen.
    [[nodiscard]] Eigen::VectorXd travel_motion(Eigen::Index n) const;
    /// Removes the constrained part of a vector of unknowns or forces.
    void project(Eigen::VectorXd& v) const;
    /// The same for a vector of one block.
    void project(int block, Vec6& v) const;
    /// The force that each row exerts on its block along its direction, of such a residual (N/m).
    [[nodiscard]] std::vector<double> row_forces(const Eigen::VectorXd& residual) const;
    /// Force that the support of `boundary` exerts on the body when `residual` = internal - other external forces, six
    /// per block in either kinematics.
    [[nodiscard]] Vec2 reaction(const Eigen::VectorXd& residual, int boundary) const;
    /// Takes what the supports exert out of such a residual: forces of all external and internal origin remain.
    void add_reactions(Eigen::VectorXd& residual) const;

private:
    [[nodiscard]] Eigen::VectorXd multipliers(const ConstrainedBlock& c, const Eigen::VectorXd& residual) const;

    Kinematics kinematics_ = Kinematics::affine;
    std::vector<PrescribedDisplacement> rows_;
    std::vector<ConstrainedBlock> blocks_;
};

} // namespace kluft

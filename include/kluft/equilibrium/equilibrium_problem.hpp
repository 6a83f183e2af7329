// One equilibrium to be found: the body, its contacts in frozen frames and its loads, and the one residual
// R(q) = internal + interface - external + eta M (q - q_start) that defines it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/equilibrium/boundary_terms.hpp"
#include "kluft/equilibrium/rigid_terms.hpp"
#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// A loaded body with the mass-like term that leads to its equilibrium.
struct EquilibriumProblem {
    LoadedBody body;
    std::vector<double> eta;      ///< per block, of the mass-like term (Pa/m2); empty switches it off
    double least_mass_area = 0.0; ///< a block counts with at least this area in M (m2)
    Eigen::VectorXd start;        ///< q_start of the mass-like term
};

enum class TangentKind {
    exact,     ///< unsymmetric where points slide or pressures follow
    symmetric, ///< positive definite part: sliding points without shear stiffness, no load stiffness
    touching   ///< every point without a gap closed and locked: for a body that no load has closed yet
};

struct Residual {
    Eigen::VectorXd forces;   ///< R, size 6 n_blocks in either kinematics (N/m)
    double force_scale = 0.0; ///< F_ref: norm of the sums of magnitudes of contact forces, block forces and loads (N/m)
    double roundoff = 0.0;    ///< size of R that round-off of the displacements alone makes (N/m)
};

/// Evaluates a problem that must outlive it; cheap to make.
class EquilibriumEvaluator {
public:
    /// `pattern` must contain every pair of the problem's points.
    EquilibriumEvaluator(const EquilibriumProblem& problem, const BlockPattern& pattern)
        : problem_(problem), pattern_(pattern) {}

    /// R(q).
    void residual(const Eigen::VectorXd& q, Residual& result);
    /// Of rigid blocks, T' of forces on the six numbers at the q of the last residual: size 3 n_blocks.
    void reduce_to_unknowns(const Eigen::VectorXd& forces, Eigen::VectorXd& reduced) const;
    /// dR/dq. Of rigid blocks with T = dq/d(u, w): T' dR/dq T and what the forces do on the curve that a turning block
    /// moves on; the pattern must be one of rigid blocks then.
    void tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);

private:
    void add_mass_forces(const Eigen::VectorXd& q, Eigen::VectorXd& forces) const;
    void set_bond_tangents(BlockMatrix& matrix) const;
    void add_block_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const;
    void add_contact_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const;
    void rigid_tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);
    void set_rigid_bond_tangents(BlockMatrix& matrix) const;
    void add_rigid_contact_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const;
    void add_rigid_block_tangents(TangentKind kind, BlockMatrix& matrix) const;

    const EquilibriumProblem& problem_;
    const BlockPattern& pattern_;
    BodyForces body_forces_;
    Eigen::VectorXd turned_to_;      ///< of rigid blocks: the q of what follows
    RigidTurns turns_;               ///< at that q
    std::vector<double> curvatures_; ///< stiffness against w from the forces at that q, per block
};

/// M of a block: the integral of N' N over its area (m2), or over `least_area` if that is more, but not
/// more than 20 times its own.
[[nodiscard]] Mat6 mass_matrix(const Block& block, double least_area);

/// The norm of eta M (q - q_start) (N/m).
[[nodiscard]] double viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q);

/// The positive definite part of a contact point's tangent: a sliding point has no shear stiffness.
[[nodiscard]] Mat2 symmetric_tangent(const PointTraction& traction);

} // namespace kluft

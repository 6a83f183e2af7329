// One equilibrium to be found: the body, its contacts in frozen frames and its loads, and the one residual
// R(q) = internal + interface - external + eta M (q - q_start) that defines it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/equilibrium/coordinates.hpp"
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
    Eigen::VectorXd forces;   ///< R, size 6 n_blocks in either kinematics, or T' R on the unknowns (N/m)
    double force_scale = 0.0; ///< F_ref: norm of the sums of magnitudes of contact forces, block forces and loads (N/m)
    double roundoff = 0.0;    ///< size of R that round-off of the displacements alone makes (N/m)
};

/// Evaluates a problem that must outlive it; cheap to make.
class EquilibriumEvaluator {
public:
    /// `pattern` must contain every pair of the problem's points.
    EquilibriumEvaluator(const EquilibriumProblem& problem, const BlockPattern& pattern);

    [[nodiscard]] const EquilibriumProblem& problem() const { return problem_; }
    /// Of the problem; what they reduce is seen from the q of the last residual.
    [[nodiscard]] const Coordinates& coordinates() const { return coordinates_; }

    /// Evaluates R(q).
    void residual(const Eigen::VectorXd& q, Residual& result);
    /// Evaluates the same on the unknowns, T' R(q).
    void reduced_residual(const Eigen::VectorXd& q, Residual& result);
    /// Evaluates dR/dq. Of rigid blocks with T = dq/d(u, w): T' dR/dq T and what the forces do on the curve that a
    /// turning block moves on; the pattern must be one of rigid blocks then.
    void tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);

private:
    void sum_forces(const Eigen::VectorXd& q, Residual& result);
    void add_mass_forces(const Eigen::VectorXd& q, Eigen::VectorXd& forces) const;
    void rigid_tangent_at(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);

    const EquilibriumProblem& problem_;
    const BlockPattern& pattern_;
    Coordinates coordinates_;
    double area_ = 0.0; ///< of the body (m2)
    BodyForces body_forces_;
    Eigen::VectorXd turned_to_;      ///< of rigid blocks: the q of the last residual
    std::vector<double> curvatures_; ///< stiffness against w from the forces at that q, per block
};

/// M of a block: the integral of N' N over its area (m2), or over `least_area` if that is more, but not
/// more than 20 times its own.
[[nodiscard]] Mat6 mass_matrix(const Block& block, double least_area);

/// M times six numbers of the block.
[[nodiscard]] Vec6 mass_product(const Block& block, double least_area, const Vec6& of);

/// The size of eta M (q - q_start) (N/m).
struct ViscousForce {
    double norm = 0.0; ///< of all unknowns
    double sum = 0.0;  ///< of the norms on the blocks: no part of the body is out of balance by more
};
[[nodiscard]] ViscousForce viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q);

/// The positive definite part of a contact point's tangent: a sliding point has no shear stiffness.
[[nodiscard]] Mat2 symmetric_tangent(const PointTraction& traction);

} // namespace kluft

// One equilibrium to be found: the body, its contacts in frozen frames and its loads, and the one residual
// R(q) = internal + interface - external + eta M (q - q_start) that defines it.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/block_elasticity.hpp"
#include "kluft/constitutive/interface_law.hpp"
#include "kluft/contact/contact.hpp"
#include "kluft/equilibrium/boundary_terms.hpp"

namespace kluft {

struct EquilibriumProblem {
    const BlockSystem* system = nullptr;
    const std::vector<ElasticModuli>* moduli = nullptr; ///< per material
    const std::vector<InterfaceLaw>* laws = nullptr;
    std::vector<ContactPoint> bonds;
    std::vector<ContactPoint> contacts;
    std::vector<PressureEdge> pressure_edges;
    std::vector<double> pressures; ///< per boundary (Pa)
    std::vector<double> densities; ///< per material (kg/m3); empty without gravity
    Vec2 gravity = Vec2::Zero();   ///< m/s2
    Constraints constraints;
    std::optional<PlatenForce> platen_force; ///< on the platen whose travel is unknown
    std::vector<double> eta;                 ///< per block, of the mass-like term (Pa/m2); empty switches it off
    double least_mass_area = 0.0;            ///< a block counts with at least this area in M (m2)
    Eigen::VectorXd start;                   ///< q_start of the mass-like term
};

enum class TangentKind {
    exact,     ///< unsymmetric where points slide or pressures follow
    symmetric, ///< positive definite part: sliding points without shear stiffness, no load stiffness
    touching   ///< every point without a gap closed and locked: for a body that no load has closed yet
};

struct Residual {
    Eigen::VectorXd forces;   ///< R, size 6 n_blocks (N/m)
    double force_scale = 0.0; ///< F_ref: norm of the sums of magnitudes of contact forces, block forces and loads (N/m)
    double roundoff = 0.0;    ///< size of R that round-off of the displacements alone makes (N/m)
};

/// Work space of the evaluation; sizes follow the problem.
class EquilibriumEvaluator {
public:
    /// `pattern` must contain every pair of the problem's points.
    EquilibriumEvaluator(const EquilibriumProblem& problem, const BlockPattern& pattern);

    /// R(q).
    void residual(const Eigen::VectorXd& q, Residual& result);
    /// dR/dq.
    void tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);

private:
    using Slots = std::array<int, 4>; ///< entries (aa, ab, ba, bb) of the pattern
    void add_mass_tangent(BlockMatrix& matrix) const;

    const EquilibriumProblem& problem_;
    const BlockPattern& pattern_;
    std::vector<Slots> bond_slots_;
    std::vector<Slots> contact_slots_;
    std::vector<int> diagonal_;
    BlockMatrix bonds_and_mass_; ///< the part of the tangent that stays constant
    Eigen::VectorXd magnitudes_;
};

/// The norm of eta M (q - q_start) (N/m).
[[nodiscard]] double viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q);

/// The traction of a contact point of the problem at q; `i` indexes problem.contacts.
[[nodiscard]] PointTraction contact_traction(const EquilibriumProblem& problem, int i, const Eigen::VectorXd& q);
[[nodiscard]] PointTraction bond_traction(const EquilibriumProblem& problem, int i, const Eigen::VectorXd& q);

/// The positive definite part of a contact point's tangent: a sliding point has no shear stiffness.
[[nodiscard]] Mat2 symmetric_tangent(const PointTraction& traction);

/// Cauchy stress of each block at q (Pa, positive in tension).
[[nodiscard]] std::vector<Mat2> block_stresses(const BlockSystem& system, const std::vector<ElasticModuli>& moduli,
                                               const Eigen::VectorXd& q);

} // namespace kluft

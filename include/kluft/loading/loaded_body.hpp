// A body with its contacts in frozen frames and its loads, and the one sum of its forces: internal + interface -
// external. What solves for equilibrium and what integrates the motion both start from it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/block_elasticity.hpp"
#include "kluft/constitutive/interface_law.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/contact/contact.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/loading/boundary_loads.hpp"
#include "kluft/loading/platen.hpp"

namespace kluft {

/// A force of constant direction on a material point (N per metre of thickness).
struct PointLoad {
    int block = 0;
    Vec2 xi = Vec2::Zero();
    Vec2 force = Vec2::Zero();
};

/// Where the blocks of a body meet, in frames that stay fixed during a solve.
struct Placement {
    std::vector<Bond> bonds;
    std::vector<ContactPoint> contacts;
};

/// What acts on a body and what holds it, at one load level.
struct Loads {
    Constraints constraints;
    std::vector<PressureEdge> pressure_edges;
    std::vector<double> pressures; ///< per boundary (Pa)
    std::vector<PointLoad> point_loads;
    Vec2 gravity = Vec2::Zero();             ///< m/s2; fixed blocks have no weight
    std::optional<PlatenForce> platen_force; ///< on the platen whose travel is unknown
    std::vector<Platen> platens;
    std::vector<PlatenPoint> platen_points; ///< those that touch are rows of the constraints
    std::vector<PointLoad> friction;        ///< of the platens on the sliding points
};

/// A body in one placement under one load. It refers to its parts, which must outlive it: bodies under different loads
/// share a placement at no cost.
struct LoadedBody {
    Kinematics kinematics = Kinematics::affine; ///< rigid blocks have no elastic forces
    const BlockSystem* system = nullptr;
    const std::vector<ElasticModuli>* moduli = nullptr; ///< per material
    const std::vector<double>* densities = nullptr;     ///< per material (kg/m3); null without gravity
    const std::vector<InterfaceLaw>* laws = nullptr;
    const Placement* placement = nullptr;
    const Loads* loads = nullptr;
    /// The largest axial stress in the run so far, of a body that only moved platens load (Pa); 0 of others.
    double carried_stress = 0.0;
};
/// What counts as no force on a part of the body of `area` (m2), beside those that it has carried (N/m). Source: (27c).
[[nodiscard]] double negligible_force(double carried_stress, double area);

/// The weight of block `b` under the gravity of the loads (N/m); zero of a fixed one, whose weight nothing but its support
/// feels.
[[nodiscard]] Vec2 weight_of(const LoadedBody& body, int b);

struct BodyForces {
    Eigen::VectorXd forces;     ///< internal + interface - external, size 6 n_blocks (N/m)
    Eigen::VectorXd magnitudes; ///< sums of the magnitudes of what `forces` is made of; their norm is F_ref
    double stiffest = 0.0;      ///< of the springs and blocks (Pa)
};

/// Sums the forces at q.
void body_forces(const LoadedBody& body, const Eigen::VectorXd& q, BodyForces& result);
/// The same without the magnitudes, which it leaves alone. `tractions`: those of the contacts, in their order.
void body_forces(const LoadedBody& body, const Eigen::VectorXd& q, BodyForces& result,
                 std::vector<PointTraction>& tractions);

/// The external forces at q alone: weights, pressures, point loads and the friction of platens, without the supports'
/// (N/m).
void external_forces(const LoadedBody& body, const Eigen::VectorXd& q, Eigen::VectorXd& result);

/// The motion of all `n_unknowns` for unit travel of the platen under a given force (1); empty where there is none.
[[nodiscard]] Eigen::VectorXd travel_of_platen(const Loads& loads, Eigen::Index n_unknowns);
/// Takes the reactions of supports and platens out of `forces` at q on the unknowns, internal - external (N/m). What remains
/// has the work of the forces in every free motion, the `travel` of the platen included.
void keep_free_part(const Loads& loads, const Eigen::VectorXd& travel, const Eigen::VectorXd& q,
                    Eigen::VectorXd& forces);

/// The sum of the magnitudes of weight, pressures and point loads at q, per block (N/m).
[[nodiscard]] std::vector<double> load_magnitudes(const LoadedBody& body, const Eigen::VectorXd& q);
/// The weight and the magnitude of the resultant of pressures and point loads at q, per block (N/m).
[[nodiscard]] std::vector<double> driving_loads(const LoadedBody& body, const Eigen::VectorXd& q);
/// Sum of the magnitudes of the components of all loads along a direction (N/m).
[[nodiscard]] double loads_along(const LoadedBody& body, const Eigen::VectorXd& q, const Vec2& direction);

struct GapAndSlip {
    double gap = 0.0;  ///< total (m)
    double slip = 0.0; ///< since the history was kept (m)
};
[[nodiscard]] inline GapAndSlip gap_and_slip(const ContactPoint& point, const Eigen::VectorXd& q) {
    const Vec2 relative = relative_position(point, q);
    return {point.normal.dot(relative), point.tangent.dot(relative) - point.slip_start};
}

/// The piece of an overlap whose cohesion a point carries, at q; none for a law without cohesion.
[[nodiscard]] ContactPiece piece_at(const InterfaceLaw& law, const ContactPoint& point, const Eigen::VectorXd& q);

/// Coulomb's limit of a contact point at q, at the dilation that its history has (Pa).
[[nodiscard]] double coulomb_limit(const std::vector<InterfaceLaw>& laws, const ContactPoint& point,
                                   const Eigen::VectorXd& q);

/// The traction at q of a contact point, or of a point (0 or 1) of a bond; `i` indexes body.contacts or .bonds.
[[nodiscard]] PointTraction contact_traction(const std::vector<InterfaceLaw>& laws, const ContactPoint& point,
                                             const Eigen::VectorXd& q);
[[nodiscard]] PointTraction contact_traction(const LoadedBody& body, int i, const Eigen::VectorXd& q);
[[nodiscard]] PointTraction bond_traction(const LoadedBody& body, int i, int point, const Eigen::VectorXd& q);

/// Cauchy stress of each block at q (Pa, positive in tension).
[[nodiscard]] std::vector<Mat2> block_stresses(const BlockSystem& system, const std::vector<ElasticModuli>& moduli,
                                               const Eigen::VectorXd& q);

/// The same of all blocks of a body in either kinematics. Of a rigid block it is the mean stress of the forces on its
/// outline, supports included, (1/A) sym sum f x (Love-Weber).
[[nodiscard]] std::vector<Mat2> block_stresses(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft

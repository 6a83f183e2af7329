// The points of bonded interfaces: their pairing never changes, so they need no detection.
#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/interface_law.hpp"
#include "kluft/core/vector.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

inline constexpr int n_bond_points = 2; ///< Gauss points per bonded edge
inline const std::array<double, n_bond_points> gauss_positions{0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};

/// A bonded interface: its two Gauss points in one frame that stays fixed during a solve, so that its traction is linear
/// in the unknowns.
struct Bond {
    int interface = 0;
    int law = 0; ///< index of the interface law
    int block_a = 0;
    int block_b = 0;
    std::array<Vec2, n_bond_points> xi_a; ///< block coordinates of the points
    std::array<Vec2, n_bond_points> xi_b;
    Vec2 tangent = Vec2::Zero();                     ///< mean direction of the two edges
    double weight = 0.0;                             ///< length that each point stands for (m)
    std::array<double, n_bond_points> slip_start{};  ///< tangent . relative displacement where slip = 0 (m)
    std::array<double, n_bond_points> shear_start{}; ///< shear traction there (Pa)

    /// From a to b.
    [[nodiscard]] Vec2 normal() const { return right_normal(tangent); }
};

/// The bond of interface `i` in the frame of the mean direction of its two edges at q, where slip = 0 and the shear
/// tractions of its points are `shear` (Pa).
[[nodiscard]] Bond bond_at(const BlockSystem& system, int i, const Eigen::VectorXd& q, const double* shear);

/// u_b - u_a at a point of a bond (m).
[[nodiscard]] inline Vec2 relative_displacement(const Bond& bond, int point, const Eigen::VectorXd& q) {
    return displacement_at(q, bond.block_b, bond.xi_b[point]) - displacement_at(q, bond.block_a, bond.xi_a[point]);
}

/// The traction at a point of a bond at q.
[[nodiscard]] inline PointTraction bond_traction(const InterfaceLaw& law, const Bond& bond, int point,
                                                 const Eigen::VectorXd& q) {
    const Vec2 relative = relative_displacement(bond, point, q);
    return bond_traction(law, bond.shear_start[point], bond.normal().dot(relative),
                         bond.tangent.dot(relative) - bond.slip_start[point]);
}

/// Shear traction at position s in [0, 1] along a bond, linear through its two Gauss points (Pa).
[[nodiscard]] double bond_shear_at(const double* shear, double s);

} // namespace kluft

// The points of bonded interfaces: their pairing never changes, so they need no detection.
#pragma once

#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/contact/contact.hpp"

namespace kluft {

inline constexpr int n_bond_points = 2; ///< Gauss points per bonded edge

/// Appends the two Gauss points of interface `i`, in the frame of the mean direction of its two edges at q.
/// `shear` holds the shear traction of the two points where slip = 0 (Pa).
void append_bond_points(const BlockSystem& system, int i, const Eigen::VectorXd& q, const double* shear,
                        std::vector<ContactPoint>& points);

/// Shear traction at position s in [0, 1] along a bond, linear through its two Gauss points (Pa).
[[nodiscard]] double bond_shear_at(const double* shear, double s);

} // namespace kluft

// The points of an overlap of two edges: Gauss-Lobatto's rules, and how many points the edges of an interface need.
#pragma once

#include <span>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/interface_law.hpp"

namespace kluft {

inline constexpr int least_overlap_points = 3; ///< exact for a traction that varies linearly
inline constexpr int most_overlap_points = 15;

/// A rule on [0, 1] with a point at either end; the weights add up to 1 (docs/theory.md 18).
struct OverlapRule {
    std::span<const double> positions; ///< ascending, from 0 to 1
    std::span<const double> weights;
};

/// Gauss-Lobatto's rule of so many points, 3 to 15.
[[nodiscard]] OverlapRule overlap_rule(int n_points);

/// Per interface the number of points of an overlap along it: what its law says, or else three without cohesion, which are a hinge in the corner. How long the part of a joint
/// is that is closed, and has cohesion, takes more: so many that the weight of an end point is at most 0.5 % of the joint's
/// length. Cells of a net have three. `laws`: of the fractures, by interface.
[[nodiscard]] std::vector<int> overlap_points(const BlockSystem& system, const std::vector<const InterfaceLaw*>& laws);

/// The same of an overlap that is no part of a longer joint.
[[nodiscard]] int overlap_points_alone(const InterfaceLaw& law);

} // namespace kluft

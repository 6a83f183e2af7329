// Points of interfaces that slide or open since the stiffness was factorized, chosen the same way in every run.
#pragma once

#include <span>
#include <vector>

#include "body.hpp"
#include "kluft/assembly/linear_solver.hpp"

namespace kluft::bench {

/// Where the interfaces lie.
enum class Placement {
    spread, ///< evenly over the body
    line    ///< along a fracture that grows from the middle of the body
};

/// What becomes of the tangent of a sliding point.
enum class Sliding {
    frictionless, ///< it loses its shear stiffness: symmetric
    frictional    ///< and its shear traction follows its pressure: the exact tangent
};

/// Both points of `n` bonded interfaces each: three of four interfaces slide, the fourth opens and loses all stiffness.
[[nodiscard]] std::vector<StiffnessChange> changed_interfaces(const Body& body, Placement placement, int n,
                                                              Sliding sliding);

/// Adds the changes to a stiffness.
void add_changes(std::span<const StiffnessChange> changes, BlockMatrix& matrix);

} // namespace kluft::bench

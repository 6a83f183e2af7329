// What loads and prescribed displacements on the outline do to the tangent.
#pragma once

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/loading/boundary_loads.hpp"

namespace kluft {

/// Adds minus the derivative of pressure_force at q to the block's diagonal entry.
void add_pressure_tangent(const PressureEdge& edge, double pressure, const Eigen::VectorXd& q, Mat6& diagonal);

/// K := P K P + scale (1 - P).
void project(const Constraints& constraints, BlockMatrix& matrix, double scale);

} // namespace kluft

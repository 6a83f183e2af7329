// What is left over on the blocks of a body in the unknowns that it is solved for (docs/theory.md, "Balance").
#pragma once

#include <Eigen/Core>

#include "kluft/equilibrium/coordinates.hpp"
#include "kluft/loading/block_balance.hpp"

namespace kluft {

/// The rigid part of `forces` on the unknowns of block `b` at q: force, and moment about the centroid over sqrt(area)
/// (N/m).
[[nodiscard]] Vec3 rigid_part(const Coordinates& coordinates, const BlockSystem& system, const Eigen::VectorXd& q,
                              const Eigen::VectorXd& forces, int b);

/// Of affine or rigid blocks at q.
[[nodiscard]] BlockBalance block_balance(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft

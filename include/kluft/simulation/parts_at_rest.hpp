// The parts of a body that stand without sliding, and are held.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// Per block 1 where it belongs to a part in which no contact slides at the displacements q but those without friction and cohesion, and which
/// its supports or fixed blocks hold. A part are blocks that bonds and closed contacts join, without fixed blocks, which are of none.
[[nodiscard]] std::vector<char> parts_at_rest(const EquilibriumProblem& problem, const Eigen::VectorXd& q);

} // namespace kluft

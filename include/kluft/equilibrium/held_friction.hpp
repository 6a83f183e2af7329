// An equilibrium under given loads by way of others whose friction limits are held (docs/theory.md, eq. 29d).
#pragma once

#include <Eigen/Core>

#include "kluft/equilibrium/open_close_solver.hpp"

namespace kluft {

/// Solves the problem with the shear traction of each contact point limited by a constant, and again with the limits of what was
/// found, until they stay: then q is as good as an equilibrium, from which `solver.solve` finds it. `unloaded`: contacts carry no
/// force yet, and the first limits are those of points that do not slide at all; else they are those at q. Where a solution is not
/// found q stays as it was. Returns the linear solves.
int approach_with_held_friction(OpenCloseSolver& solver, const EquilibriumProblem& problem, const BlockPattern& pattern,
                                bool unloaded, Eigen::VectorXd& q);

} // namespace kluft

// How far an increment of Newton's method takes blocks, against how far its linear equations reach (docs/theory.md, (28a)).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/equilibrium/coordinates.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// Per block the largest of its distortion and of its motion relative to each block that it is bonded to or touches, over
/// `share` of the motion_scale, and of its motion over that share of the body's extent; more than 1 is too far. Of blocks that
/// no chain of points leads from to a prescribed motion or a platen, the motion itself, over `share` of the motion_scale.
/// Empty where no block moves so far by itself.
[[nodiscard]] std::vector<double> motions_over_limit(const EquilibriumProblem& problem, const Coordinates& coordinates,
                                                     const Eigen::VectorXd& q, const Eigen::VectorXd& increment,
                                                     double share);

} // namespace kluft

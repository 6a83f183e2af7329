// Numbers that are none: which of a solve, and where.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// What is no finite number, in words with its place.
struct NumberFlaw {
    std::string what;
    int block = 0; ///< or the first of the two that meet there
};

/// Where the forces at q stop to be numbers: in the displacement of a block, in the traction of a contact or a bond, or
/// in the forces on a block. To be asked where a norm of the forces is not finite. `forces`: on the unknowns.
[[nodiscard]] NumberFlaw flaw_of_forces(const EquilibriumProblem& problem, const Eigen::VectorXd& q,
                                        const Eigen::VectorXd& forces);

/// The first block whose increment is not finite. To be asked where the increment is not.
[[nodiscard]] NumberFlaw flaw_of_increment(const EquilibriumProblem& problem, const Eigen::VectorXd& increment);

} // namespace kluft

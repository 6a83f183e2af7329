// An iterate of the open-close iteration, and the equations that it is judged by.
#pragma once

#include <Eigen/Core>

#include "kluft/equilibrium/border.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// The equations of one solve.
struct Equations {
    Equations(const EquilibriumProblem& to_solve, const BlockPattern& pattern)
        : problem(to_solve), evaluator(problem, pattern), border(border_of_platen(problem, evaluator.coordinates())) {}

    const EquilibriumProblem& problem;
    EquilibriumEvaluator evaluator;
    Border border;
};

/// The forces at an iterate.
struct Iterate {
    Residual residual;           ///< on the unknowns
    Eigen::VectorXd free_forces; ///< the residual without reactions
    double norm = 0.0;           ///< of the free forces (N/m)
    Eigen::VectorXd prescribed;  ///< change of the unknowns that prescribed displacements ask for
    bool held = false;           ///< they hold up to round-off, and `prescribed` is zero
};

/// Evaluates the residual at q; the time that takes is added to `seconds`.
void evaluate(Equations& equations, const Eigen::VectorXd& q, double& seconds, Residual& residual);
/// Evaluates all of an iterate.
void evaluate(Equations& equations, const Eigen::VectorXd& q, double& seconds, Iterate& at);

} // namespace kluft

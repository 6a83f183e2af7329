// An equilibrium under given loads by way of others whose friction limits are held (docs/theory.md, eq. 29d).
#pragma once

#include <Eigen/Core>

#include "kluft/equilibrium/open_close_solver.hpp"

namespace kluft {

struct HeldFrictionGoal {
    bool unloaded = true;         ///< no contact carries a force at q yet: at first no point slides
    double tolerance_share = 1.0; ///< of the solver's tolerance, once the limits change little
};

struct HeldFrictionApproach {
    int n_solves = 0;      ///< linear
    bool is_moved = false; ///< q is one of the solutions; else it stayed as it was
};

/// Solves the problem with no point sliding, or with the limits of q, then with the shear traction of each point limited by what Coulomb's
/// limit is in the solution before, until these limits stay, the mass-like term each time from the solution before. From the last
/// solution, q, `solver.solve` finds the equilibrium. Where one is not found q is the last that was.
HeldFrictionApproach approach_with_held_friction(OpenCloseSolver& solver, const EquilibriumProblem& problem,
                                                 const BlockPattern& pattern, const HeldFrictionGoal& goal,
                                                 Eigen::VectorXd& q);

} // namespace kluft

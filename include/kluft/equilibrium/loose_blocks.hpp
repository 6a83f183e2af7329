// Loose blocks, which carry nothing: whether friction could make them carry, and where they go (docs/theory.md, (29f) to (29h)).
#pragma once

#include <Eigen/Core>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// Blocks that have been moved apart.
struct PartedBlocks {
    Eigen::VectorXd displacement; ///< size 6 n_blocks (m); empty where friction could hold them, or nothing was found
    int iterations = 0;           ///< linear systems, each solved for two to six right sides
};

/// Moves affine blocks from the problem's start out of the way of its platens, as slowly as its mass-like term, which must not be
/// empty, lets them, and with the friction that their contacts have meanwhile. Contacts and the points of platens that are not glued
/// may open and are not to overlap. Nothing is found where no platen has moved into the body, and where some motion that friction
/// cannot resist would not let the platens follow. The linear solver must have analysed `pattern`, and has another factor afterwards.
[[nodiscard]] PartedBlocks part_blocks(LinearSolver& linear_solver, const EquilibriumProblem& problem,
                                       const BlockPattern& pattern);

} // namespace kluft

// Loose blocks, which carry nothing: whether friction could make them carry, and where they are apart (docs/theory.md, (29f) to
// (29h)).
#pragma once

#include <Eigen/Core>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// What blocks that are moved apart may do on the way.
enum class Passage {
    sliding, ///< whatever leaves no overlap at the end (29f)
    opening ///< only what opens each contact by at least its slip times the steepest shear traction that it can have (29h)
};

/// Blocks that have been moved apart.
struct PartedBlocks {
    Eigen::VectorXd displacement; ///< size 6 n_blocks (m); empty where the platens press on them all the same
    int iterations = 0;           ///< linear systems, each solved for two right sides
};

/// Moves affine blocks from the problem's start to where its supports and platens ask for, as little as need be in the sense of its
/// mass-like term, which must not be empty, and of the elastic energy. Contacts and the points of platens that are not glued may open
/// and are not to overlap; friction does not act. Not found where the platens press with more than a tenth of what counts as
/// nothing (27c). The linear solver must have analysed `pattern`, and has another factor afterwards.
[[nodiscard]] PartedBlocks part_blocks(LinearSolver& linear_solver, const EquilibriumProblem& problem,
                                       const BlockPattern& pattern, Passage passage);

} // namespace kluft

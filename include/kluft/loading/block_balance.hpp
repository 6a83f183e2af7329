// How far each block, and each group of blocks that hold together, is from equilibrium by its own forces
// (docs/theory.md, "Balance").
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/moving_block.hpp"
#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// The forces that what is left over on a block is judged against, one per block (N/m).
struct OwnForces {
    /// Sum of the magnitudes of its loads, but at most three times what acts between it and any other block that it presses
    /// on, or what acts on that one if this is more; of a block without loads, of its contact forces.
    std::vector<double> own;
    std::vector<double>
        around; ///< of a block without loads the largest `own` of the blocks that it meets; else its own
    std::vector<double> roundoff; ///< what round-off of the displacements makes of its forces
    std::vector<char> loaded;     ///< whether weight, pressure or a point force acts on it
    /// Whether the supports and platens of a body that nothing else loads carry no more than what counts as nothing beside what
    /// the body has carried (27c). Blocks may be jammed in one another then, but nothing presses on them.
    bool has_shed_its_load = false;
    /// Blocks of pieces that carry nothing: all of such a body, else those that what carries touches with next to nothing (27c).
    std::vector<char> idle;
    std::vector<double> of_contacts; ///< sum of the magnitudes of the contact forces of each block
};
[[nodiscard]] OwnForces own_forces(const LoadedBody& body, const Eigen::VectorXd& q);

/// The rigid part of `forces` on the six unknowns of the affine block `b` at q: force, and moment about the centroid over
/// sqrt(area) (N/m).
[[nodiscard]] Vec3 affine_rigid_part(const BlockSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& forces,
                                     int b);
/// The larger of force and moment over sqrt(area) (N/m).
[[nodiscard]] inline double size_of(const Vec3& rigid_part) {
    return std::max(rigid_part.head<2>().norm(), std::abs(rigid_part[2]));
}

/// A translation of the whole body that neither a support nor a platen resists, and the loads along it.
struct FreeTranslation {
    Vec2 direction = Vec2::Zero(); ///< unit vector
    double loads = 0.0;            ///< sum of the magnitudes of their components (N/m)
};

/// What is left over on the blocks of a body.
struct BlockBalance {
    OwnForces forces;
    std::vector<Vec3> left;            ///< external - internal, in the free motions: force, and moment over sqrt(area)
    std::vector<Vec2> position;        ///< of the centroid (m)
    std::vector<double> area;          ///< m2
    std::vector<char> held;            ///< whether its supports hold the block against every rigid motion
    std::vector<FreeTranslation> free; ///< orthogonal
    std::vector<std::vector<int>> groups; ///< blocks held together by bonds and locked contact points; two or more each
};
/// By what is `left` over.
[[nodiscard]] BlockBalance block_balance(const LoadedBody& body, const Eigen::VectorXd& q, std::vector<Vec3> left);
/// Of affine blocks.
[[nodiscard]] BlockBalance affine_block_balance(const LoadedBody& body, const Eigen::VectorXd& q);

/// What is asked of the blocks of a body that stands.
struct BlockGoal {
    double share = 1e-3; ///< largest left-over over own force
};

/// The verdict on the blocks of a body.
struct BlockVerdict {
    double error = 0.0; ///< the largest share of a block or group (docs/theory.md, (27))
    /// Blocks that are not balanced and the blocks of groups that are not, the worst first; those that supports hold only where
    /// there are no others.
    std::vector<MovingBlock> moving;
    bool falls = true; ///< what is left over on all of these has fallen since the solve before
    [[nodiscard]] bool balanced() const { return moving.empty(); }
};
/// Judges blocks and groups by what is left over now and what was `before`, in the solve that this one started from; null
/// without one. One without loads on which less is left over than before comes to rest: it only must not disturb the
/// blocks around it. Nor must it fall where that disturbance is a tenth of what is allowed.
/// What drives the whole body along a free translation is judged by the loads along that (27d).
[[nodiscard]] BlockVerdict judge_blocks(const BlockBalance& now, const BlockBalance* before, const BlockGoal& goal);

} // namespace kluft

// Joints that are open over a part of their length, and so soft that this decides when a block turns over.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// A joint along which two blocks touch at one end and have parted at the other one.
struct RockingJoint {
    double shortfall =
        0.0; ///< of the overturning moment of a joint of this stiffness beside that of a hinge in its corner; 0: none is open
    int block_a = -1;
    int block_b = -1;
    int law = -1;
    Vec2 place = Vec2::Zero(); ///< in the moved body, scene coordinates (m)
};

/// The joint of a committed state whose three points, a hinge in the corner, carry most beside what its stiffness would let it carry (18a).
/// The moment of the weight is that of a load in the centroid of the block that is farther from the joint. None in a body with a net, and in a
/// stage whose platen moves.
[[nodiscard]] RockingJoint softest_rocking_joint(const Model& model, const State& state);

/// What is to be said of one with a shortfall of more than a tenth; "" where there is none.
[[nodiscard]] std::string rocking_joint_warning(const Model& model, const State& state);

} // namespace kluft

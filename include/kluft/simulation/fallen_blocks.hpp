// Blocks that have given way under given loads and came to rest in another place.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// In words what has fallen between the displacements `before` (six per block, m) and those of the state, in a body that has jumped: the
/// block that has turned most, by more than 5 degrees, or moved most, by more than a quarter of the smaller one's motion_scale, beside
/// one that it shares an interface with in the body as cut, or in space where it shares none. "block 5 at (1, 2) has turned by 41
/// degrees and moved by 0.2 m beside block 3"; "" where none has, or the body has not jumped.
[[nodiscard]] std::string description_of_fall(const Model& model, const Eigen::VectorXd& before, const State& state);

/// In words the block that has moved farthest beside its size since `before`, in a body that has jumped by less than a fall: "block 5 has moved by 0.03 m
/// in all"; "" where none has moved by more than jump_motion, the body has not jumped, or has fallen.
[[nodiscard]] std::string description_of_small_jump(const Model& model, const Eigen::VectorXd& before,
                                                    const State& state);

} // namespace kluft

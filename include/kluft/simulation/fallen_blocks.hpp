// Blocks that have given way under given loads and came to rest in another place.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// In words what has fallen between the displacements `before` and those of the state, a body that has jumped: blocks that have turned by
/// more than 5 degrees or moved by more than a quarter of their size, and of these the one that has turned or moved most; "" where none
/// has, or the body has not jumped. "block 5 at (1, 2) has turned by 41 degrees and moved by 0.2 m".
[[nodiscard]] std::string description_of_fall(const Model& model, const Eigen::VectorXd& before, const State& state);

} // namespace kluft

// Blocks whose prescribed displacements leave them no strain, so that no stress arises in them.
#pragma once

#include <string>
#include <vector>

#include "kluft/simulation/model.hpp"

namespace kluft {

/// Affine blocks that supports and platens prevent from deforming at all in one of the stages, in ascending order, as those whose held
/// corners do not lie in one line; fixed blocks are none of them.
[[nodiscard]] std::vector<int> undeformable_blocks(const Model& model);

/// What is to be said of them where they make up more than 1 % of the area of the blocks that are not fixed; else "".
[[nodiscard]] std::string undeformable_blocks_warning(const Model& model);

} // namespace kluft

// Point forces on blocks that cannot move or deform.
#pragma once

#include <string>
#include <vector>

#include "kluft/simulation/model.hpp"

namespace kluft {

/// Of each point force on a block that is fixed, or whose vertices supports hold in every direction, that it has no effect; the
/// message begins with the key of the force in the first stage where this is so. Not of blocks that a platen moves.
[[nodiscard]] std::vector<std::string> idle_force_warnings(const Model& model);

} // namespace kluft

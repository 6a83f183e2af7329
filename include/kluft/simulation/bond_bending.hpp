// Bending that a bond between two given blocks carries, and that no criterion of failure sees.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// What is to be said of the bond between given blocks with the largest tension at one of its ends, where that is more than
/// twice its tensile strength; "" where there is none. Criteria judge mean stresses or tractions (docs/theory.md, section 6), in a
/// net those of the several bonds that a crack would have to cut.
[[nodiscard]] std::string bond_bending_warning(const Model& model, const State& state);

} // namespace kluft

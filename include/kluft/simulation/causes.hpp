// What may be wrong with a scene whose body finds no equilibrium: loads that nothing holds, a modulus without its unit.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/moving_block.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

/// In words, the likeliest first: that the loads push or turn the body as a whole in a way that neither a support nor a platen
/// holds, with the pressures; that nothing holds a body of which all blocks move (`moving`); that the loads are stresses of
/// more than a twentieth of the modulus. Empty where nothing is found.
[[nodiscard]] std::vector<std::string> likely_causes(const Model& model, const LoadsAt& at,
                                                     const std::vector<MovingBlock>& moving);

/// What is to be said of the first stage in which the body has neither a support, a fixed block nor a platen, and its loads do not
/// balance: it cannot find an equilibrium. The message begins with the key of the stage. "" where there is none; what platens leave
/// behind is not known before, so that stages after one with a platen are not judged.
[[nodiscard]] std::string unheld_body_warning(const Model& model);

} // namespace kluft

// Corners that hold blocks which have slid against them, in a body with reduced strengths.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// What is to be said of the contact, short beside its blocks, that carries the largest force (N/m) of those with more than a
/// twentieth of what acts on one of their blocks; "" where there is none. What acts on a block: its weight, or the sum of the
/// magnitudes of its contact forces where that is more.
[[nodiscard]] std::string corner_contact_warning(const Model& model, const State& state);

} // namespace kluft

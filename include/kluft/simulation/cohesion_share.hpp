// What part of its cohesion a joint has that is hardly pressed.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// What is to be said of a committed state where less than nine tenths of the cohesion of a law count on the closed points that follow it, since their
/// pressure is below the law's cohesion_onset (15); of the law that misses most. "" otherwise.
[[nodiscard]] std::string cohesion_share_warning(const Model& model, const State& state);

} // namespace kluft

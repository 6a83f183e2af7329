// Whether a body would leave an equilibrium for good if anything pushed it.
#pragma once

#include <string>

#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// Whether the committed state of a body under given loads is an equilibrium that an over-damped motion (29a) leaves: the determinant of its
/// tangent, with a mass-like term of 1e-6 E/H^2, is negative. Two ways to leave it, or four, are not seen. False for a state in a stage
/// whose platen moves, and for bodies of more than 3 000 unknowns. Throws ResourceError out of memory.
[[nodiscard]] bool is_unstable(const Model& model, const State& state);

/// What is to be said of such a state; "" of another one.
[[nodiscard]] std::string unstable_equilibrium_warning(const Model& model, const State& state);

} // namespace kluft

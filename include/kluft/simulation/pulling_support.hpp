// Supports that hold a block back in tension, as nothing behind an open joint would.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// A boundary with a smooth or pinned support that pulls a block outward.
struct PullingSupport {
    int boundary = -1;
    int block = -1;
    double force = 0.0; ///< normal to the boundary, of all held vertices of the block (N/m); 0: none pulls
    double share = 0.0; ///< of the sum of the magnitudes of all weights, pressures and forces on the body
};

/// The largest pull of a committed state. None where a platen moves in any stage: a test may pull its specimen.
[[nodiscard]] PullingSupport strongest_pulling_support(const Model& model, const State& state);

/// What is to be said of one that pulls with more than a hundredth of the loads; "" where there is none.
[[nodiscard]] std::string pulling_support_warning(const Model& model, const State& state);

} // namespace kluft

// Supports that hold a block back in tension, as nothing behind an open joint would.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// A boundary whose support pulls a piece of the body, a block and those that bonds hold to it, outward.
struct PullingSupport {
    int boundary = -1;  ///< -1: none pulls
    int block = -1;     ///< of the piece the one that is pulled most
    int n_blocks = 0;   ///< of the piece
    double force = 0.0; ///< normal to the sides of the piece on the boundary, of all its held vertices (N/m)
};

/// The largest pull of a committed state that the joints around the piece could not take over: it is more than what their
/// points in contact still lack of Coulomb's limit, by a twentieth of the loads or the contact forces on the piece. None on a
/// piece without a joint, or that is fixed elsewhere, too, and none where a platen moves in any stage: a test may pull its
/// specimen.
[[nodiscard]] PullingSupport strongest_pulling_support(const Model& model, const State& state);

/// What is to be said of one; "" where there is none.
[[nodiscard]] std::string pulling_support_warning(const Model& model, const State& state);

} // namespace kluft

// Supports that hold a block back in tension, as nothing behind an open joint would.
#pragma once

#include <string>

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

/// A boundary whose support keeps a part of the body from turning over: blocks that bonds and contacts hold together, and that
/// nothing else holds. A support that only presses would bear them where its resultant lies between its points.
struct TurningPart {
    int boundary = -1;   ///< -1: none holds one
    int block = -1;      ///< where the support pulls most
    int n_blocks = 0;    ///< of the part
    double beyond = 0.0; ///< how far the resultant of the support lies beyond its last point (m)
    double force =
        0.0; ///< with which the support pulls at one end, if the rest of it pressed at the other one alone (N/m)
};

/// The one of a committed state with the largest force, from a hundredth of the loads on the part on. Only of straight supports and
/// of parts with a joint; none where a platen moves in any stage.
[[nodiscard]] TurningPart strongest_turning_part(const Model& model, const State& state);

/// What is to be said of either; "" where there is none.
[[nodiscard]] std::string pulling_support_warning(const Model& model, const State& state);

} // namespace kluft

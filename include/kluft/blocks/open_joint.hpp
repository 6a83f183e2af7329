// Open joints between given blocks: sides that face another block across a gap too narrow to be an outside of the body.
#pragma once

#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// A side of a given block, which lies to its left.
struct SideOfBlock {
    Vec2 start = Vec2::Zero(); ///< m
    Vec2 end = Vec2::Zero();   ///< m
    int block = 0;
};

/// A part of a side that has another block straight before it.
struct CoveredPart {
    double from = 0.0; ///< along the side (m)
    double to = 0.0;   ///< m
    int other = -1;    ///< that block; of several the one across the widest gap
    double gap = 0.0; ///< the largest distance from it, along the outward normal (m); at most the tolerance: they touch
    double strips =
        0.0; ///< length of those that nothing covers, at an end of the side or between two blocks, in it (m)
};

/// The parts of side `s` that a side of another block faces, turned by at most 15 degrees, within a twentieth of the smaller
/// block's size, its square root of area; `sizes` (m) by block. Strips beside one that touches, of at most a hundredth of that size,
/// are part of it, as of corners that do not match; parts as short as that are none. One across a gap reaches farther by a twentieth
/// of that size, so that it does not end before a corner, which would catch there. In order along the side. `near`: the sides among which
/// the others are looked for.
[[nodiscard]] std::vector<CoveredPart> covered_parts(const std::vector<SideOfBlock>& sides, int s,
                                                     const std::vector<int>& near, const std::vector<double>& sizes,
                                                     double tolerance);

/// How far before a side of a block of this size others are looked for at most (m).
[[nodiscard]] double reach_of_open_joints(double size);

} // namespace kluft

// Blocks that are narrow somewhere between two large parts.
#pragma once

#include <vector>

#include "kluft/blocks/block_system.hpp"

namespace kluft {

/// Where a block is narrower than a hundredth of the size (square root of the area) of either part beside it: what a trace leaves
/// that passes a corner of the body closely. A block does not break there, however little it is.
struct NarrowNeck {
    int block = 0;
    double width = 0.0;        ///< m
    double smaller_part = 0.0; ///< m2
    Vec2 at = Vec2::Zero();    ///< the corner beside it, local coordinates (m)
};

/// Of blocks that are not fixed, the narrowest of each beside its smaller part; in the order of the blocks. Between two
/// corners or a corner and a side of one outline: a ring is not looked at.
[[nodiscard]] std::vector<NarrowNeck> narrow_necks(const BlockSystem& system);

} // namespace kluft

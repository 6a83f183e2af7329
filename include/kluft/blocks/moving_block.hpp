// A block that is not balanced, and where to it moves.
#pragma once

#include "kluft/core/vector.hpp"

namespace kluft {

struct MovingBlock {
    int block = -1;
    Vec2 direction = Vec2::Zero(); ///< that what is left over pushes it in, of length 1; zero where it only turns
    int turn = 0;                  ///< 1 where it also turns it counter-clockwise, -1 clockwise

    bool operator==(const MovingBlock&) const = default;
};

} // namespace kluft

// A point that moves with a block.
#pragma once

#include <string>

#include "kluft/blocks/block_system.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

struct MaterialPoint {
    int block = 0;
    Vec2 xi = Vec2::Zero(); ///< block coordinates
};

/// The point (scene coordinates, m, before loading) of the block that is called so; without a name of the block that has
/// it in it. Throws InputError, which begins with `what`, where there is none.
[[nodiscard]] MaterialPoint material_point(const BlockSystem& system, const std::string& block, const Vec2& point,
                                           const std::string& what);

} // namespace kluft

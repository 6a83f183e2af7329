// Pairs of boxes that meet, by a uniform grid.
#pragma once

#include <utility>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// The box around the surfaces of a block that can touch others (m).
struct BlockBox {
    int block = 0;
    Vec2 lower = Vec2::Zero();
    Vec2 upper = Vec2::Zero();
};

/// Pairs (i < j) of blocks whose boxes meet when each is grown by `reach` (m) on all sides; sorted, each once.
[[nodiscard]] std::vector<std::pair<int, int>> meeting_boxes(const std::vector<BlockBox>& boxes, double reach);

} // namespace kluft

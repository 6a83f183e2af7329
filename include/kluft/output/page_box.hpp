// Where text can stand on a page without covering curves or other text.
#pragma once

#include <cstddef>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// A rectangle of the page, points.
struct PageBox {
    Vec2 low = Vec2::Zero(); ///< upper left
    Vec2 high = Vec2::Zero();
};

/// Whether a line between two places comes into the box.
[[nodiscard]] bool enters(const PageBox& box, const Vec2& from, const Vec2& to);

/// What keeps text from being read: lines through several places, and other text.
struct Obstacles {
    std::vector<std::vector<Vec2>> lines;
    std::vector<PageBox> boxes;

    /// Stretches of lines that come into the box; each overlapping text counts as many.
    [[nodiscard]] std::size_t met_by(const PageBox& box) const;
};

} // namespace kluft

// Legends of plots: samples with their labels in columns below a plot.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "kluft/output/canvas.hpp"

namespace kluft {

struct LegendEntry {
    std::string label;
    std::function<void(Canvas&, const Vec2& middle)> draw_sample; ///< 20 points wide
};

[[nodiscard]] LegendEntry line_entry(std::string label, const Stroke& stroke);

inline constexpr double legend_line = 14.0; ///< height of an entry, points
inline const TextStyle legend_style{.size = 8.5, .down = Align::middle};

/// Entries in as many columns as fit beside each other, filled column by column.
class LegendGrid {
public:
    LegendGrid() = default;
    /// `width`: that of all columns together, points.
    LegendGrid(std::vector<LegendEntry> entries, double width);

    /// 0 without entries; otherwise with some room below.
    [[nodiscard]] double height() const;
    void draw(Canvas& canvas, const Vec2& corner) const;

private:
    std::vector<LegendEntry> entries_;
    double width_ = 0.0;
    std::size_t n_columns_ = 1;
    std::size_t n_rows_ = 0;
};

} // namespace kluft

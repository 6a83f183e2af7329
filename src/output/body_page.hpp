// The page of a picture of the body: title, panels beside each other, and a column with the legend to their right.
#pragma once

#include <string>
#include <vector>

#include "body_drawing.hpp"
#include "kluft/output/canvas.hpp"
#include "legend.hpp"

namespace kluft {

/// Places on the page of `n_panels` equal panels beside each other with a column to their right.
struct PageLayout {
    double scale = 1.0; ///< points per metre
    Vec2 panel_size = Vec2::Zero();
    double slot = 0.0; ///< width reserved for a panel
    int n_panels = 1;
    Vec2 page = Vec2::Zero();

    [[nodiscard]] Vec2 corner(int panel) const;
    [[nodiscard]] Vec2 column_corner() const;
};

/// Panels that show `box`, none wider or higher than `largest`, beside a column of the given height (points).
[[nodiscard]] PageLayout page_layout(const Box& box, int n_panels, double column_height, const Vec2& largest);

/// More pixels for more blocks, so that each gets a few.
[[nodiscard]] double body_pixels_per_point(const BlockSystem& system, double scale);

void draw_title(Canvas& canvas, const PageLayout& layout, const std::string& title);

/// The body with its heading; the first panel also has a scale bar.
void draw_panel(Canvas& canvas, const PageLayout& layout, int index, const Box& box, const DrawnBody& body,
                const std::string& heading);

/// Legend entries below each other; those without a sample are notes in small print.
void draw_column(Canvas& canvas, const Vec2& corner, const std::vector<LegendEntry>& entries);
[[nodiscard]] double column_height(const std::vector<LegendEntry>& entries);

/// Throws InputError for an SVG or PDF of more than most_blocks_in_svg blocks.
void refuse_large_svg(const BlockSystem& system, PictureFormat format);

} // namespace kluft

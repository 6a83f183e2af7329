// Axes of plots: round ticks and the map between values and places on the page.
#pragma once

#include <string>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/output/canvas.hpp"

namespace kluft {

/// A range of values with ticks at multiples of 1, 2 or 5 times a power of ten; on a logarithmic axis at the powers of
/// ten, or where there are few of them at 1, 2 and 5 times these.
struct Axis {
    double low = 0.0;
    double high = 1.0;
    double step = 0.2;
    bool logarithmic = false; ///< `step` is of no use then

    /// The values with a line, from low to high.
    [[nodiscard]] std::vector<double> ticks() const;
    /// A tick's value with as many decimals as it needs.
    [[nodiscard]] std::string label(double tick) const;
    /// Where a value lies: 0 at the low end, 1 at the high one.
    [[nodiscard]] double fraction(double value) const;
};

/// An axis that begins and ends at ticks, covers [low, high] and has about `n_ticks` of them. An empty or infinite
/// range is replaced by one of length 1.
[[nodiscard]] Axis round_axis(double low, double high, int n_ticks);
/// A logarithmic one that begins and ends at 1, 2 or 5 times a power of ten and covers [low, high], both above zero. Of
/// other ranges those of 0.1 to 1.
[[nodiscard]] Axis round_log_axis(double low, double high);

inline constexpr double plot_pixels_per_point = 3.2; ///< of plots that are written as PNG

/// Rectangle of a plot on the page with its two axes.
struct PlotFrame {
    Vec2 corner = Vec2::Zero(); ///< upper left, points
    Vec2 size = Vec2::Zero();   ///< points
    Axis x;
    Axis y;

    [[nodiscard]] Vec2 place(const Vec2& value) const;
};

/// Grid, frame, ticks with their values and the names of both axes.
void draw_axes(Canvas& canvas, const PlotFrame& frame, const std::string& x_name, const std::string& y_name);

} // namespace kluft

// Axes of plots: round ticks and the map between values and places on the page.
#pragma once

#include <string>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/output/canvas.hpp"

namespace kluft {

/// A range of values with ticks at multiples of 1, 2 or 5 times a power of ten.
struct Axis {
    double low = 0.0;
    double high = 1.0;
    double step = 0.2;

    /// The multiples of `step` from low to high.
    [[nodiscard]] std::vector<double> ticks() const;
    /// A tick's value with as many decimals as the step needs.
    [[nodiscard]] std::string label(double tick) const;
};

/// An axis that begins and ends at ticks, covers [low, high] and has about `n_ticks` of them. An empty or infinite
/// range is replaced by one of length 1.
[[nodiscard]] Axis round_axis(double low, double high, int n_ticks);

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

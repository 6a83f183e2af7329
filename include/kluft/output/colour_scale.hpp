// From a value to a colour, and the bar that explains it.
#pragma once

#include <string>
#include <vector>

#include "kluft/output/axis.hpp"
#include "kluft/output/canvas.hpp"

namespace kluft {

/// Colours from light to dark over the range of an axis; values outside take the end's colour. The lightness falls
/// evenly, so that the scale reads in grey and by colour-blind readers; red, blue, amber and black lines show on it.
class ColourScale {
public:
    explicit ColourScale(const Axis& axis) : ColourScale(axis, axis.low, axis.high) {}
    /// For values from `least` to `largest`, which may lie outside the axis.
    ColourScale(const Axis& axis, double least, double largest) : axis_(axis), least_(least), largest_(largest) {}

    [[nodiscard]] Colour operator()(double value) const;
    [[nodiscard]] const Axis& axis() const { return axis_; }
    [[nodiscard]] double least() const { return least_; }
    [[nodiscard]] double largest() const { return largest_; }

private:
    Axis axis_;
    double least_;
    double largest_;
};

/// A scale from zero (or a round number below the least value) to a round number above all but the largest hundredth
/// of the values, above all of a hundred or fewer. Values that are not finite numbers are left out.
[[nodiscard]] ColourScale scale_for(std::vector<double> values);

/// An upright bar with ticks to its right and its name beyond them. Values that lie outside the axis by more than a shade are told
/// above it and below.
void draw_colour_bar(Canvas& canvas, const ColourScale& scale, const Vec2& corner, const Vec2& size,
                     const std::string& name);

} // namespace kluft

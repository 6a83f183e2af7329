#include "kluft/output/colour_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace kluft {

namespace {

constexpr std::array stops{colour(0xFCFBF6), colour(0xE3E6DC), colour(0xC2CDC6), colour(0x98AFAD), colour(0x6C8B90)};

double mixed(double a, double b, double share) { return a + share * (b - a); }

} // namespace

Colour ColourScale::operator()(double value) const {
    double share = (value - axis_.low) / (axis_.high - axis_.low);
    if (!std::isfinite(share)) share = 0.0;
    const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const Colour& a = stops[below];
    const Colour& b = stops[below + 1];
    const double rest = place - static_cast<double>(below);
    return {mixed(a.red, b.red, rest), mixed(a.green, b.green, rest), mixed(a.blue, b.blue, rest), 1.0};
}

ColourScale scale_for(std::vector<double> values) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) return ColourScale(round_axis(0.0, 1.0, 5));
    const auto ranked = [&](std::size_t rank) {
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(values.begin(), at, values.end());
        return *at;
    };
    constexpr std::size_t whole = 100; // of which one at each end is left out: none of fewer values
    const std::size_t n_beyond = (values.size() - 1) / whole;
    const double low = std::min(0.0, ranked(n_beyond));
    const double high = std::max(0.0, ranked(values.size() - 1 - n_beyond));
    const auto [least, largest] = std::ranges::minmax(values);
    return {round_axis(low, high, 5), least, largest};
}

void draw_colour_bar(Canvas& canvas, const ColourScale& scale, const Vec2& corner, const Vec2& size,
                     const std::string& name) {
    constexpr int n_bands = 128;
    const Axis& axis = scale.axis();
    const double band = size.y() / n_bands;
    for (int i = 0; i < n_bands; ++i) {
        const double value = std::lerp(axis.high, axis.low, (i + 0.5) / n_bands);
        const double height = i + 1 < n_bands ? 1.5 * band : band; // overlap hides the seams
        canvas.fill_rectangle({corner.x(), corner.y() + i * band}, {size.x(), height}, scale(value));
    }
    const Stroke border{colour(0x333333), 0.6};
    const TextStyle numbers{.size = 8.0, .down = Align::middle};
    canvas.stroke_rectangle(corner, size, border);
    double widest = 0.0;
    const double right = corner.x() + size.x();
    for (const double tick : axis.ticks()) {
        const double y = corner.y() + size.y() * (axis.high - tick) / (axis.high - axis.low);
        canvas.line({right, y}, {right + 3.0, y}, border);
        canvas.text({right + 6.0, y}, axis.label(tick), numbers);
        widest = std::max(widest, canvas.text_width(axis.label(tick), numbers));
    }
    const double shade = (axis.high - axis.low) / n_bands; // what is beyond the axis by less looks like its end
    if (scale.largest() > axis.high + shade)
        canvas.text(corner - Vec2(0.0, 6.0), fmt::format("to {:.3g}", scale.largest()), {.size = 8.0});
    if (scale.least() < axis.low - shade)
        canvas.text(corner + Vec2(0.0, size.y() + 6.0), fmt::format("from {:.3g}", scale.least()),
                    {.size = 8.0, .down = Align::low});
    const TextStyle upward{.size = 8.5, .across = Align::middle, .down = Align::low, .angle = -0.5 * std::numbers::pi};
    canvas.text({right + 6.0 + widest + 7.0, corner.y() + 0.5 * size.y()}, name, upward);
}

} // namespace kluft

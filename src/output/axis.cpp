#include "kluft/output/axis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace kluft {

namespace {

/// The nearest of 1, 2, 5, 10 times a power of ten, by ratio.
double round_step(double rough) {
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    double best = power;
    for (const double factor : {2.0, 5.0, 10.0})
        if (std::abs(std::log(factor * power / rough)) < std::abs(std::log(best / rough))) best = factor * power;
    return best;
}

} // namespace

std::vector<double> Axis::ticks() const {
    std::vector<double> values;
    const double slack = 1e-6;
    for (double i = std::ceil(low / step - slack); i <= high / step + slack; i += 1.0) values.push_back(i * step);
    return values;
}

std::string Axis::label(double tick) const {
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    if (std::abs(tick) < 1e-9 * step) tick = 0.0;
    std::string text = fmt::format("{:.{}f}", tick, decimals);
    if (text.front() == '-') text.replace(0, 1, "\u2212");
    return text;
}

Axis round_axis(double low, double high, int n_ticks) {
    if (!std::isfinite(low)) low = 0.0;
    if (!std::isfinite(high)) high = low + 1.0;
    if (high - low <= 1e-12 * std::max(std::abs(low), std::abs(high)) || high <= low) high = low + 1.0;
    const double step = round_step((high - low) / std::max(1, n_ticks));
    const double slack = 1e-9;
    return {std::floor(low / step + slack) * step, std::ceil(high / step - slack) * step, step};
}

Vec2 PlotFrame::place(const Vec2& value) const {
    return {corner.x() + size.x() * (value.x() - x.low) / (x.high - x.low),
            corner.y() + size.y() * (y.high - value.y()) / (y.high - y.low)};
}

void draw_axes(Canvas& canvas, const PlotFrame& frame, const std::string& x_name, const std::string& y_name) {
    const Stroke grid{colour(0xE4E4E4), 0.6};
    const Stroke border{colour(0x333333), 0.8};
    const TextStyle numbers{.size = 8.5, .across = Align::middle, .down = Align::low};
    const TextStyle names{.size = 10.0, .across = Align::middle, .down = Align::low};
    const double bottom = frame.corner.y() + frame.size.y();
    const double left = frame.corner.x();
    double widest = 0.0;
    for (const double tick : frame.x.ticks()) {
        const double x = frame.place({tick, frame.y.low}).x();
        canvas.line({x, frame.corner.y()}, {x, bottom}, grid);
        canvas.line({x, bottom}, {x, bottom + 3.5}, border);
        canvas.text({x, bottom + 7.0}, frame.x.label(tick), numbers);
    }
    for (const double tick : frame.y.ticks()) {
        const double y = frame.place({frame.x.low, tick}).y();
        canvas.line({left, y}, {left + frame.size.x(), y}, grid);
        canvas.line({left - 3.5, y}, {left, y}, border);
        TextStyle style = numbers;
        style.across = Align::high;
        style.down = Align::middle;
        canvas.text({left - 6.5, y}, frame.y.label(tick), style);
        widest = std::max(widest, canvas.text_width(frame.y.label(tick), style));
    }
    canvas.stroke_rectangle(frame.corner, frame.size, border);
    canvas.text({left + 0.5 * frame.size.x(), bottom + 23.0}, x_name, names);
    TextStyle upward = names;
    upward.angle = -0.5 * std::numbers::pi;
    upward.down = Align::high;
    canvas.text({left - 6.5 - widest - 9.0, frame.corner.y() + 0.5 * frame.size.y()}, y_name, upward);
}

} // namespace kluft

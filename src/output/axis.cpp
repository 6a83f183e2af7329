#include "kluft/output/axis.hpp"

#include <algorithm>
#include <array>
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

constexpr std::array<double, 3> digits{1.0, 2.0, 5.0};
constexpr double log_slack = 1e-9;

/// 1, 2 and 5 times the powers of ten, or the powers only, from low to high.
std::vector<double> log_values(double low, double high, bool all) {
    std::vector<double> values;
    for (double power = std::floor(std::log10(low)); power <= std::log10(high) + log_slack; power += 1.0)
        for (const double digit : digits) {
            const double value = digit * std::pow(10.0, power);
            const bool inside = value >= low * (1.0 - log_slack) && value <= high * (1.0 + log_slack);
            if (inside && (all || digit == 1.0)) values.push_back(value);
        }
    return values;
}

std::string superscript(int exponent) {
    static const std::array<const char*, 10> figures{"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                                     "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
    std::string text = exponent < 0 ? "\u207b" : "";
    for (const char figure : fmt::format("{}", std::abs(exponent)))
        text += figures[static_cast<std::size_t>(figure - '0')];
    return text;
}

/// 0.002, 5000; beyond these as a digit times a power of ten.
std::string log_label(double tick) {
    if (tick >= 0.999e-3 && tick < 1e5) return fmt::format("{:.6g}", tick);
    const double exponent = std::floor(std::log10(tick) + log_slack);
    const double digit = std::round(tick / std::pow(10.0, exponent));
    return (digit == 1.0 ? "" : fmt::format("{:.0f}\u00b7", digit)) + "10" + superscript(static_cast<int>(exponent));
}

} // namespace

std::vector<double> Axis::ticks() const {
    if (logarithmic) {
        constexpr std::size_t few = 4;
        auto values = log_values(low, high, false);
        return values.size() < few ? log_values(low, high, true) : values;
    }
    std::vector<double> values;
    const double slack = 1e-6;
    for (double i = std::ceil(low / step - slack); i <= high / step + slack; i += 1.0) values.push_back(i * step);
    return values;
}

double Axis::fraction(double value) const {
    return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

std::string Axis::label(double tick) const {
    if (logarithmic) return log_label(tick);
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

Axis round_log_axis(double low, double high) {
    if (!std::isfinite(low) || !std::isfinite(high) || low <= 0.0 || high < low) return {0.1, 1.0, 0.1, true};
    const auto below = log_values(0.1 * low, low, true);
    const auto above = log_values(high, 10.0 * high, true);
    Axis axis{below.back(), above.front(), 0.1, true};
    if (axis.high <= axis.low) axis.high = above.at(1);
    return axis;
}

Vec2 PlotFrame::place(const Vec2& value) const {
    return {corner.x() + size.x() * x.fraction(value.x()), corner.y() + size.y() * (1.0 - y.fraction(value.y()))};
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

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kluft/core/units.hpp"
#include "kluft/output/axis.hpp"
#include "kluft/output/envelope.hpp"
#include "legend.hpp"

namespace kluft {

namespace {

constexpr double plot_width = 430.0; // points
constexpr double left_of_plot = 62.0;
constexpr double right_of_plot = 20.0;
constexpr double above_plot = 42.0;
constexpr double below_plot = 48.0;
const Stroke fit_stroke{colour(0x1A1A1A), 1.5};

/// Shear strength on a plane under the normal stress sigma (both in MPa).
double shear_strength(const Envelope& envelope, double sigma) {
    return envelope.cohesion / mega + sigma * std::tan(envelope.friction_angle);
}

/// Axes of equal scale around the circles and the lines.
PlotFrame frame_of(const std::vector<PeakPoint>& points, const Envelope& fit) {
    double low = 0.0;
    double high = 0.0;
    double top = 0.0;
    for (const PeakPoint& point : points) {
        low = std::min({low, point.sigma_3 / mega, point.sigma_1 / mega});
        high = std::max({high, point.sigma_3 / mega, point.sigma_1 / mega});
        top = std::max(top, 0.5 * std::abs(point.sigma_1 - point.sigma_3) / mega);
    }
    PlotFrame frame;
    frame.corner = {left_of_plot, above_plot};
    frame.x = round_axis(low, high, 8);
    top = std::max(1.15 * top, 0.9 * shear_strength(fit, 0.7 * high));
    const double tick = frame.x.step;
    const double ceiling =
        tick * std::clamp(std::ceil(top / tick), 1.0, std::ceil((frame.x.high - frame.x.low) / tick));
    frame.y = {0.0, ceiling, tick};
    frame.size = {plot_width, plot_width * frame.y.high / (frame.x.high - frame.x.low)};
    return frame;
}

Stroke circle_stroke(std::size_t index, bool peak_reached) {
    Stroke stroke{series_colour(index), 1.4};
    if (!peak_reached) stroke.dash = {4.0, 2.5};
    return stroke;
}

void draw_circle(Canvas& canvas, const PlotFrame& frame, const PeakPoint& point, const Stroke& stroke) {
    const double middle = 0.5 * (point.sigma_1 + point.sigma_3) / mega;
    const double radius = 0.5 * std::abs(point.sigma_1 - point.sigma_3) / mega;
    const double points_per_mega = frame.size.x() / (frame.x.high - frame.x.low);
    canvas.arc(frame.place({middle, 0.0}), radius * points_per_mega, std::numbers::pi, 2.0 * std::numbers::pi, stroke);
}

void draw_line(Canvas& canvas, const PlotFrame& frame, const Envelope& envelope, const Stroke& stroke) {
    // From where the strength vanishes, as far as the plot goes.
    const double tangent = std::tan(envelope.friction_angle);
    const double begin = tangent > 0.0 ? std::max(frame.x.low, -envelope.cohesion / mega / tangent) : frame.x.low;
    canvas.line(frame.place({begin, shear_strength(envelope, begin)}),
                frame.place({frame.x.high, shear_strength(envelope, frame.x.high)}), stroke);
}

std::string constants(const Envelope& envelope) {
    return fmt::format("c = {:.3f} MPa, \u03c6 = {:.1f}\u00b0", envelope.cohesion / mega,
                       envelope.friction_angle * degrees);
}

/// Dashed, dotted, dash-dotted: one kind after the other.
Stroke other_stroke(std::size_t index) {
    const std::array<std::vector<double>, 3> dashes{{{6.0, 3.0}, {1.5, 2.5}, {7.0, 2.5, 1.5, 2.5}}};
    return {colour(0x666666), 1.1, dashes[index % dashes.size()]};
}

/// One entry per circle, then the lines.
std::vector<LegendEntry> legend_of(const std::vector<PeakPoint>& points, const Envelope& fit,
                                   const std::vector<NamedEnvelope>& others) {
    std::vector<LegendEntry> entries{line_entry("fit: " + constants(fit), fit_stroke)};
    for (std::size_t i = 0; i < others.size(); ++i)
        entries.push_back(line_entry(others[i].label + ": " + constants(others[i].envelope), other_stroke(i)));
    for (std::size_t i = 0; i < points.size(); ++i)
        entries.push_back(line_entry(fmt::format("{}: \u03c3\u2083 = {:.2f}, \u03c3\u2081 = {:#.3g} MPa{}",
                                                 points[i].run, points[i].sigma_3 / mega, points[i].sigma_1 / mega,
                                                 points[i].peak_reached ? "" : ", " + points[i].remark),
                                     circle_stroke(i, points[i].peak_reached)));
    return entries;
}

} // namespace

std::string draw_envelope(const std::string& title, const std::vector<PeakPoint>& points, const Envelope& fit,
                          const std::vector<NamedEnvelope>& others, PictureFormat format) {
    const PlotFrame frame = frame_of(points, fit);
    const LegendGrid below(legend_of(points, fit, others), frame.size.x());
    const double bottom = frame.corner.y() + frame.size.y() + below_plot;
    const Vec2 page(frame.corner.x() + frame.size.x() + right_of_plot, bottom + below.height());
    return draw_picture(format, page.x(), page.y(), plot_pixels_per_point, [&](Canvas& canvas) {
        canvas.text_within(frame.size.x(), {frame.corner.x(), 26.0}, title, {.size = 11.5, .bold = true});
        draw_axes(canvas, frame, "normal stress (MPa, compression positive)", "shear stress (MPa)");
        canvas.begin_clip(frame.corner, frame.size);
        for (std::size_t i = 0; i < points.size(); ++i)
            draw_circle(canvas, frame, points[i], circle_stroke(i, points[i].peak_reached));
        for (std::size_t i = 0; i < others.size(); ++i) draw_line(canvas, frame, others[i].envelope, other_stroke(i));
        draw_line(canvas, frame, fit, fit_stroke);
        canvas.end_clip();
        below.draw(canvas, {frame.corner.x(), bottom});
    });
}

} // namespace kluft

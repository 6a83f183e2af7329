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
constexpr std::size_t most_named_circles = 12;
constexpr int n_curve_points = 200;
const Stroke fit_stroke{colour(0x1A1A1A), 1.5};
const Stroke cut_off_stroke{colour(0x1A1A1A), 1.8, {2.5, 1.2}};
const Stroke hoek_brown_stroke{colour(0x7B3294), 1.3};
const Stroke tension_stroke{colour(0x1A1A1A), 0.9};
const Colour confidence_colour = colour(0x1A1A1A, 0.13);

/// Shear strength on a plane under the normal stress sigma (both in MPa).
double shear_in_mega(const Envelope& envelope, double sigma) { return envelope.shear_strength(sigma * mega) / mega; }

/// Axes of equal scale around the circles and the lines.
PlotFrame frame_of(const std::vector<PeakPoint>& points, const StrengthFit& fit) {
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
    top = std::max(1.15 * top, 0.9 * shear_in_mega(fit.envelope, 0.7 * high));
    const double tick = frame.x.step;
    const double ceiling =
        tick * std::clamp(std::ceil(top / tick), 1.0, std::ceil((frame.x.high - frame.x.low) / tick));
    frame.y = {0.0, ceiling, tick};
    frame.size = {plot_width, plot_width * frame.y.high / (frame.x.high - frame.x.low)};
    return frame;
}

/// Of few tests each circle has its colour; of many the kind of test has one.
Stroke circle_stroke(const std::vector<PeakPoint>& points, std::size_t index) {
    const PeakUse use = use_of(points[index]);
    const bool named = points.size() <= most_named_circles;
    Stroke stroke{series_colour(named ? index : static_cast<std::size_t>(use)), named ? 1.4 : 0.7};
    if (use == PeakUse::tension && named) stroke.width = tension_stroke.width;
    if (use == PeakUse::bound) stroke.dash = {4.0, 2.5};
    return stroke;
}

/// From the top of a circle that may be larger, to the side on which it may grow (1: right, -1: left).
void draw_arrow(Canvas& canvas, const Vec2& from, double side, const Stroke& stroke) {
    const Stroke solid{stroke.colour, stroke.width};
    const Vec2 tip = from + Vec2(16.0 * side, 0.0);
    canvas.segments({{from, tip}, {tip + Vec2(-4.5 * side, -3.0), tip}, {tip + Vec2(-4.5 * side, 3.0), tip}}, solid);
}

void draw_circle(Canvas& canvas, const PlotFrame& frame, const PeakPoint& point, const Stroke& stroke) {
    constexpr double pi = std::numbers::pi;
    const double middle = 0.5 * (point.sigma_1 + point.sigma_3) / mega;
    const double points_per_mega = frame.size.x() / (frame.x.high - frame.x.low);
    const double radius = 0.5 * std::abs(point.sigma_1 - point.sigma_3) / mega * points_per_mega;
    const Vec2 centre = frame.place({middle, 0.0});
    if (use_of(point) != PeakUse::bound) {
        canvas.arc(centre, radius, pi, 2.0 * pi, stroke);
        return;
    }
    // Compression may yet raise sigma_1, pulling may lower sigma_3.
    const double side = point.sigma_3 < 0.0 ? -1.0 : 1.0;
    canvas.arc(centre, radius, side > 0.0 ? pi : 1.5 * pi, side > 0.0 ? 1.5 * pi : 2.0 * pi, stroke);
    draw_arrow(canvas, centre - Vec2(0.0, radius), side, stroke);
}

/// Where a line begins: at the cut-off, or where its strength vanishes.
double beginning(const PlotFrame& frame, const Envelope& envelope, const std::optional<Estimate>& tensile_strength) {
    const double tangent = std::tan(envelope.friction_angle);
    double begin = frame.x.low;
    if (tangent > 0.0) begin = std::max(begin, -envelope.cohesion / mega / tangent);
    return tensile_strength ? std::max(begin, -tensile_strength->value / mega) : begin;
}

void draw_line(Canvas& canvas, const PlotFrame& frame, const Envelope& envelope,
               const std::optional<Estimate>& tensile_strength, const Stroke& stroke) {
    const double begin = beginning(frame, envelope, tensile_strength);
    canvas.line(frame.place({begin, shear_in_mega(envelope, begin)}),
                frame.place({frame.x.high, shear_in_mega(envelope, frame.x.high)}), stroke);
}

void draw_cut_off(Canvas& canvas, const PlotFrame& frame, const StrengthFit& fit) {
    if (!fit.tensile_strength) return;
    const double sigma = -fit.tensile_strength->value / mega;
    const double shear = shear_in_mega(fit.envelope, sigma);
    // Beyond the apex of the line the cut-off stands apart from it.
    const double top = shear > 0.0 ? shear : 0.1 * frame.y.high;
    canvas.line(frame.place({sigma, 0.0}), frame.place({sigma, top}), cut_off_stroke);
}

void draw_confidence(Canvas& canvas, const PlotFrame& frame, const Envelope& envelope) {
    if (!envelope.covariance) return;
    std::vector<Vec2> upper;
    std::vector<Vec2> lower;
    for (int i = 0; i <= n_curve_points; ++i) {
        const double sigma = std::lerp(frame.x.low, frame.x.high, static_cast<double>(i) / n_curve_points);
        const double shear = shear_in_mega(envelope, sigma);
        const double half_width = envelope.confidence(sigma * mega).value_or(0.0) / mega;
        upper.push_back(frame.place({sigma, std::max(0.0, shear + half_width)}));
        lower.push_back(frame.place({sigma, std::max(0.0, shear - half_width)}));
    }
    upper.insert(upper.end(), lower.rbegin(), lower.rend());
    canvas.fill_polygon({upper}, confidence_colour);
}

/// The envelope of all circles of Hoek-Brown's curve.
void draw_hoek_brown(Canvas& canvas, const PlotFrame& frame, const HoekBrown& curve) {
    std::vector<Vec2> contacts;
    const double lowest = curve.lowest_sigma_3();
    for (int i = 1; i <= n_curve_points; ++i) {
        const double share = static_cast<double>(i) / n_curve_points;
        const double sigma_3 = lowest + share * share * (frame.x.high * mega - lowest); // denser where it bends
        const double sigma_1 = curve.sigma_1(sigma_3);
        if (!(sigma_1 > sigma_3)) continue;
        const double slope = 1.0 + 0.5 * curve.m_i.value * curve.sigma_ci.value / (sigma_1 - sigma_3);
        contacts.push_back(frame.place(point_of_contact(sigma_3, sigma_1, slope) / mega));
    }
    canvas.polyline(contacts, hoek_brown_stroke);
}

std::string plus_minus(const std::optional<double>& error, int decimals) {
    return error ? fmt::format(" \u00b1 {:.{}f}", *error, decimals) : "";
}

std::string stress_with_error(const Estimate& stress) {
    return fmt::format("{:.3f}{} MPa", stress.value / mega,
                       plus_minus(stress.error ? std::optional(*stress.error / mega) : std::nullopt, 3));
}

std::string constants(const Envelope& envelope) {
    const auto error = envelope.friction_angle_error();
    return fmt::format(
        "c = {}, \u03c6 = {:.1f}{}\u00b0", stress_with_error({envelope.cohesion, envelope.cohesion_error()}),
        envelope.friction_angle * degrees, plus_minus(error ? std::optional(*error * degrees) : std::nullopt, 1));
}

/// Dashed, dotted, dash-dotted: one kind after the other.
Stroke other_stroke(std::size_t index) {
    const std::array<std::vector<double>, 3> dashes{{{6.0, 3.0}, {1.5, 2.5}, {7.0, 2.5, 1.5, 2.5}}};
    return {colour(0x666666), 1.1, dashes[index % dashes.size()]};
}

LegendEntry band_entry() {
    return {"95 % confidence of the line", [](Canvas& canvas, const Vec2& middle) {
                canvas.fill_rectangle(middle - Vec2(9.0, 4.0), {18.0, 8.0}, confidence_colour);
            }};
}

void add_curves(const StrengthFit& fit, const std::vector<NamedEnvelope>& others, std::vector<LegendEntry>& entries) {
    const Envelope& envelope = fit.envelope;
    const std::string quality =
        envelope.covariance ? fmt::format(", R\u00b2 = {:.4f}", envelope.residuals.r_squared) : "";
    entries.push_back(line_entry("fit: " + constants(envelope) + quality, fit_stroke));
    if (envelope.covariance) entries.push_back(band_entry());
    if (fit.tensile_strength)
        entries.push_back(
            line_entry("tension cut-off: \u03c3t = " + stress_with_error(*fit.tensile_strength), cut_off_stroke));
    if (const auto& curve = fit.hoek_brown.curve)
        entries.push_back(
            line_entry(fmt::format("Hoek-Brown: \u03c3ci = {}, mi = {:.2f}{}", stress_with_error(curve->sigma_ci),
                                   curve->m_i.value, plus_minus(curve->m_i.error, 2)),
                       hoek_brown_stroke));
    for (std::size_t i = 0; i < others.size(); ++i)
        entries.push_back(line_entry(others[i].label + ": " + constants(others[i].envelope), other_stroke(i)));
}

std::string circle_label(const PeakPoint& point) {
    const std::string reason = bound_reason(point);
    return fmt::format("{}: \u03c3\u2083 = {:.2f} MPa, \u03c3\u2081 = {:#.3g} MPa{}", point.run, point.sigma_3 / mega,
                       point.sigma_1 / mega, reason.empty() ? "" : ", " + reason);
}

void add_kinds(const std::vector<PeakPoint>& points, std::vector<LegendEntry>& entries) {
    for (const auto& [use, name] : {std::pair{PeakUse::strength, "strengths"},
                                    {PeakUse::tension, "tension tests"},
                                    {PeakUse::bound, "bounds, left out of the fit"}}) {
        const auto is_such = [use = use](const PeakPoint& point) { return use_of(point) == use; };
        const auto n = std::ranges::count_if(points, is_such);
        if (n == 0) continue;
        const auto first = static_cast<std::size_t>(std::ranges::find_if(points, is_such) - points.begin());
        entries.push_back(line_entry(fmt::format("{} {}", n, name), circle_stroke(points, first)));
    }
}

/// The lines, then one entry per circle.
std::vector<LegendEntry> legend_of(const std::vector<PeakPoint>& points, const StrengthFit& fit,
                                   const std::vector<NamedEnvelope>& others) {
    std::vector<LegendEntry> entries;
    add_curves(fit, others, entries);
    if (points.size() > most_named_circles) {
        add_kinds(points, entries);
        return entries;
    }
    for (std::size_t i = 0; i < points.size(); ++i)
        entries.push_back(line_entry(circle_label(points[i]), circle_stroke(points, i)));
    return entries;
}

} // namespace

std::string draw_envelope(const std::string& title, const std::vector<PeakPoint>& points, const StrengthFit& fit,
                          const std::vector<NamedEnvelope>& others, PictureFormat format) {
    const PlotFrame frame = frame_of(points, fit);
    const LegendGrid below(legend_of(points, fit, others), frame.size.x());
    const double bottom = frame.corner.y() + frame.size.y() + below_plot;
    const Vec2 page(frame.corner.x() + frame.size.x() + right_of_plot, bottom + below.height());
    return draw_picture(format, page.x(), page.y(), plot_pixels_per_point, [&](Canvas& canvas) {
        canvas.text_within(frame.size.x(), {frame.corner.x(), 26.0}, title, {.size = 11.5, .bold = true});
        draw_axes(canvas, frame, "normal stress (MPa, compression positive)", "shear stress (MPa)");
        canvas.begin_clip(frame.corner, frame.size);
        draw_confidence(canvas, frame, fit.envelope);
        for (std::size_t i = 0; i < points.size(); ++i) draw_circle(canvas, frame, points[i], circle_stroke(points, i));
        for (std::size_t i = 0; i < others.size(); ++i)
            draw_line(canvas, frame, others[i].envelope, std::nullopt, other_stroke(i));
        if (fit.hoek_brown.curve) draw_hoek_brown(canvas, frame, *fit.hoek_brown.curve);
        draw_line(canvas, frame, fit.envelope, fit.tensile_strength, fit_stroke);
        draw_cut_off(canvas, frame, fit);
        canvas.end_clip();
        below.draw(canvas, {frame.corner.x(), bottom});
    });
}

} // namespace kluft

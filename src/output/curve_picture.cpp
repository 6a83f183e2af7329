#include "kluft/output/curve_picture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "kluft/output/atomic_file.hpp"
#include "kluft/output/axis.hpp"
#include "kluft/output/summary.hpp"

namespace kluft {

namespace {

constexpr double page_width = 500.0; // points
constexpr double page_height = 350.0;
constexpr double pixels_per_point = 3.2;
constexpr double percent = 100.0;
constexpr double mega = 1e6;
const Colour unbalanced_colour = colour(0xD7191C);
const Colour reference_colour = colour(0x666666);
const Colour text_colour = colour(0x222222);
const Colour white = colour(0xFFFFFF);

bool finite(const Vec2& v) { return std::isfinite(v.x()) && std::isfinite(v.y()); }

/// Smallest box around all that is plotted; always contains zero in y.
struct Range {
    Vec2 low{std::numeric_limits<double>::infinity(), 0.0};
    Vec2 high{-std::numeric_limits<double>::infinity(), 0.0};

    void cover(const Vec2& v) {
        if (!finite(v)) return;
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
};

Range range_of(const CurvePlot& plot) {
    Range range;
    for (const PlottedCurve& curve : plot.curves) {
        for (const PlottedPoint& point : curve.points) range.cover(point.value);
        for (const Vec2& point : curve.fine) range.cover(point);
        if (curve.peak) range.cover(*curve.peak);
    }
    for (const PlottedReference& reference : plot.references)
        range.cover({reference.x.value_or(range.low.x()), reference.y});
    return range;
}

PlotFrame frame_of(const CurvePlot& plot) {
    const Range range = range_of(plot);
    constexpr double room_above = 1.1; // for the text beside a peak
    PlotFrame frame;
    frame.corner = {66.0, plot.title.empty() ? 18.0 : 38.0};
    frame.size = Vec2(page_width - 18.0, page_height - 46.0) - frame.corner;
    frame.x = round_axis(std::min(0.0, range.low.x()), range.high.x(), 8);
    frame.y = round_axis(range.low.y(), room_above * range.high.y(), 6);
    return frame;
}

bool any_unbalanced(const CurvePlot& plot) {
    return std::any_of(plot.curves.begin(), plot.curves.end(), [](const PlottedCurve& curve) {
        return std::any_of(curve.points.begin(), curve.points.end(), [](const auto& point) { return !point.balanced; });
    });
}

std::vector<Vec2> places(const PlotFrame& frame, const std::vector<Vec2>& values) {
    std::vector<Vec2> points;
    for (const Vec2& value : values)
        if (finite(value)) points.push_back(frame.place(value));
    return points;
}

void draw_unbalanced_marker(Canvas& canvas, const Vec2& at) { canvas.circle(at, 2.6, white, {unbalanced_colour, 1.1}); }

/// The curve in stretches: solid between balanced points, dashed to and from unbalanced ones.
void draw_line(Canvas& canvas, const PlotFrame& frame, const std::vector<PlottedPoint>& points, const Colour& line) {
    std::vector<Vec2> solid;
    std::vector<std::pair<Vec2, Vec2>> dashed;
    const PlottedPoint* before = nullptr;
    for (const PlottedPoint& point : points) {
        if (!finite(point.value)) continue;
        const Vec2 at = frame.place(point.value);
        if (before != nullptr && !(before->balanced && point.balanced)) {
            dashed.emplace_back(frame.place(before->value), at);
            canvas.polyline(solid, {line, 1.5, {}, true});
            solid.clear();
        }
        solid.push_back(at);
        before = &point;
    }
    canvas.polyline(solid, {line, 1.5, {}, true});
    canvas.segments(dashed, {unbalanced_colour, 0.8, {2.5, 2.0}});
}

void draw_curve(Canvas& canvas, const PlotFrame& frame, const PlottedCurve& curve, const Colour& line) {
    if (!curve.fine.empty()) {
        Colour faint = line;
        faint.alpha = 0.35;
        canvas.polyline(places(frame, curve.fine), {faint, 0.6});
    }
    draw_line(canvas, frame, curve.points, line);
    constexpr std::size_t most_markers = 60;
    for (const PlottedPoint& point : curve.points) {
        if (!finite(point.value)) continue;
        const Vec2 at = frame.place(point.value);
        if (!point.balanced)
            draw_unbalanced_marker(canvas, at);
        else if (curve.points.size() <= most_markers)
            canvas.circle(at, 1.5, line, {line, 0.3});
    }
}

void draw_peak_marker(Canvas& canvas, const Vec2& at, const Colour& line) {
    canvas.circle(at, 3.6, white, {line, 1.6});
    canvas.circle(at, 1.3, line, {line, 0.3});
}

/// Text above and beside the peak, on the side that has room, with a white halo.
void draw_peak(Canvas& canvas, const PlotFrame& frame, const PlottedCurve& curve, const Colour& line) {
    if (!curve.peak || !finite(*curve.peak)) return;
    const Vec2 at = frame.place(*curve.peak);
    draw_peak_marker(canvas, at, line);
    const TextStyle style{.size = 8.5, .colour = line, .halo = 2.5};
    double width = 0.0;
    for (const std::string& text : curve.peak_text) width = std::max(width, canvas.text_width(text, style));
    const double left = frame.corner.x() + 4.0;
    const double right = frame.corner.x() + frame.size.x() - 4.0 - width;
    const double x = std::clamp(at.x() - 0.5 * width, std::min(left, right), std::max(left, right));
    const double line_height = 11.0;
    double y = at.y() - 8.0 - line_height * (static_cast<double>(curve.peak_text.size()) - 1.0);
    y = std::max(y, frame.corner.y() + line_height);
    for (const std::string& text : curve.peak_text) {
        canvas.text({x, y}, text, style);
        y += line_height;
    }
}

void draw_cross(Canvas& canvas, const Vec2& at, const Colour& line) {
    constexpr double arm = 4.0;
    canvas.segments({{at + Vec2(-arm, -arm), at + Vec2(arm, arm)}, {at + Vec2(-arm, arm), at + Vec2(arm, -arm)}},
                    {line, 1.5, {}, true});
}

void draw_references(Canvas& canvas, const PlotFrame& frame, const std::vector<PlottedReference>& references) {
    for (const PlottedReference& reference : references) {
        const double right = frame.corner.x() + frame.size.x();
        if (reference.x) {
            draw_cross(canvas, frame.place({*reference.x, reference.y}), reference_colour);
        } else {
            const double y = frame.place({0.0, reference.y}).y();
            canvas.line({frame.corner.x(), y}, {right, y}, {reference_colour, 0.9, {5.0, 3.0}});
            const TextStyle style{.size = 8.0, .colour = reference_colour, .across = Align::high, .halo = 2.0};
            canvas.text({right - 5.0, y - 3.0}, reference.label, style);
        }
    }
}

struct LegendEntry {
    std::string label;
    std::function<void(Canvas&, const Vec2& middle)> draw_sample;
};

std::vector<LegendEntry> legend_of(const CurvePlot& plot) {
    std::vector<LegendEntry> entries;
    for (std::size_t i = 0; i < plot.curves.size(); ++i) {
        if (plot.curves[i].label.empty()) continue;
        const Colour line = series_colour(i);
        entries.push_back({plot.curves[i].label, [line](Canvas& canvas, const Vec2& middle) {
                               canvas.line(middle - Vec2(9.0, 0.0), middle + Vec2(9.0, 0.0), {line, 1.6});
                           }});
    }
    for (const PlottedReference& reference : plot.references) {
        const bool listed = std::any_of(entries.begin(), entries.end(),
                                        [&](const LegendEntry& entry) { return entry.label == reference.label; });
        if (!reference.x || reference.label.empty() || listed) continue;
        entries.push_back({reference.label,
                           [](Canvas& canvas, const Vec2& middle) { draw_cross(canvas, middle, reference_colour); }});
    }
    if (any_unbalanced(plot)) entries.push_back({"unbalanced step", draw_unbalanced_marker});
    return entries;
}

/// Number of curve points under a box on the page.
std::size_t points_under(const CurvePlot& plot, const PlotFrame& frame, const Vec2& corner, const Vec2& size) {
    std::size_t n_points = 0;
    for (const PlottedCurve& curve : plot.curves)
        for (const PlottedPoint& point : curve.points) {
            const Vec2 at = frame.place(point.value) - corner;
            n_points += at.x() > 0.0 && at.x() < size.x() && at.y() > -24.0 && at.y() < size.y() + 8.0 ? 1 : 0;
        }
    return n_points;
}

/// The corner of the frame where a box covers the fewest points of the curves.
Vec2 freest_corner(const CurvePlot& plot, const PlotFrame& frame, const Vec2& size) {
    constexpr double margin = 8.0;
    const Vec2 low = frame.corner + Vec2(margin, margin);
    const Vec2 high = frame.corner + frame.size - size - Vec2(margin, margin);
    Vec2 best = {high.x(), high.y()};
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const Vec2& corner : {Vec2(high.x(), high.y()), Vec2(high.x(), low.y()), Vec2(low.x(), low.y())}) {
        const std::size_t n_points = points_under(plot, frame, corner, size);
        if (n_points >= fewest) continue;
        fewest = n_points;
        best = corner;
    }
    return best;
}

void draw_legend(Canvas& canvas, const PlotFrame& frame, const CurvePlot& plot) {
    const auto entries = legend_of(plot);
    if (entries.empty()) return;
    const TextStyle style{.size = 8.5, .down = Align::middle};
    constexpr double line_height = 14.0;
    double width = 0.0;
    for (const LegendEntry& entry : entries) width = std::max(width, canvas.text_width(entry.label, style));
    const Vec2 size{width + 42.0, line_height * static_cast<double>(entries.size()) + 6.0};
    const Vec2 corner = freest_corner(plot, frame, size);
    canvas.fill_rectangle(corner, size, colour(0xFFFFFF, 0.9));
    canvas.stroke_rectangle(corner, size, {colour(0xCCCCCC), 0.6});
    double y = corner.y() + 3.0 + 0.5 * line_height;
    for (const LegendEntry& entry : entries) {
        entry.draw_sample(canvas, {corner.x() + 17.0, y});
        canvas.text({corner.x() + 34.0, y}, entry.label, style);
        y += line_height;
    }
}

void draw_plot(Canvas& canvas, const CurvePlot& plot) {
    const PlotFrame frame = frame_of(plot);
    canvas.text_within(frame.size.x(), {frame.corner.x(), 24.0}, plot.title,
                       {.size = 11.5, .colour = text_colour, .bold = true});
    draw_axes(canvas, frame, plot.x_name, plot.y_name);
    canvas.begin_clip(frame.corner, frame.size);
    draw_references(canvas, frame, plot.references);
    for (std::size_t i = 0; i < plot.curves.size(); ++i) draw_curve(canvas, frame, plot.curves[i], series_colour(i));
    canvas.end_clip();
    draw_legend(canvas, frame, plot);
    for (std::size_t i = 0; i < plot.curves.size(); ++i) draw_peak(canvas, frame, plot.curves[i], series_colour(i));
}

Vec2 plotted(const StepRecord& record) { return {percent * record.axial_strain, record.differential_stress / mega}; }

PlottedCurve plotted_run(const RunCurve& run) {
    PlottedCurve curve;
    curve.label = run.label;
    for (const StepRecord& record : platen_rows(run.history, run.platen_stage))
        curve.points.push_back({plotted(record), record.balanced});
    for (const StepRecord& record : platen_rows(run.equilibria, run.platen_stage))
        if (record.balanced) curve.fine.push_back(plotted(record));
    if (const auto peak = peak_row(run.equilibria.empty() ? run.history : run.equilibria)) {
        curve.peak = plotted(*peak);
        curve.peak_text = {fmt::format("{:#.3g} MPa at {:.2f} %", curve.peak->y(), curve.peak->x()),
                           fmt::format("\u03c3\u2081 = {:#.3g} MPa", peak->axial_stress / mega)};
    }
    return curve;
}

} // namespace

CurvePlot stress_strain_plot(const std::string& title, const std::vector<RunCurve>& runs,
                             const std::vector<PlottedReference>& references) {
    CurvePlot plot{title, "axial strain (%)", "differential stress (MPa)", {}, references};
    for (const RunCurve& run : runs) plot.curves.push_back(plotted_run(run));
    return plot;
}

std::string draw_curves(const CurvePlot& plot, PictureFormat format) {
    return draw_picture(format, page_width, page_height, pixels_per_point,
                        [&](Canvas& canvas) { draw_plot(canvas, plot); });
}

void write_curves(const std::filesystem::path& path, const CurvePlot& plot) {
    write_file(path, draw_curves(plot, picture_format(path)));
}

} // namespace kluft

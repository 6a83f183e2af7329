#include "kluft/output/curve_picture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/units.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/axis.hpp"
#include "kluft/output/page_box.hpp"
#include "kluft/output/summary.hpp"
#include "legend.hpp"

namespace kluft {

namespace {

constexpr double page_width = 500.0;  // points
constexpr double plot_height = 350.0; // without the legend of several curves
constexpr double left_margin = 66.0;
constexpr double right_margin = 18.0;
constexpr double band_opacity = 0.22;
const Colour unbalanced_colour = colour(0xD7191C);
const Colour reference_colour = colour(0x666666);
const Colour text_colour = colour(0x222222);
const Colour white = colour(0xFFFFFF);

/// Each curve has a colour; beyond as many curves as there are colours, dashes tell them apart.
Stroke curve_stroke(const CurvePlot& plot, std::size_t index) {
    constexpr std::size_t n_colours = 7;
    const PlottedCurve& curve = plot.curves[index];
    const std::size_t number = curve.colour.value_or(index);
    Stroke stroke{series_colour(number), 1.5, {}, true};
    if (number >= n_colours || curve.dashed) stroke.dash = {5.0, 3.0};
    if (curve.thin) {
        stroke.width = 0.6;
        stroke.colour.alpha = 0.5;
    }
    return stroke;
}

Colour reference_stroke_colour(const PlottedReference& reference) {
    return reference.curve ? series_colour(*reference.curve) : reference_colour;
}

bool finite(const Vec2& v) { return std::isfinite(v.x()) && std::isfinite(v.y()); }

/// Whether the axes of the plot have a place for it.
bool has_place(const CurvePlot& plot, const Vec2& v) {
    return finite(v) && !(plot.log_x && v.x() <= 0.0) && !(plot.log_y && v.y() <= 0.0);
}

/// The plot without what its axes have no place for.
CurvePlot drawable(CurvePlot plot) {
    if (!plot.log_x && !plot.log_y) return plot;
    const double nowhere = std::numeric_limits<double>::quiet_NaN();
    const auto hide = [&](Vec2& v) {
        if (!has_place(plot, v)) v = {nowhere, nowhere};
    };
    for (PlottedCurve& curve : plot.curves) {
        for (PlottedPoint& point : curve.points) hide(point.value);
        for (Vec2& point : curve.fine) hide(point);
        if (curve.peak) hide(*curve.peak);
    }
    std::erase_if(plot.references, [&](const PlottedReference& reference) {
        return !has_place(plot, {reference.x.value_or(1.0), reference.y});
    });
    return plot;
}

/// Smallest box around all that is plotted.
struct Range {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());

    void cover(const Vec2& v) {
        if (!finite(v)) return;
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
};

Range range_of(const CurvePlot& plot) {
    Range range;
    if (plot.y_from_zero && !plot.log_y) range.low.y() = range.high.y() = 0.0;
    for (const PlottedBand& band : plot.bands)
        for (std::size_t i = 0; i < band.x.size(); ++i) {
            range.cover({band.x[i], band.low[i]});
            range.cover({band.x[i], band.high[i]});
        }
    for (const PlottedCurve& curve : plot.curves) {
        for (const PlottedPoint& point : curve.points) range.cover(point.value);
        for (const Vec2& point : curve.fine) range.cover(point);
        if (curve.peak) range.cover(*curve.peak);
    }
    for (const PlottedReference& reference : plot.references)
        range.cover({reference.x.value_or(range.low.x()), reference.y});
    return range;
}

double height_of(const Range& range) { return range.high.y() - range.low.y(); }

PlotFrame frame_of(const CurvePlot& plot) {
    const Range range = range_of(plot);
    const bool any_text = std::any_of(plot.curves.begin(), plot.curves.end(),
                                      [](const PlottedCurve& curve) { return !curve.peak_text.empty(); });
    const double room_above = any_text ? 0.1 : 0.04; // for the text beside a peak
    PlotFrame frame;
    frame.corner = {left_margin, plot.title.empty() ? 18.0 : 38.0};
    frame.size = Vec2(page_width - right_margin, plot_height - 46.0) - frame.corner;
    frame.x = plot.log_x ? round_log_axis(range.low.x(), range.high.x())
                         : round_axis(std::min(0.0, range.low.x()), range.high.x(), 8);
    frame.y = plot.log_y
                  ? round_log_axis(range.low.y(), range.high.y())
                  : round_axis(range.low.y() - (plot.y_from_zero ? 0.0 : room_above * height_of(range)),
                               range.high.y() + room_above * (plot.y_from_zero ? range.high.y() : height_of(range)), 6);
    if (plot.y_limit) frame.y = round_axis(std::min(range.low.y(), *plot.y_limit), *plot.y_limit, 6);
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

/// The curve in stretches: its own stroke between balanced points, thin red dashes to and from unbalanced ones.
void draw_line(Canvas& canvas, const PlotFrame& frame, const std::vector<PlottedPoint>& points, const Stroke& stroke) {
    std::vector<Vec2> line;
    std::vector<std::pair<Vec2, Vec2>> unbalanced;
    const PlottedPoint* before = nullptr;
    for (const PlottedPoint& point : points) {
        if (!finite(point.value)) continue;
        const Vec2 at = frame.place(point.value);
        if (before != nullptr && !(before->balanced && point.balanced)) {
            unbalanced.emplace_back(frame.place(before->value), at);
            canvas.polyline(line, stroke);
            line.clear();
        }
        line.push_back(at);
        before = &point;
    }
    canvas.polyline(line, stroke);
    canvas.segments(unbalanced, {unbalanced_colour, 0.8, {2.5, 2.0}});
}

void draw_curve(Canvas& canvas, const PlotFrame& frame, const PlottedCurve& curve, const Stroke& stroke) {
    if (!curve.fine.empty()) {
        Colour faint = stroke.colour;
        faint.alpha = 0.35;
        canvas.polyline(places(frame, curve.fine), {faint, 0.6});
    }
    if (curve.joined) draw_line(canvas, frame, curve.points, stroke);
    if (curve.thin) return;
    constexpr std::size_t most_markers = 60;
    const double radius = curve.joined ? 1.5 : 2.4;
    for (const PlottedPoint& point : curve.points) {
        if (!finite(point.value)) continue;
        const Vec2 at = frame.place(point.value);
        if (!point.balanced)
            draw_unbalanced_marker(canvas, at);
        else if (curve.points.size() <= most_markers)
            canvas.circle(at, radius, stroke.colour, {stroke.colour, 0.3});
    }
}

/// Reached: a ring around a point. Still rising: a dashed ring.
void draw_peak_marker(Canvas& canvas, const Vec2& at, const Colour& line, bool reached) {
    if (!reached) {
        canvas.circle(at, 3.6, white, {line, 1.2, {1.8, 1.2}});
        return;
    }
    canvas.circle(at, 3.6, white, {line, 1.6});
    canvas.circle(at, 1.3, line, {line, 0.3});
}

/// Whether the peak can be drawn: a number, and not above the limit of the plot.
bool has_shown_peak(const PlotFrame& frame, const PlottedCurve& curve) {
    return curve.peak && finite(*curve.peak) && curve.peak->y() <= frame.y.high;
}

/// Text above and beside the peak, on the side that has room, with a white halo.
void draw_peak(Canvas& canvas, const PlotFrame& frame, const PlottedCurve& curve, const Colour& line) {
    if (!has_shown_peak(frame, curve)) return;
    const Vec2 at = frame.place(*curve.peak);
    draw_peak_marker(canvas, at, line, curve.peak_reached);
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

Obstacles obstacles_of(const CurvePlot& plot, const PlotFrame& frame) {
    Obstacles obstacles;
    for (const PlottedCurve& curve : plot.curves) {
        std::vector<Vec2> values;
        for (const PlottedPoint& point : curve.points) values.push_back(point.value);
        if (curve.joined) {
            obstacles.lines.push_back(places(frame, values));
        } else {
            const Vec2 beside(3.0, 0.0);
            const Vec2 above(0.0, 3.0);
            for (const Vec2& at : places(frame, values)) {
                obstacles.lines.push_back({at - beside, at + beside});
                obstacles.lines.push_back({at - above, at + above});
            }
        }
        if (!has_shown_peak(frame, curve)) continue;
        const Vec2 at = frame.place(*curve.peak);
        const double above = curve.peak_text.empty() ? 4.0 : 8.0 + 11.0 * static_cast<double>(curve.peak_text.size());
        const double beside = curve.peak_text.empty() ? 4.0 : 45.0;
        obstacles.boxes.push_back({at - Vec2(beside, above), at + Vec2(beside, 4.0)});
    }
    return obstacles;
}

void draw_band(Canvas& canvas, const PlotFrame& frame, const PlottedBand& band) {
    std::vector<Vec2> loop;
    for (std::size_t i = 0; i < band.x.size(); ++i) loop.push_back(frame.place({band.x[i], band.high[i]}));
    for (std::size_t i = band.x.size(); i-- > 0;) loop.push_back(frame.place({band.x[i], band.low[i]}));
    Colour fill = series_colour(band.colour);
    fill.alpha = band_opacity;
    canvas.fill_polygon({loop}, fill);
}

/// Texts beside points, each on that side where it meets the fewest curves and texts.
void draw_point_texts(Canvas& canvas, const PlotFrame& frame, const PlottedCurve& curve, const Colour& line,
                      Obstacles& obstacles) {
    const TextStyle style{.size = 7.5, .colour = line, .halo = 2.0};
    constexpr double height = 6.0;
    for (std::size_t i = 0; i < std::min(curve.points.size(), curve.point_texts.size()); ++i) {
        const std::string& text = curve.point_texts[i];
        if (text.empty() || !finite(curve.points[i].value)) continue;
        const Vec2 at = frame.place(curve.points[i].value);
        const double width = canvas.text_width(text, style);
        PageBox best;
        std::size_t fewest = std::numeric_limits<std::size_t>::max();
        const double first_place = frame.corner.x() + 4.0;
        const double last_place = frame.corner.x() + frame.size.x() - 4.0 - width;
        const std::vector<Vec2> corners{at + Vec2(6.0, -0.5 * height),
                                        at + Vec2(4.0, -4.0 - height),
                                        at + Vec2(4.0, 4.0),
                                        at + Vec2(-6.0 - width, -0.5 * height),
                                        at + Vec2(-4.0 - width, 4.0),
                                        at + Vec2(-4.0 - width, -4.0 - height),
                                        at + Vec2(-0.5 * width, 7.0),
                                        at + Vec2(-0.5 * width, -7.0 - height),
                                        at + Vec2(2.0, -11.0 - height),
                                        at + Vec2(2.0, 11.0),
                                        at + Vec2(-2.0 - width, 11.0),
                                        at + Vec2(-2.0 - width, -11.0 - height),
                                        {std::min(at.x() + 2.0, last_place), at.y() - 11.0 - height},
                                        {std::max(at.x() - 2.0 - width, first_place), at.y() - 11.0 - height}};
        for (const Vec2& low : corners) {
            const PageBox box{low - Vec2(1.0, 1.0), low + Vec2(width + 1.0, height + 1.0)};
            const Vec2 room(1.5, 1.5); // for the halo
            if (((box.low - room).array() < frame.corner.array()).any() ||
                ((box.high + room).array() > (frame.corner + frame.size).array()).any())
                continue;
            const std::size_t n_met = obstacles.met_by(box);
            if (n_met >= fewest) continue;
            fewest = n_met;
            best = box;
        }
        if (fewest == std::numeric_limits<std::size_t>::max()) continue;
        canvas.text({best.low.x() + 1.0, best.high.y() - 1.0}, text, style);
        obstacles.boxes.push_back(best);
    }
}

/// The label of a level stands above it or below, where it meets the fewest curves; rather to the right.
void draw_level_label(Canvas& canvas, const PlotFrame& frame, const PlottedReference& reference, Obstacles& obstacles) {
    const TextStyle style{.size = 8.0, .colour = reference_stroke_colour(reference), .halo = 2.0};
    const double width = canvas.text_width(reference.label, style);
    const double y = frame.place({0.0, reference.y}).y();
    const double right = frame.corner.x() + frame.size.x() - 5.0 - width;
    constexpr double height = 6.0;
    constexpr double gap = 3.0;
    constexpr int n_places = 24;
    PageBox best;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const double base : {y - gap, y + gap + height})
        for (int i = 0; i <= n_places; ++i) {
            const double x = right - (right - frame.corner.x() - 5.0) * i / n_places;
            const PageBox box{{x - 2.0, base - height - 2.0}, {x + width + 2.0, base + 2.0}};
            if (box.low.y() < frame.corner.y() || box.high.y() > frame.corner.y() + frame.size.y()) continue;
            const std::size_t n_met = obstacles.met_by(box);
            if (n_met >= fewest) continue;
            fewest = n_met;
            best = box;
        }
    if (fewest == std::numeric_limits<std::size_t>::max()) return;
    canvas.text({best.low.x() + 2.0, best.high.y() - 2.0}, reference.label, style);
    obstacles.boxes.push_back(best);
}

void draw_references(Canvas& canvas, const PlotFrame& frame, const std::vector<PlottedReference>& references) {
    for (const PlottedReference& reference : references) {
        const Colour line = reference_stroke_colour(reference);
        if (reference.x) {
            draw_cross(canvas, frame.place({*reference.x, reference.y}), line);
        } else {
            const double y = frame.place({0.0, reference.y}).y();
            canvas.line({frame.corner.x(), y}, {frame.corner.x() + frame.size.x(), y}, {line, 0.9, {5.0, 3.0}});
        }
    }
}

std::vector<LegendEntry> legend_of(const CurvePlot& plot) {
    std::vector<LegendEntry> entries;
    for (std::size_t i = 0; i < plot.curves.size(); ++i) {
        if (plot.curves[i].label.empty()) continue;
        const Stroke stroke = curve_stroke(plot, i);
        if (plot.curves[i].joined) {
            entries.push_back(line_entry(plot.curves[i].label, stroke));
        } else {
            entries.push_back({plot.curves[i].label, [line = stroke.colour](Canvas& canvas, const Vec2& middle) {
                                   canvas.circle(middle, 2.4, line, {line, 0.3});
                               }});
        }
    }
    for (const PlottedBand& band : plot.bands) {
        if (band.label.empty()) continue;
        entries.push_back({band.label, [number = band.colour](Canvas& canvas, const Vec2& middle) {
                               Colour fill = series_colour(number);
                               fill.alpha = band_opacity;
                               canvas.fill_rectangle(middle - Vec2(9.0, 4.0), {18.0, 8.0}, fill);
                           }});
    }
    for (const PlottedReference& reference : plot.references) {
        const bool listed = std::any_of(entries.begin(), entries.end(),
                                        [&](const LegendEntry& entry) { return entry.label == reference.label; });
        if (!reference.x || reference.label.empty() || listed) continue;
        const Colour line = reference_stroke_colour(reference);
        entries.push_back(
            {reference.label, [line](Canvas& canvas, const Vec2& middle) { draw_cross(canvas, middle, line); }});
    }
    if (any_unbalanced(plot)) entries.push_back({plot.unbalanced_name, draw_unbalanced_marker});
    return entries;
}

double label_width(Canvas& canvas, const std::vector<LegendEntry>& entries) {
    double width = 0.0;
    for (const LegendEntry& entry : entries) width = std::max(width, canvas.text_width(entry.label, legend_style));
    return width;
}

/// The corner of the frame where a box is met by the fewest curves.
Vec2 freest_corner(const Obstacles& obstacles, const PlotFrame& frame, const Vec2& size) {
    constexpr double margin = 8.0;
    const Vec2 low = frame.corner + Vec2(margin, margin);
    const Vec2 high = frame.corner + frame.size - size - Vec2(margin, margin);
    Vec2 best = {high.x(), high.y()};
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const Vec2& corner : {Vec2(high.x(), high.y()), Vec2(high.x(), low.y()), Vec2(low.x(), low.y())}) {
        const Vec2 room(6.0, 6.0); // for markers
        const std::size_t n_met = obstacles.met_by({corner - room, corner + size + room});
        if (n_met >= fewest) continue;
        fewest = n_met;
        best = corner;
    }
    return best;
}

/// The legend of one curve, inside the frame.
void draw_legend_inside(Canvas& canvas, const PlotFrame& frame, const CurvePlot& plot, Obstacles& obstacles) {
    const auto entries = legend_of(plot);
    if (entries.empty()) return;
    constexpr double indent = 34.0;
    const Vec2 size{label_width(canvas, entries) + indent + 8.0,
                    legend_line * static_cast<double>(entries.size()) + 6.0};
    Obstacles with_levels = obstacles;
    for (const PlottedReference& reference : plot.references)
        with_levels.lines.push_back({frame.place({reference.x.value_or(frame.x.low), reference.y}),
                                     frame.place({reference.x.value_or(frame.x.high), reference.y})});
    const Vec2 corner = freest_corner(with_levels, frame, size);
    canvas.fill_rectangle(corner, size, colour(0xFFFFFF, 0.9));
    canvas.stroke_rectangle(corner, size, {colour(0xCCCCCC), 0.6});
    double y = corner.y() + 3.0 + 0.5 * legend_line;
    for (const LegendEntry& entry : entries) {
        entry.draw_sample(canvas, {corner.x() + 17.0, y});
        canvas.text({corner.x() + indent, y}, entry.label, legend_style);
        y += legend_line;
    }
    obstacles.boxes.push_back({corner, corner + size});
}

/// The legend of several curves stands below the plot.
LegendGrid legend_below(const CurvePlot& plot) {
    if (plot.curves.size() < 2 && plot.bands.empty()) return {};
    return {legend_of(plot), page_width - left_margin - right_margin};
}

void draw_plot(Canvas& canvas, const CurvePlot& plot, const LegendGrid& below) {
    const PlotFrame frame = frame_of(plot);
    canvas.text_within(frame.size.x(), {frame.corner.x(), 24.0}, plot.title,
                       {.size = 11.5, .colour = text_colour, .bold = true});
    draw_axes(canvas, frame, plot.x_name, plot.y_name);
    const Vec2 room(5.0, 5.0); // markers on the frame are drawn whole, but nothing above a limit
    const Vec2 above(0.0, plot.y_limit ? room.y() : 0.0);
    canvas.begin_clip(frame.corner - room + above, frame.size + 2.0 * room - above);
    for (const PlottedBand& band : plot.bands) draw_band(canvas, frame, band);
    draw_references(canvas, frame, plot.references);
    Obstacles obstacles = obstacles_of(plot, frame);
    for (std::size_t i = 0; i < plot.curves.size(); ++i) // below the markers, which they might hide
        draw_point_texts(canvas, frame, plot.curves[i], curve_stroke(plot, i).colour, obstacles);
    for (std::size_t i = 0; i < plot.curves.size(); ++i)
        draw_curve(canvas, frame, plot.curves[i], curve_stroke(plot, i));
    canvas.end_clip();
    below.draw(canvas, {frame.corner.x(), plot_height});
    if (plot.curves.size() < 2 && plot.bands.empty()) draw_legend_inside(canvas, frame, plot, obstacles);
    for (const PlottedReference& reference : plot.references)
        if (!reference.x) draw_level_label(canvas, frame, reference, obstacles);
    for (std::size_t i = 0; i < plot.curves.size(); ++i)
        draw_peak(canvas, frame, plot.curves[i], series_colour(plot.curves[i].colour.value_or(i)));
}

Vec2 plotted(const StepRecord& record) { return {percent * record.axial_strain, record.differential_stress / mega}; }

/// Peak and text of a run; `alone`: the values stand beside the peak, otherwise in the legend.
void add_peak(const RunCurve& run, const StepRecord& peak, bool alone, PlottedCurve& curve) {
    const auto& rows = run.equilibria.empty() ? run.history : run.equilibria;
    curve.peak = plotted(peak);
    const CurveNumbers numbers = curve_numbers(rows, {}, run.platen_stage, Plane::strain);
    curve.peak_reached = is_strength(numbers);
    const std::string values = fmt::format("differential {:#.3g} MPa at {:#.3g} %", curve.peak->y(), curve.peak->x());
    if (alone) {
        curve.peak_text = {values, fmt::format("axial {:#.3g} MPa", peak.axial_stress / mega)};
        if (const std::string remark = peak_remark(numbers); !remark.empty()) curve.peak_text.push_back(remark);
    } else {
        curve.label += ": " + (curve.peak_reached ? values : peak_remark(numbers));
    }
}

PlottedCurve plotted_run(const RunCurve& run, bool alone) {
    PlottedCurve curve;
    curve.label = run.label;
    for (const StepRecord& record : platen_rows(run.history, run.platen_stage.value_or(0)))
        curve.points.push_back({plotted(record), record.balanced});
    for (const StepRecord& record : platen_rows(run.equilibria, run.platen_stage.value_or(0)))
        if (record.balanced) curve.fine.push_back(plotted(record));
    if (const auto peak = peak_row(run.equilibria.empty() ? run.history : run.equilibria, run.platen_stage))
        add_peak(run, *peak, alone, curve);
    return curve;
}

} // namespace

CurvePlot stress_strain_plot(const std::string& title, const std::vector<RunCurve>& runs,
                             const std::vector<PlottedReference>& references) {
    CurvePlot plot{title, "axial strain (%)", "differential stress (MPa)", {}, references};
    for (const RunCurve& run : runs) plot.curves.push_back(plotted_run(run, runs.size() == 1));
    return plot;
}

std::string draw_curves(const std::vector<CurvePlot>& given, PictureFormat format) {
    std::vector<CurvePlot> plots;
    std::vector<LegendGrid> below;
    double height = 0.0;
    for (const CurvePlot& each : given) {
        plots.push_back(drawable(each));
        below.push_back(legend_below(plots.back()));
        height += plot_height + below.back().height();
    }
    return draw_picture(format, page_width, height, plot_pixels_per_point, [&](Canvas& canvas) {
        double top = 0.0;
        for (std::size_t i = 0; i < plots.size(); ++i) {
            canvas.begin_part({0.0, top});
            draw_plot(canvas, plots[i], below[i]);
            canvas.end_part();
            top += plot_height + below[i].height();
        }
    });
}

std::string draw_curves(const CurvePlot& plot, PictureFormat format) {
    return draw_curves(std::vector<CurvePlot>{plot}, format);
}

void write_curves(const std::filesystem::path& path, const std::vector<CurvePlot>& plots) {
    write_file(path, draw_curves(plots, picture_format(path)));
}

void write_curves(const std::filesystem::path& path, const CurvePlot& plot) {
    write_curves(path, std::vector<CurvePlot>{plot});
}

} // namespace kluft

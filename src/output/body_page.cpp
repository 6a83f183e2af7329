#include "body_page.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/blocks_picture.hpp"

namespace kluft {

namespace {

constexpr double margin = 26.0; // points
constexpr double title_height = 34.0;
constexpr double panel_title_height = 18.0;
constexpr double panel_gap = 34.0;
constexpr double column_width = 158.0; // colour bar and legend
constexpr double scale_bar_height = 34.0;
const TextStyle title_style{.size = 11.5, .colour = colour(0x222222), .bold = true};
const TextStyle panel_style{.size = 9.5, .colour = colour(0x222222), .down = Align::high};
const TextStyle note_style{.size = 7.5, .colour = colour(0x666666), .down = Align::middle};

/// A round length of about a third of the panel's width, with its unit.
std::pair<double, std::string> round_length(double metres) {
    const double power = std::pow(10.0, std::floor(std::log10(metres)));
    double length = power;
    for (const double factor : {2.0, 5.0})
        if (factor * power <= metres) length = factor * power;
    if (length >= 1000.0) return {length, fmt::format("{:g} km", length / 1000.0)};
    if (length >= 1.0) return {length, fmt::format("{:g} m", length)};
    if (length >= 0.01) return {length, fmt::format("{:g} cm", 100.0 * length)};
    return {length, fmt::format("{:g} mm", 1000.0 * length)};
}

void draw_scale_bar(Canvas& canvas, const Panel& panel, const BlockSystem& body) {
    const double width = std::min(body.upper.x() - body.lower.x(), panel.box.upper.x() - panel.box.lower.x());
    if (!(width > 0.0)) return;
    const auto [length, label] = round_length(0.4 * width);
    const double y = panel.corner.y() + panel.size().y() + 13.0;
    const double x = std::max(panel.corner.x(), panel.place(body.lower).x());
    const double end = x + panel.scale * length;
    const Stroke stroke{ink::body, 1.2};
    canvas.segments({{{x, y}, {end, y}}, {{x, y - 3.0}, {x, y + 3.0}}, {{end, y - 3.0}, {end, y + 3.0}}}, stroke);
    canvas.text({end + 6.0, y}, label, {.size = 8.5, .down = Align::middle});
}

} // namespace

Vec2 PageLayout::corner(int panel) const {
    const double height = page.y() - 2.0 * margin - title_height - panel_title_height - scale_bar_height;
    return {margin + panel * (slot + panel_gap) + 0.5 * (slot - panel_size.x()),
            margin + title_height + panel_title_height + 0.5 * (height - panel_size.y())};
}

Vec2 PageLayout::column_corner() const {
    return {margin + n_panels * (slot + panel_gap), margin + title_height + panel_title_height};
}

PageLayout page_layout(const Box& box, int n_panels, double column_height, const Vec2& largest) {
    PageLayout layout;
    const Vec2 extent = (box.upper - box.lower).cwiseMax(Vec2(1e-12, 1e-12));
    layout.n_panels = n_panels;
    layout.scale = std::min(largest.x() / extent.x(), largest.y() / extent.y());
    layout.panel_size = layout.scale * extent;
    constexpr double narrowest = 130.0;
    layout.slot = std::max(narrowest, layout.panel_size.x());
    const double height = std::max(layout.panel_size.y(), column_height - panel_title_height - scale_bar_height);
    layout.page = {margin + n_panels * (layout.slot + panel_gap) + column_width + margin,
                   2.0 * margin + title_height + panel_title_height + scale_bar_height + height};
    return layout;
}

double body_pixels_per_point(const BlockSystem& system, double scale) {
    constexpr double pixels_per_block = 5.0;
    return std::clamp(pixels_per_block / block_size_on_page(system, scale), 3.0, 6.0);
}

void draw_title(Canvas& canvas, const PageLayout& layout, const std::string& title) {
    canvas.text_within(layout.page.x() - 2.0 * margin, {margin, margin + 10.0}, title, title_style);
}

void draw_panel(Canvas& canvas, const PageLayout& layout, int index, const Box& box, const DrawnBody& body,
                const std::string& heading) {
    const Panel panel{layout.corner(index), box, layout.scale};
    const double left = std::max(panel.corner.x(), panel.place(body.system.lower).x());
    canvas.text({left, panel.corner.y() - 8.0}, heading, panel_style);
    draw_body(canvas, panel, body);
    if (index == 0) draw_scale_bar(canvas, panel, body.system);
}

void draw_column(Canvas& canvas, const Vec2& corner, const std::vector<LegendEntry>& entries) {
    Vec2 at = corner + Vec2(0.0, 0.5 * legend_line);
    for (const LegendEntry& entry : entries) {
        if (entry.draw_sample) entry.draw_sample(canvas, at + Vec2(9.0, 0.0));
        const TextStyle& style = entry.draw_sample ? legend_style : note_style;
        const double indent = entry.draw_sample ? 25.0 : 0.0;
        canvas.text_within(column_width - indent, at + Vec2(indent, 0.0), entry.label, style);
        at.y() += legend_line;
    }
}

double column_height(const std::vector<LegendEntry>& entries) {
    return legend_line * static_cast<double>(entries.size());
}

void refuse_large_svg(const BlockSystem& system, PictureFormat format) {
    if (format != PictureFormat::png && system.n_blocks() > most_blocks_in_svg)
        throw InputError(fmt::format("an SVG or PDF picture of {} blocks would be too large (at most {}): take PNG",
                                     system.n_blocks(), most_blocks_in_svg));
}

} // namespace kluft

#include "kluft/output/blocks_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "body_drawing.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/axis.hpp"
#include "kluft/output/colour_scale.hpp"
#include "kluft/output/vtu.hpp"
#include "legend.hpp"

namespace kluft {

namespace {

constexpr double margin = 26.0; // points
constexpr double title_height = 34.0;
constexpr double panel_title_height = 18.0;
constexpr double panel_gap = 34.0;
constexpr double column_width = 158.0; // colour bar and legend
constexpr double scale_bar_height = 34.0;
constexpr double mega = 1e6;
const TextStyle title_style{.size = 11.5, .colour = colour(0x222222), .bold = true};
const TextStyle panel_style{.size = 9.5, .colour = colour(0x222222), .down = Align::high};
const TextStyle note_style{.size = 7.5, .colour = colour(0x666666), .down = Align::middle};

LegendEntry patch_entry(std::string label, const Colour& fill) {
    return {std::move(label), [fill](Canvas& canvas, const Vec2& middle) {
                canvas.fill_rectangle(middle - Vec2(9.0, 4.5), {18.0, 9.0}, fill);
                canvas.stroke_rectangle(middle - Vec2(9.0, 4.5), {18.0, 9.0}, {ink::body, 0.5});
            }};
}

/// One column; entries without a sample are notes in small print.
void draw_legend(Canvas& canvas, const Vec2& corner, const std::vector<LegendEntry>& entries) {
    Vec2 at = corner + Vec2(0.0, 0.5 * legend_line);
    for (const LegendEntry& entry : entries) {
        if (entry.draw_sample) entry.draw_sample(canvas, at + Vec2(9.0, 0.0));
        const TextStyle& style = entry.draw_sample ? legend_style : note_style;
        const double indent = entry.draw_sample ? 25.0 : 0.0;
        canvas.text_within(column_width - indent, at + Vec2(indent, 0.0), entry.label, style);
        at.y() += legend_line;
    }
}

double legend_height(const std::vector<LegendEntry>& entries) {
    return legend_line * static_cast<double>(entries.size());
}

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
    const double width = body.upper.x() - body.lower.x();
    if (!(width > 0.0)) return;
    const auto [length, label] = round_length(0.4 * width);
    const double y = panel.corner.y() + panel.size().y() + 13.0;
    const double x = panel.place(body.lower).x();
    const double end = x + panel.scale * length;
    const Stroke stroke{ink::body, 1.2};
    canvas.segments({{{x, y}, {end, y}}, {{x, y - 3.0}, {x, y + 3.0}}, {{end, y - 3.0}, {end, y + 3.0}}}, stroke);
    canvas.text({end + 6.0, y}, label, {.size = 8.5, .down = Align::middle});
}

/// Places on the page of `n_panels` equal panels beside each other with a column to their right.
struct Layout {
    double scale = 1.0; ///< points per metre
    Vec2 panel_size = Vec2::Zero();
    double slot = 0.0; ///< width reserved for a panel
    int n_panels = 1;
    Vec2 page = Vec2::Zero();

    [[nodiscard]] Vec2 corner(int panel) const {
        const double height = page.y() - 2.0 * margin - title_height - panel_title_height - scale_bar_height;
        return {margin + panel * (slot + panel_gap) + 0.5 * (slot - panel_size.x()),
                margin + title_height + panel_title_height + 0.5 * (height - panel_size.y())};
    }
    [[nodiscard]] double column() const { return margin + n_panels * (slot + panel_gap); }
};

Layout layout_of(const Box& box, int n_panels, double column_height, const Vec2& largest) {
    Layout layout;
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

/// More pixels for more blocks, so that each gets a few.
double pixels_per_point(const BlockSystem& system, double scale) {
    constexpr double pixels_per_block = 5.0;
    return std::clamp(pixels_per_block / block_size_on_page(system, scale), 3.0, 6.0);
}

void draw_panel(Canvas& canvas, const Layout& layout, int index, const Box& box, const DrawnBody& body,
                const std::string& title) {
    const Panel panel{layout.corner(index), box, layout.scale};
    canvas.text({panel.place(body.system.lower).x(), panel.corner.y() - 8.0}, title, panel_style);
    draw_body(canvas, panel, body);
    if (index == 0) draw_scale_bar(canvas, panel, body.system);
}

bool has(const DrawnBody& body, InterfaceLook look) {
    return std::find(body.looks.begin(), body.looks.end(), look) != body.looks.end();
}

bool does(const DrawnBody& body, Motion motion) {
    return std::find(body.motions.begin(), body.motions.end(), motion) != body.motions.end();
}

LegendEntry open_entry() {
    return {"open fracture", [](Canvas& canvas, const Vec2& middle) {
                for (const double y : {-1.3, 1.3})
                    canvas.line(middle + Vec2(-9.0, y), middle + Vec2(9.0, y), {ink::fracture, 0.6});
            }};
}

std::string length_label(double metres) {
    if (metres >= 1.0) return fmt::format("{:.2g} m", metres);
    if (metres >= 0.01) return fmt::format("{:.2g} cm", 100.0 * metres);
    return fmt::format("{:.2g} mm", 1000.0 * metres);
}

/// Lines of samples in a legend do not become finer than can be seen there.
Stroke sample(InterfaceLook look) {
    if (look == InterfaceLook::bond) return {colour(0x000000, 0.5), 0.6};
    constexpr double block_size = 12.0;
    return stroke_of(look, block_size, 0.4);
}

std::vector<LegendEntry> interface_entries(const DrawnBody& before, const DrawnBody& after) {
    std::vector<LegendEntry> entries;
    const auto add = [&](InterfaceLook look, const char* label) {
        if (has(before, look) || has(after, look)) entries.push_back(line_entry(label, sample(look)));
    };
    add(InterfaceLook::mapped_fracture, "mapped fracture");
    add(InterfaceLook::mapped_bond, "mapped, still bonded");
    add(InterfaceLook::joint, "fracture of the net");
    add(InterfaceLook::bond, "potential crack");
    if (does(after, Motion::sliding))
        entries.push_back(line_entry("sliding fracture", stroke_of(Motion::sliding, 12.0, 0.3)));
    if (does(after, Motion::open)) entries.push_back(open_entry());
    add(InterfaceLook::tension_crack, "crack in tension");
    add(InterfaceLook::shear_crack, "crack in shear");
    const double largest = largest_movements(after).cracks;
    if (largest > 0.0) {
        entries.push_back({"thickness: opening and slip,", {}});
        entries.push_back({"thickest from " + length_label(largest), {}});
    }
    return entries;
}

/// Light tints for materials.
Colour material_colour(int material) {
    constexpr std::array tints{colour(0xF1ECDD), colour(0xD5E3E8), colour(0xE3DBE9),
                               colour(0xDDE8D3), colour(0xF3DCD2), colour(0xE0E0E0)};
    return tints[static_cast<std::size_t>(std::max(0, material)) % tints.size()];
}

std::string material_name(const BlocksPlot& plot, int material) {
    const auto index = static_cast<std::size_t>(std::max(0, material));
    return index < plot.material_names.size() ? plot.material_names[index] : fmt::format("material {}", material);
}

std::vector<LegendEntry> material_entries(const BlockSystem& system, const BlocksPlot& plot) {
    std::vector<int> materials;
    for (const Block& block : system.blocks) materials.push_back(block.material);
    std::sort(materials.begin(), materials.end());
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    std::vector<LegendEntry> entries;
    for (const int material : materials)
        entries.push_back(patch_entry(material_name(plot, material), material_colour(material)));
    return entries;
}

std::vector<double> major_stresses(const FieldRecord& fields) {
    std::vector<double> values;
    for (const Mat2& stress : fields.stress) values.push_back(principal_compression(stress).first / mega);
    return values;
}

void append(std::vector<LegendEntry>& entries, std::vector<LegendEntry> more) {
    for (LegendEntry& entry : more) entries.push_back(std::move(entry));
}

/// Edges of each boundary in its colour.
void draw_boundaries(Canvas& canvas, const Panel& panel, const BlockSystem& system) {
    for (std::size_t i = 0; i < system.boundaries.size(); ++i) {
        std::vector<std::pair<Vec2, Vec2>> segments;
        for (const auto& [block, edge] : system.boundaries[i].edges) {
            const Edge& side = system.blocks[block].edges[edge];
            segments.emplace_back(panel.place(edge_start(system, side)), panel.place(edge_end(system, side)));
        }
        canvas.segments(segments, {series_colour(i), 2.2, {}, true});
    }
}

std::vector<LegendEntry> boundary_entries(const BlockSystem& system) {
    std::vector<LegendEntry> entries;
    for (std::size_t i = 0; i < system.boundaries.size(); ++i)
        entries.push_back(line_entry(system.boundaries[i].name, {series_colour(i), 2.2}));
    return entries;
}

std::vector<LegendEntry> size_notes(const BlockSystem& system) {
    const Vec2 low = system.origin + system.lower;
    const Vec2 high = system.origin + system.upper;
    return {{fmt::format("x {:.7g} \u2026 {:.7g} m", low.x(), high.x()), {}},
            {fmt::format("y {:.7g} \u2026 {:.7g} m", low.y(), high.y()), {}}};
}

void refuse_large_svg(const BlockSystem& system, PictureFormat format) {
    if (format == PictureFormat::svg && system.n_blocks() > most_blocks_in_svg)
        throw InputError(fmt::format("an SVG picture of {} blocks would be too large (at most {}): take PNG",
                                     system.n_blocks(), most_blocks_in_svg));
}

} // namespace

std::string after_title(const std::vector<StepRecord>& history) {
    if (history.empty()) return "after";
    return fmt::format("after, axial strain {:.2f} %", 100.0 * history.back().axial_strain);
}

std::string draw_blocks(const BlockSystem& system, const FieldRecord& fields, const BlocksPlot& plot,
                        PictureFormat format) {
    refuse_large_svg(system, format);
    std::vector<bool> potential;
    for (const auto& interface : fields.interfaces) potential.push_back(interface.bonded || interface.broken);
    DrawnBody before = body_before(system, potential);
    DrawnBody after = body_after(system, fields, plot.magnification);
    const auto stresses = major_stresses(fields);
    const ColourScale scale = scale_for(stresses);
    before.colour = [&](int block) { return material_colour(system.blocks[block].material); };
    after.colour = [&](int block) { return scale(stresses[block]); };
    auto entries = interface_entries(before, after);
    append(entries, material_entries(system, plot));
    constexpr double bar_height = 190.0;
    constexpr double bar_gap = 24.0;
    const Box box = box_of(after);
    const Layout layout = layout_of(box, 2, bar_height + bar_gap + legend_height(entries), {360.0, 450.0});
    return draw_picture(
        format, layout.page.x(), layout.page.y(), pixels_per_point(system, layout.scale), [&](Canvas& canvas) {
            canvas.text_within(layout.page.x() - 2.0 * margin, {margin, margin + 10.0}, plot.title, title_style);
            draw_panel(canvas, layout, 0, box, before, "before");
            draw_panel(canvas, layout, 1, box, after, plot.after);
            const Vec2 corner(layout.column(), margin + title_height + panel_title_height);
            draw_colour_bar(canvas, scale, corner, {13.0, bar_height}, "major principal stress (MPa, compression +)");
            draw_legend(canvas, corner + Vec2(0.0, bar_height + bar_gap), entries);
        });
}

std::string draw_geometry(const BlockSystem& system, const BlocksPlot& plot, PictureFormat format) {
    refuse_large_svg(system, format);
    std::vector<bool> potential;
    for (const Interface& interface : system.interfaces) {
        const auto type = static_cast<std::size_t>(std::max(0, interface.interface_type));
        potential.push_back(type < plot.bonded_types.size() && plot.bonded_types[type]);
    }
    DrawnBody body = body_before(system, potential);
    body.colour = [&](int block) { return material_colour(system.blocks[block].material); };
    auto entries = interface_entries(body, body);
    append(entries, material_entries(system, plot));
    append(entries, boundary_entries(system));
    append(entries, size_notes(system));
    const Box box = box_of(body);
    const Layout layout = layout_of(box, 1, legend_height(entries), {620.0, 500.0});
    return draw_picture(
        format, layout.page.x(), layout.page.y(), pixels_per_point(system, layout.scale), [&](Canvas& canvas) {
            canvas.text_within(layout.page.x() - 2.0 * margin, {margin, margin + 10.0}, plot.title, title_style);
            draw_panel(canvas, layout, 0, box, body,
                       fmt::format("{} blocks, {} interfaces", system.n_blocks(), system.n_interfaces()));
            draw_boundaries(canvas, {layout.corner(0), box, layout.scale}, system);
            draw_legend(canvas, {layout.column(), margin + title_height + panel_title_height}, entries);
        });
}

void write_blocks(const std::filesystem::path& path, const BlockSystem& system, const FieldRecord& fields,
                  const BlocksPlot& plot) {
    write_file(path, draw_blocks(system, fields, plot, picture_format(path)));
}

void write_geometry(const std::filesystem::path& path, const BlockSystem& system, const BlocksPlot& plot) {
    write_file(path, draw_geometry(system, plot, picture_format(path)));
}

} // namespace kluft

#include "kluft/output/blocks_picture.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "body_drawing.hpp"
#include "body_page.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/units.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/block_outline.hpp"
#include "kluft/output/colour_scale.hpp"
#include "kluft/output/vtu.hpp"
#include "legend.hpp"

namespace kluft {

namespace {

LegendEntry patch_entry(std::string label, const Colour& fill) {
    return {std::move(label), [fill](Canvas& canvas, const Vec2& middle) {
                canvas.fill_rectangle(middle - Vec2(9.0, 4.5), {18.0, 9.0}, fill);
                canvas.stroke_rectangle(middle - Vec2(9.0, 4.5), {18.0, 9.0}, {ink::body, 0.5});
            }};
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

bool has_given_blocks(const DrawnBody& body) {
    return std::ranges::any_of(body.system.interfaces,
                               [](const Interface& each) { return each.origin == EdgeOrigin::given; });
}

std::vector<LegendEntry> interface_entries(const DrawnBody& before, const DrawnBody& after) {
    std::vector<LegendEntry> entries;
    const auto add = [&](InterfaceLook look, const char* label) {
        if (has(before, look) || has(after, look)) entries.push_back(line_entry(label, sample(look)));
    };
    add(InterfaceLook::mapped_fracture, "mapped fracture");
    add(InterfaceLook::mapped_bond, "mapped, still bonded");
    add(InterfaceLook::joint, has_given_blocks(before) ? "joint" : "fracture of the net");
    add(InterfaceLook::bond, "potential crack");
    if (does(after, Motion::sliding))
        entries.push_back(line_entry("sliding fracture", stroke_of(Motion::sliding, 12.0, 0.3)));
    if (does(after, Motion::open)) entries.push_back(open_entry());
    add(InterfaceLook::tension_crack, "crack in tension");
    add(InterfaceLook::shear_crack, "crack in shear");
    if (!after.platens.empty()) entries.push_back(line_entry("platen", {ink::platen, 2.4}));
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

/// What the fields of a block are made of: stresses positive in tension (Pa), displacement (m).
struct BlockValues {
    const Mat2& stress;
    double stress_zz;
    Vec2 displacement;
};

struct BlockFieldKind {
    std::string_view name;
    const char* label;
    double (*value)(const BlockValues&);
};
constexpr double milli = 1e-3;
constexpr std::array<BlockFieldKind, 9> block_field_kinds{{
    {"sigma_1", "major principal stress (MPa, compression +)",
     [](const BlockValues& at) { return principal_compression(at.stress).first / mega; }},
    {"sigma_3", "minor principal stress (MPa, compression +)",
     [](const BlockValues& at) { return principal_compression(at.stress).second / mega; }},
    {"stress_xx", "stress xx (MPa, compression +)", [](const BlockValues& at) { return -at.stress(0, 0) / mega; }},
    {"stress_yy", "stress yy (MPa, compression +)", [](const BlockValues& at) { return -at.stress(1, 1) / mega; }},
    {"stress_xy", "stress xy (MPa, compression +)",
     [](const BlockValues& at) { return -0.5 * (at.stress(0, 1) + at.stress(1, 0)) / mega; }},
    {"stress_zz", "stress zz (MPa, compression +)", [](const BlockValues& at) { return -at.stress_zz / mega; }},
    {"displacement", "displacement (mm)", [](const BlockValues& at) { return at.displacement.norm() / milli; }},
    {"displacement_x", "displacement x (mm)", [](const BlockValues& at) { return at.displacement.x() / milli; }},
    {"displacement_y", "displacement y (mm)", [](const BlockValues& at) { return at.displacement.y() / milli; }},
}};

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

/// Of the corners of a block (m); `first` from first_vertices.
Vec2 mean_displacement(const std::vector<std::size_t>& first, const std::vector<Vec2>& displacement, std::size_t b) {
    Vec2 mean = Vec2::Zero();
    for (std::size_t v = first[b]; v < first[b + 1]; ++v) mean += displacement[v];
    return mean / static_cast<double>(std::max<std::size_t>(1, first[b + 1] - first[b]));
}

// ---- what moves on --------------------------------------------------------------------------------------------------

constexpr Colour moving_ink = colour(0x8E24AA);
constexpr std::size_t most_arrows = 200;

/// From its tail to its head.
void draw_arrow(Canvas& canvas, const Vec2& tail, const Vec2& head) {
    const Vec2 along = (head - tail).normalized();
    const Vec2 across(-along.y(), along.x());
    const Vec2 neck = head - 6.0 * along;
    canvas.line(tail, neck, {colour(0xFFFFFF), 4.0});
    canvas.fill_polygon({{head + 1.5 * along, neck - along + 5.2 * across, neck - along - 5.2 * across}},
                        colour(0xFFFFFF));
    canvas.line(tail, neck, {moving_ink, 2.0});
    canvas.fill_polygon({{head, neck + 3.6 * across, neck - 3.6 * across}}, moving_ink);
}

/// Three quarters of a circle with a head; on the page, where y goes down.
void draw_turn(Canvas& canvas, const Vec2& centre, double radius, int turn) {
    constexpr double pi = std::numbers::pi;
    canvas.arc(centre, radius, 0.0, 1.5 * pi, {moving_ink, 2.0});
    const Vec2 end = turn > 0 ? Vec2(centre + Vec2(radius, 0.0)) : Vec2(centre + Vec2(0.0, -radius));
    const Vec2 along = turn > 0 ? Vec2(0.0, -1.0) : Vec2(1.0, 0.0);
    const Vec2 across(-along.y(), along.x());
    canvas.fill_polygon({{end + 5.0 * along, end + 3.6 * across, end - 3.6 * across}}, moving_ink);
}

/// -1 where the body has no such block.
int number_of(const BlockSystem& system, const std::string& name) {
    if (!system.block_names.empty()) {
        const auto found = std::ranges::find(system.block_names, name);
        return found == system.block_names.end() ? -1 : static_cast<int>(found - system.block_names.begin());
    }
    int number = -1;
    std::from_chars(name.data(), name.data() + name.size(), number);
    return number < system.n_blocks() ? number : -1;
}

/// The circle on the page that an arrow takes.
struct Mark {
    Vec2 centre;
    double radius = 0.0;

    [[nodiscard]] bool overlaps(const Mark& other) const {
        return (centre - other.centre).norm() < radius + other.radius;
    }
};

/// Of arrows that would overlap the one of the block furthest from balance is drawn: those of a small wedge of many cells hid it.
void draw_moving(Canvas& canvas, const Panel& panel, const DrawnBody& body, const std::vector<FallingBlock>& moving) {
    std::vector<Mark> marks;
    for (const FallingBlock& each : moving) {
        if (marks.size() == most_arrows) return;
        const int b = number_of(body.system, each.block);
        if (b < 0) continue;
        const Block& block = body.system.blocks[b];
        const Vec2 centre = panel.place(block.centroid + mean_displacement(body.first, body.displacement, b));
        const Vec2 within = centre - panel.corner;
        if (!((within.array() >= 0.0).all() && (within.array() <= panel.size().array()).all()))
            continue; // gone, or no number
        const double size = std::clamp(0.4 * std::sqrt(block.area) * panel.scale, 7.0, 22.0);
        const Mark mark{centre, size};
        if (std::ranges::any_of(marks, [&](const Mark& other) { return mark.overlaps(other); })) continue;
        marks.push_back(mark);
        const Vec2 way(each.direction.x(), -each.direction.y());
        if (way.norm() > 0.0) draw_arrow(canvas, centre - size * way, centre + size * way);
        if (way.norm() == 0.0 && each.turn != 0) draw_turn(canvas, centre, 0.7 * size, each.turn);
    }
}

std::vector<LegendEntry> moving_entry(const std::vector<FallingBlock>& moving) {
    if (moving.empty()) return {};
    const auto arrow = [](Canvas& canvas, const Vec2& middle) {
        draw_arrow(canvas, middle - Vec2(9.0, 0.0), middle + Vec2(9.0, 0.0));
    };
    std::vector<LegendEntry> entries{{"moves on beyond this state", arrow}};
    if (moving.size() > 1) entries.push_back({"arrows that would overlap are left out", {}});
    return entries;
}

std::vector<LegendEntry> outside_note(int n) {
    if (n == 0) return {};
    return {{fmt::format("{} {} outside the picture", n, n == 1 ? "block" : "blocks"), {}}};
}

} // namespace

std::string after_title(const std::vector<StepRecord>& history, bool moves_platen,
                        const std::optional<RunSummary>& summary) {
    if (summary && summary->results.factor_of_safety)
        return "after, " + factor_in_words(summary->reduced_alone, *summary->results.factor_of_safety,
                                           summary->results.undoubted_factor, 4);
    if (history.empty() || !moves_platen) return "after";
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
    append(entries, moving_entry(plot.moving));
    append(entries, material_entries(system, plot));
    constexpr double bar_height = 190.0;
    constexpr double bar_gap = 24.0;
    const Box box = box_of(after);
    append(entries, outside_note(count_outside(box, after)));
    const PageLayout layout = page_layout(box, 2, bar_height + bar_gap + column_height(entries), {360.0, 450.0});
    return draw_picture(
        format, layout.page.x(), layout.page.y(), body_pixels_per_point(system, layout.scale), [&](Canvas& canvas) {
            draw_title(canvas, layout, plot.title);
            draw_panel(canvas, layout, 0, box, before, "before");
            draw_panel(canvas, layout, 1, box, after, plot.after);
            draw_moving(canvas, {layout.corner(1), box, layout.scale}, after, plot.moving);
            const Vec2 corner = layout.column_corner();
            draw_colour_bar(canvas, scale, corner, {13.0, bar_height}, "major principal stress (MPa, compression +)");
            draw_column(canvas, corner + Vec2(0.0, bar_height + bar_gap), entries);
        });
}

std::vector<std::string> block_field_names() {
    std::vector<std::string> names;
    for (const BlockFieldKind& kind : block_field_kinds) names.emplace_back(kind.name);
    return names;
}

ColouredField block_field(const BlockSystem& system, const FieldRecord& fields, const std::string& name) {
    const auto kind = std::ranges::find(block_field_kinds, name, &BlockFieldKind::name);
    if (kind == block_field_kinds.end())
        throw InputError(fmt::format("--field: expected one of {}, found '{}'{}", listed(block_field_names()), name,
                                     suggestion(name, block_field_names())));
    ColouredField field{kind->label, {}};
    const auto first = first_vertices(system);
    for (std::size_t b = 0; b < system.blocks.size(); ++b) {
        const Vec2 mean = mean_displacement(first, fields.displacement, b);
        field.values.push_back(kind->value({fields.stress[b], fields.stress_zz[b], mean}));
    }
    return field;
}

std::string draw_state(const BlockSystem& system, const FieldRecord& fields, const StatePlot& plot,
                       PictureFormat format) {
    refuse_large_svg(system, format);
    DrawnBody body = body_after(system, fields, plot.magnification);
    const ColourScale scale = scale_for(plot.field.values);
    body.colour = [&](int block) { return scale(plot.field.values[block]); };
    const Box box = plot.window.value_or(box_of(body));
    const int n_outside = count_outside(box, body);
    if (n_outside == system.n_blocks()) throw InputError("--window: expected a part of the body, found no block in it");
    auto entries = interface_entries(body, body);
    if (!plot.window) append(entries, outside_note(n_outside));
    constexpr double bar_height = 190.0;
    constexpr double bar_gap = 24.0;
    const PageLayout layout = page_layout(box, 1, bar_height + bar_gap + column_height(entries), {560.0, 520.0});
    return draw_picture(format, layout.page.x(), layout.page.y(), body_pixels_per_point(system, layout.scale),
                        [&](Canvas& canvas) {
                            draw_title(canvas, layout, plot.title);
                            draw_panel(canvas, layout, 0, box, body, plot.heading);
                            const Vec2 corner = layout.column_corner();
                            draw_colour_bar(canvas, scale, corner, {13.0, bar_height}, plot.field.label);
                            draw_column(canvas, corner + Vec2(0.0, bar_height + bar_gap), entries);
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
    const PageLayout layout = page_layout(box, 1, column_height(entries), {620.0, 500.0});
    return draw_picture(
        format, layout.page.x(), layout.page.y(), body_pixels_per_point(system, layout.scale), [&](Canvas& canvas) {
            draw_title(canvas, layout, plot.title);
            draw_panel(canvas, layout, 0, box, body,
                       fmt::format("{} blocks, {} interfaces", system.n_blocks(), system.n_interfaces()));
            draw_boundaries(canvas, {layout.corner(0), box, layout.scale}, system);
            draw_column(canvas, layout.column_corner(), entries);
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

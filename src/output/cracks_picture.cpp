#include "kluft/output/cracks_picture.hpp"

#include <algorithm>
#include <utility>

#include "body_drawing.hpp"
#include "body_page.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace {

constexpr Colour block_fill = colour(0xF6F5F1);
const Colour mapped = colour(0x9A9A9A);

/// All interfaces drawn as nothing but outlines of blocks.
DrawnBody light_body(const BlockSystem& system) {
    DrawnBody body = body_before(system, std::vector<bool>(system.interfaces.size(), true));
    std::fill(body.looks.begin(), body.looks.end(), InterfaceLook::bond);
    body.colour = [](int) { return block_fill; };
    return body;
}

Box box_with_cracks(const BlockSystem& system, const CracksPlot& plot) {
    Box box{system.lower, system.upper};
    for (const CrackGroup& group : plot.groups)
        for (const DrawnCrack& crack : group.cracks)
            for (const Vec2& end : {crack.start, crack.end}) {
                box.lower = box.lower.cwiseMin(end - system.origin);
                box.upper = box.upper.cwiseMax(end - system.origin);
            }
    return box;
}

void draw_mapped_fractures(Canvas& canvas, const Panel& panel, const BlockSystem& system, double width) {
    std::vector<std::pair<Vec2, Vec2>> segments;
    for (const Interface& interface : system.interfaces) {
        if (interface.fracture < 0) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        segments.emplace_back(panel.place(edge_start(system, edge)), panel.place(edge_end(system, edge)));
    }
    canvas.segments(segments, {mapped, width, {}, true});
}

/// Which side is which does not depend on the direction of the line: -1 is on the left, of level lines above.
Vec2 normal_on_page(const Vec2& along) {
    if (!(along.norm() > 0.0)) return Vec2::UnitX();
    const Vec2 normal = right_normal(along).normalized();
    constexpr double level = 1e-6;
    const bool turned = normal.x() < -level || (normal.x() < level && normal.y() < 0.0);
    return turned ? Vec2(-normal) : normal;
}

void draw_group(Canvas& canvas, const Panel& panel, const Vec2& origin, const CrackGroup& group, double width) {
    std::vector<std::pair<Vec2, Vec2>> segments;
    for (const DrawnCrack& crack : group.cracks) {
        Vec2 from = panel.place(crack.start - origin);
        Vec2 to = panel.place(crack.end - origin);
        const Vec2 aside = 0.5 * width * crack.side * normal_on_page(to - from);
        from += aside;
        to += aside;
        if (crack.start == crack.end) {
            canvas.circle(from, 1.3 * width, group.colour, {group.colour, 0.2});
        } else {
            segments.emplace_back(from, to);
        }
    }
    canvas.segments(segments, {group.colour, width});
}

std::vector<LegendEntry> entries_of(const BlockSystem& system, const CracksPlot& plot) {
    std::vector<LegendEntry> entries;
    for (const CrackGroup& group : plot.groups) {
        if (group.label.empty()) continue;
        entries.push_back(line_entry(group.label, {group.colour, 2.4}));
        if (!group.note.empty()) entries.push_back({group.note, {}});
    }
    const bool any_mapped = std::any_of(system.interfaces.begin(), system.interfaces.end(),
                                        [](const Interface& interface) { return interface.fracture >= 0; });
    if (any_mapped) entries.push_back(line_entry("mapped fracture", {mapped, 1.0}));
    for (const std::string& note : plot.notes) entries.push_back({note, {}});
    return entries;
}

} // namespace

std::string draw_cracks(const BlockSystem& system, const CracksPlot& plot, PictureFormat format) {
    refuse_large_svg(system, format);
    const DrawnBody body = light_body(system);
    const auto entries = entries_of(system, plot);
    const Box box = box_with_cracks(system, plot);
    const PageLayout layout = page_layout(box, 1, column_height(entries), {620.0, 500.0});
    const double block_size = block_size_on_page(system, layout.scale);
    const double width = std::clamp(0.11 * block_size, 0.3, 2.4);
    return draw_picture(format, layout.page.x(), layout.page.y(), body_pixels_per_point(system, layout.scale),
                        [&](Canvas& canvas) {
                            draw_title(canvas, layout, plot.title);
                            draw_panel(canvas, layout, 0, box, body, plot.heading);
                            const Panel panel{layout.corner(0), box, layout.scale};
                            draw_mapped_fractures(canvas, panel, system, std::clamp(0.08 * block_size, 0.3, 1.2));
                            for (const CrackGroup& group : plot.groups)
                                draw_group(canvas, panel, system.origin, group, width);
                            draw_column(canvas, layout.column_corner(), entries);
                        });
}

void write_cracks(const std::filesystem::path& path, const BlockSystem& system, const CracksPlot& plot) {
    write_file(path, draw_cracks(system, plot, picture_format(path)));
}

} // namespace kluft

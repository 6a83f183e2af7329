#include "body_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kluft/output/block_outline.hpp"

namespace kluft {

namespace {

using Segments = std::vector<std::pair<Vec2, Vec2>>;

constexpr int n_widths = 5; ///< classes of line width by movement

bool is_crack(InterfaceLook look) { return look == InterfaceLook::tension_crack || look == InterfaceLook::shear_crack; }

InterfaceLook look_before(const Interface& interface, bool potential) {
    const bool mapped = interface.fracture >= 0;
    if (potential) return mapped ? InterfaceLook::mapped_bond : InterfaceLook::bond;
    return mapped ? InterfaceLook::mapped_fracture : InterfaceLook::joint;
}

InterfaceLook look_after(const Interface& interface, const FieldRecord::InterfaceFields& fields) {
    if (fields.broken)
        return fields.mode == CrackMode::tension ? InterfaceLook::tension_crack : InterfaceLook::shear_crack;
    return look_before(interface, fields.bonded);
}

double movement_of(const FieldRecord::InterfaceFields& fields) {
    if (fields.bonded) return 0.0;
    const double movement = std::hypot(std::max(0.0, fields.gap), fields.slip);
    return std::isfinite(movement) ? movement : 0.0;
}

Motion motion_of(const FieldRecord::InterfaceFields& fields) {
    if (fields.bonded || fields.broken || fields.state == ContactState::locked) return Motion::none;
    return fields.state == ContactState::open ? Motion::open : Motion::sliding;
}

/// Current places of the vertices of each loop of a block, on the page.
std::vector<std::vector<Vec2>> loops_on_page(const Panel& panel, const DrawnBody& body, int index) {
    const Block& block = body.system.blocks[index];
    std::vector<std::vector<Vec2>> loops;
    for (const auto& [begin, end] : loop_ranges(block)) {
        std::vector<Vec2>& loop = loops.emplace_back();
        for (int edge = begin; edge < end; ++edge)
            loop.push_back(
                panel.place(edge_start(body.system, block.edges[edge]) + body.displacement[body.first[index] + edge]));
    }
    return loops;
}

void draw_blocks_of(Canvas& canvas, const Panel& panel, const DrawnBody& body, double block_size) {
    constexpr double smallest_outlined = 1.0; // points
    const Stroke outline{ink::block, std::clamp(0.03 * block_size, 0.04, 0.4)};
    for (int i = 0; i < body.system.n_blocks(); ++i) {
        const auto loops = loops_on_page(panel, body, i);
        canvas.fill_polygon(loops, body.colour(i));
        if (block_size > smallest_outlined) canvas.stroke_polygon(loops, outline);
    }
}

/// The two sides of an interface on the page, and the line midway between them.
struct InterfaceLines {
    std::pair<Vec2, Vec2> side_a, side_b, middle;
};

InterfaceLines lines_of(const Panel& panel, const DrawnBody& body, int index) {
    const Interface& interface = body.system.interfaces[index];
    const Edge& edge = body.system.blocks[interface.block_a].edges[interface.edge_a];
    const Vec2& start = edge_start(body.system, edge);
    const Vec2& end = edge_end(body.system, edge);
    const InterfaceMotion u = interface_motion(body.system, body.first, body.displacement, interface);
    InterfaceLines lines;
    lines.side_a = {panel.place(start + u.start_a), panel.place(end + u.end_a)};
    lines.side_b = {panel.place(start + u.start_b), panel.place(end + u.end_b)};
    lines.middle = {0.5 * (lines.side_a.first + lines.side_b.first), 0.5 * (lines.side_a.second + lines.side_b.second)};
    return lines;
}

/// The value that one in twenty exceeds.
double nearly_largest(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    constexpr double share = 0.95;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

int width_class(double movement, double largest) {
    if (largest <= 0.0) return 0;
    return std::min(n_widths - 1, static_cast<int>(std::min(1.0, movement / largest) * n_widths));
}

double share_of(int width) { return static_cast<double>(width) / (n_widths - 1); }

void draw_motions(Canvas& canvas, const Panel& panel, const DrawnBody& body, double block_size, double largest,
                  Motion motion) {
    std::array<Segments, n_widths> segments;
    for (int i = 0; i < body.system.n_interfaces(); ++i)
        if (body.motions[i] == motion)
            segments[width_class(body.movement[i], largest)].push_back(lines_of(panel, body, i).middle);
    for (int width = 0; width < n_widths; ++width)
        canvas.segments(segments[width], stroke_of(motion, block_size, share_of(width)));
}

void draw_interfaces(Canvas& canvas, const Panel& panel, const DrawnBody& body, double block_size, double largest,
                     InterfaceLook look) {
    std::array<Segments, n_widths> segments;
    for (int i = 0; i < body.system.n_interfaces(); ++i) {
        if (body.looks[i] != look) continue;
        const InterfaceLines lines = lines_of(panel, body, i);
        if (is_crack(look)) {
            segments[width_class(body.movement[i], largest)].push_back(lines.middle);
        } else {
            segments[0].push_back(lines.side_a);
            if (look != InterfaceLook::mapped_bond) segments[0].push_back(lines.side_b);
        }
    }
    for (int width = 0; width < n_widths; ++width)
        canvas.segments(segments[width], stroke_of(look, block_size, share_of(width)));
}

void draw_boundary(Canvas& canvas, const Panel& panel, const DrawnBody& body) {
    Segments segments;
    for (int i = 0; i < body.system.n_blocks(); ++i) {
        const Block& block = body.system.blocks[i];
        for (int e = 0; e < static_cast<int>(block.edges.size()); ++e) {
            const Edge& edge = block.edges[e];
            if (edge.interface >= 0) continue;
            segments.emplace_back(
                panel.place(edge_start(body.system, edge) + body.displacement[body.first[i] + e]),
                panel.place(edge_end(body.system, edge) + body.displacement[body.first[i] + next_edge(block, e)]));
        }
    }
    canvas.segments(segments, {ink::body, 0.8, {}, true});
}

/// A bar along the face, on the outside.
void draw_platens(Canvas& canvas, const Panel& panel, const DrawnBody& body) {
    constexpr double thickness = 2.4;
    Segments segments;
    for (const PlatenFace& face : body.platens) {
        const Vec2 shift = face.displacement + 0.5 * thickness / panel.scale * face.outward;
        segments.emplace_back(panel.place(face.start + shift), panel.place(face.end + shift));
    }
    canvas.segments(segments, {ink::platen, thickness});
}

} // namespace

DrawnBody body_before(const BlockSystem& system, const std::vector<bool>& potential) {
    DrawnBody body{system, first_vertices(system), {}, {}, {}, {}, {}, {}};
    body.displacement.assign(body.first.back(), Vec2::Zero());
    for (int i = 0; i < system.n_interfaces(); ++i)
        body.looks.push_back(look_before(system.interfaces[i], potential[i]));
    body.movement.assign(system.interfaces.size(), 0.0);
    body.motions.assign(system.interfaces.size(), Motion::none);
    return body;
}

DrawnBody body_after(const BlockSystem& system, const FieldRecord& fields, double magnification) {
    DrawnBody body{system, first_vertices(system), {}, {}, {}, {}, {}, {}};
    for (const Vec2& u : fields.displacement)
        body.displacement.push_back(u.allFinite() ? Vec2(magnification * u) : Vec2::Zero());
    for (int i = 0; i < system.n_interfaces(); ++i) {
        const auto& interface = fields.interfaces[i];
        body.looks.push_back(look_after(system.interfaces[i], interface));
        body.movement.push_back(movement_of(interface));
        body.motions.push_back(motion_of(interface));
    }
    body.platens = fields.platens;
    for (PlatenFace& face : body.platens) face.displacement *= magnification;
    return body;
}

Box box_of(const DrawnBody& body) {
    const Vec2 margin = 0.2 * (body.system.upper - body.system.lower);
    const Vec2 lowest = body.system.lower - margin;
    const Vec2 highest = body.system.upper + margin;
    Box box{body.system.lower, body.system.upper};
    for (int i = 0; i < body.system.n_blocks(); ++i)
        for (std::size_t e = 0; e < body.system.blocks[i].edges.size(); ++e) {
            const Vec2 x =
                edge_start(body.system, body.system.blocks[i].edges[e]) + body.displacement[body.first[i] + e];
            box.lower = box.lower.cwiseMin(x).cwiseMax(lowest);
            box.upper = box.upper.cwiseMax(x).cwiseMin(highest);
        }
    return box;
}

int count_outside(const Box& box, const DrawnBody& body) {
    int n = 0;
    for (int i = 0; i < body.system.n_blocks(); ++i) {
        const Block& block = body.system.blocks[i];
        Vec2 lowest = Vec2::Constant(std::numeric_limits<double>::infinity());
        Vec2 highest = -lowest;
        for (std::size_t e = 0; e < block.edges.size(); ++e) {
            const Vec2 x = edge_start(body.system, block.edges[e]) + body.displacement[body.first[i] + e];
            lowest = lowest.cwiseMin(x);
            highest = highest.cwiseMax(x);
        }
        const bool touches =
            (lowest.array() <= box.upper.array()).all() && (highest.array() >= box.lower.array()).all();
        if (!touches) ++n;
    }
    return n;
}

LargestMovements largest_movements(const DrawnBody& body) {
    std::vector<double> cracks, sliding;
    for (int i = 0; i < body.system.n_interfaces(); ++i) {
        if (is_crack(body.looks[i]))
            cracks.push_back(body.movement[i]);
        else if (body.motions[i] == Motion::sliding)
            sliding.push_back(body.movement[i]);
    }
    return {nearly_largest(cracks), nearly_largest(sliding)};
}

double block_size_on_page(const BlockSystem& system, double scale) {
    double area = 0.0;
    for (const Block& block : system.blocks) area += block.area;
    return scale * std::sqrt(area / std::max(1, system.n_blocks()));
}

Stroke stroke_of(InterfaceLook look, double block_size, double share) {
    const double fine = std::clamp(0.05 * block_size, 0.08, 0.6);
    const double crack = std::clamp(0.09 * block_size, 0.15, 1.1) * (1.0 + 2.0 * share);
    switch (look) {
    case InterfaceLook::bond:
        return {ink::block, 0.5 * fine};
    case InterfaceLook::mapped_bond:
        return {ink::fracture, 1.6 * fine, {3.0, 2.0}};
    case InterfaceLook::joint:
        return {colour(0x1A1A1A, 0.75), fine, {}, true};
    case InterfaceLook::mapped_fracture:
        return {ink::fracture, std::clamp(2.0 * fine, 0.5, 1.2), {}, true};
    case InterfaceLook::tension_crack:
        return {ink::tension, crack, {}, true};
    case InterfaceLook::shear_crack:
        return {ink::shear, crack, {}, true};
    }
    return {};
}

Stroke stroke_of(Motion motion, double block_size, double share) {
    const double width = std::clamp(0.12 * block_size, 0.3, 1.8) * (1.0 + 1.5 * share);
    return {motion == Motion::open ? ink::open : ink::sliding, motion == Motion::none ? 0.0 : width, {}, true};
}

void draw_body(Canvas& canvas, const Panel& panel, const DrawnBody& body) {
    const double block_size = block_size_on_page(body.system, panel.scale);
    const LargestMovements largest = largest_movements(body);
    const Vec2 margin(3.0, 3.0); // lines on the outline keep their width
    canvas.begin_clip(panel.corner - margin, panel.size() + 2.0 * margin);
    draw_blocks_of(canvas, panel, body, block_size);
    draw_boundary(canvas, panel, body);
    draw_platens(canvas, panel, body);
    draw_motions(canvas, panel, body, block_size, largest.sliding, Motion::open);
    draw_motions(canvas, panel, body, block_size, largest.sliding, Motion::sliding);
    for (const InterfaceLook look : {InterfaceLook::joint, InterfaceLook::mapped_bond, InterfaceLook::mapped_fracture,
                                     InterfaceLook::shear_crack, InterfaceLook::tension_crack})
        draw_interfaces(canvas, panel, body, block_size, largest.cracks, look);
    canvas.end_clip();
}

} // namespace kluft

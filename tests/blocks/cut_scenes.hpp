// Small bodies to cut, and what the tests ask of the cut.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "kluft/blocks/block_check.hpp"
#include "kluft/blocks/block_cutter.hpp"
#include "kluft/blocks/hexagon_lattice.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft::cut_scenes {

inline GeometrySpec rectangle(double width, double height) {
    GeometrySpec spec;
    spec.domain = {{0, 0}, {width, 0}, {width, height}, {0, height}};
    spec.boundaries = {{"bottom", {0}}, {"right", {1}}, {"top", {2}}, {"left", {3}}};
    return spec;
}

inline void add_trace(GeometrySpec& spec, std::vector<Vec2> points, int interface_type = 0) {
    spec.fractures.push_back({std::move(points), interface_type, ""});
}

/// The whole plane.
inline bool everywhere(const Vec2&) { return true; }

/// Uniform numbers that are the same with every standard library.
class Uniform {
public:
    explicit Uniform(std::uint64_t seed) : random_(seed) {}
    double operator()() { return static_cast<double>(random_() >> 11U) * 0x1.0p-53; }
    double operator()(double from, double to) { return from + (to - from) * (*this)(); }

private:
    std::mt19937_64 random_;
};

/// Straight traces across [-0.1, 1.1] width x [-0.1, 1.1] height.
inline void add_random_traces(GeometrySpec& spec, int count, double width, double height, Uniform& uniform) {
    const auto point = [&] { return Vec2(uniform(-0.1, 1.1) * width, uniform(-0.1, 1.1) * height); };
    for (int i = 0; i < count; ++i) {
        const Vec2 a = point();
        add_trace(spec, {a, point()});
    }
}

inline double domain_area(const GeometrySpec& spec) {
    const auto area = [&spec](Polygon polygon) {
        const Vec2 from = bounding_box(spec.domain).lower;
        for (Vec2& p : polygon) p -= from;
        return std::abs(signed_area(polygon));
    };
    double total = area(spec.domain);
    for (const Polygon& hole : spec.holes) total -= area(hole);
    return total;
}

/// What is wrong with a cut, as one text; empty for a sound one.
inline std::string faults(const GeometrySpec& spec, const CutBody& body) {
    PartitionExpectation expected;
    expected.domain_area = domain_area(spec);
    for (const auto& piece : body.report.taken_off) expected.domain_area -= piece.area;
    const bool triangles = spec.tessellation && spec.tessellation->triangles; // which have no smallest area
    expected.minimum_area = body.system.n_blocks() > 1 && !triangles
                                ? minimum_area_share(spec) *
                                      std::min(hexagon_area(lattice_spacing(spec)), std::abs(signed_area(spec.domain)))
                                : 0.0;
    std::string text;
    for (const std::string& sentence : check_block_system(body.system, expected)) text += sentence + '\n';
    const auto expect_corners = [&](const Polygon& polygon) {
        const auto& vertices = body.system.vertices;
        for (const Vec2& corner : polygon) {
            const Vec2 local = corner - body.system.origin;
            const bool is_taken_off = std::ranges::any_of(body.report.taken_off, [&](const auto& piece) {
                return (piece.at - corner).norm() < lattice_spacing(spec); // half of the largest perimeter
            });
            if (!is_taken_off && std::find(vertices.begin(), vertices.end(), local) == vertices.end())
                text += "a corner has moved\n";
        }
    };
    expect_corners(spec.domain);
    for (const Polygon& hole : spec.holes) expect_corners(hole);
    return text;
}

inline std::vector<double> sorted_areas(const BlockSystem& system) {
    std::vector<double> areas;
    for (const Block& block : system.blocks) areas.push_back(block.area);
    std::sort(areas.begin(), areas.end());
    return areas;
}

inline double boundary_length(const BlockSystem& system, const Boundary& boundary) {
    double length = 0.0;
    for (const BoundaryEdge& at : boundary.edges) {
        const Edge& edge = system.blocks[at.block].edges[at.edge];
        length += (edge_end(system, edge) - edge_start(system, edge)).norm();
    }
    return length;
}

/// Total length of the interfaces with an origin, and with a fracture unless that is -1.
inline double interface_length(const BlockSystem& system, EdgeOrigin origin, int fracture = -1) {
    double length = 0.0;
    for (const Interface& joint : system.interfaces) {
        if (joint.origin != origin || (fracture >= 0 && joint.fracture != fracture)) continue;
        const Edge& edge = system.blocks[joint.block_a].edges[joint.edge_a];
        length += (edge_end(system, edge) - edge_start(system, edge)).norm();
    }
    return length;
}

/// Whether two systems are equal in every bit but the origin.
inline bool same_blocks(const BlockSystem& a, const BlockSystem& b) {
    const auto same_edge = [](const Edge& e, const Edge& f) {
        return e.start == f.start && e.end == f.end && e.interface == f.interface && e.boundary == f.boundary;
    };
    const auto same_block = [&](const Block& p, const Block& q) {
        return p.loop_starts == q.loop_starts && p.area == q.area && p.centroid == q.centroid &&
               p.material == q.material &&
               std::equal(p.edges.begin(), p.edges.end(), q.edges.begin(), q.edges.end(), same_edge);
    };
    const auto same_joint = [](const Interface& p, const Interface& q) {
        return p.block_a == q.block_a && p.edge_a == q.edge_a && p.block_b == q.block_b && p.edge_b == q.edge_b &&
               p.origin == q.origin && p.fracture == q.fracture && p.interface_type == q.interface_type &&
               p.spacing == q.spacing;
    };
    return a.vertices == b.vertices &&
           std::equal(a.blocks.begin(), a.blocks.end(), b.blocks.begin(), b.blocks.end(), same_block) &&
           std::equal(a.interfaces.begin(), a.interfaces.end(), b.interfaces.begin(), b.interfaces.end(), same_joint);
}

} // namespace kluft::cut_scenes

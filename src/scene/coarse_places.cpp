#include "kluft/scene/coarse_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"
#include "kluft/scene/body_lines.hpp"

namespace kluft {

namespace {

constexpr std::size_t most_holes_told = 3; ///< holes
constexpr double of_radius = 0.15;         ///< of a circle as large: 13 % too late with triangles (docs/accuracy.md)
constexpr double rounding = 1e-9;          ///< of a length: of two that are as short the first is told
constexpr double fewest_in_a_bridge = 4.0; ///< cells: 13 % too strong with triangles (docs/accuracy.md)

/// Of the net at a place (m), `graded`: of triangles along what lies there, 0 where the scene gives none.
double spacing_at(const Vec2& place, double graded, const GeometrySpec& geometry) {
    double spacing = lattice_spacing(geometry);
    if (!geometry.tessellation->triangles) return spacing;
    const TriangleGrading& grading = geometry.tessellation->triangles->grading;
    if (graded > 0.0) spacing = std::min(spacing, graded);
    if (!grading.region.empty() && contains(grading.region, place)) spacing = std::min(spacing, grading.region_spacing);
    return spacing;
}

TriangleGrading grading_of(const GeometrySpec& geometry) {
    return geometry.tessellation->triangles ? geometry.tessellation->triangles->grading : TriangleGrading{};
}

/// What a criterion of mean stresses sees of the stress at a wall falls with the size of the blocks there.
std::vector<std::string> coarse_openings(const GeometrySpec& geometry) {
    std::vector<std::string> warnings;
    for (std::size_t k = 0; k < geometry.holes.size(); ++k) {
        const double radius = std::sqrt(std::abs(signed_area(geometry.holes[k])) / std::numbers::pi);
        const double spacing = spacing_at(geometry.holes[k].front(), grading_of(geometry).openings, geometry);
        if (spacing <= of_radius * radius) continue;
        if (warnings.size() == most_holes_told) {
            warnings.push_back(fmt::format("{}: and more holes like this", geometry.places.domain));
            break;
        }
        warnings.push_back(fmt::format(
            "{}: the net at hole {} has a spacing of {:.3g} m, {:.2g} of the hole's radius: first cracks beside it "
            "come late, "
            "with triangles at loads 13 % too high at 0.15 of the radius and 28 % at 0.3, with other cells later; "
            "geometry.tessellation.triangles.grading.openings makes the net finer there",
            geometry.places.domain, k, spacing, spacing / radius));
    }
    return warnings;
}

/// Whether a point of the body's outline lies on that hole, `off` of the sides at most.
bool is_on_hole(const Polygon& hole, const Box& box, const Vec2& p, double off) {
    if ((p.array() < box.lower.array() - off).any() || (p.array() > box.upper.array() + off).any()) return false;
    for (std::size_t i = 0; i < hole.size(); ++i)
        if (distance_to_segment(p, hole[i], hole[(i + 1) % hole.size()]) <= off) return true;
    return false;
}

/// Of the hole's edge that each block has (m).
std::vector<double> lengths_on_hole(const Polygon& hole, const BlockSystem& system, double resolution) {
    const Box box = bounding_box(hole);
    const double off = resolution + rounding * (box.upper - box.lower).norm();
    std::vector<double> lengths;
    for (const Block& block : system.blocks) {
        double length = 0.0;
        for (const Edge& edge : block.edges) {
            if (edge.interface >= 0) continue;
            const Vec2 start = edge_start(system, edge), end = edge_end(system, edge);
            if (is_on_hole(hole, box, system.origin + 0.5 * (start + end), off)) length += (end - start).norm();
        }
        lengths.push_back(length);
    }
    return lengths;
}

struct LargestAtHole {
    int block =
        -1; ///< that has the most of the hole's edge among those with one strain for all that happens around it; -1: none
    double share = 0.0; ///< of the hole's edge
};

LargestAtHole largest_at(const Polygon& hole, const BlockSystem& system, double resolution) {
    constexpr double much_of_edge = 1.0 / 3.0;
    constexpr double little_of_edge = 0.1; // of a block that is larger than the hole
    const std::vector<double> lengths = lengths_on_hole(hole, system, resolution);
    const double all = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    const double area = std::abs(signed_area(hole));
    LargestAtHole largest;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[static_cast<std::size_t>(b)];
        const double share = all > 0.0 ? lengths[static_cast<std::size_t>(b)] / all : 0.0;
        const bool is_large = share > much_of_edge || (share > little_of_edge && block.area > area);
        if (is_large && !block.fixed && share > largest.share) largest = {b, share};
    }
    return largest;
}

bool is_in_net(const Vec2& p, const GeometrySpec& geometry) {
    const std::optional<Polygon>& region = geometry.tessellation->region;
    return is_in_body(p, geometry) && (!region || contains(*region, p));
}

/// Cells of the net along a bridge: sides grow from both of its ends until they are the spacing.
double cells_along(const Vec2& end, const BodyLine& other, double length, const GeometrySpec& geometry) {
    constexpr int n_parts = 64;
    const TriangleGrading grading = grading_of(geometry);
    const double widest = spacing_at(end, 0.0, geometry);
    const double here = spacing_at(end, grading.fractures, geometry);
    const double there = spacing_at(end, other.graded, geometry);
    double n = 0.0;
    for (int i = 0; i < n_parts; ++i) {
        const double s = (i + 0.5) / n_parts * length;
        n += length / n_parts / std::min({widest, here + grading.growth * s, there + grading.growth * (length - s)});
    }
    return n;
}

std::string number_of_cells(double n) { return n < 1.0 ? "less than one cell" : fmt::format("{:.2g} cells", n); }

std::string more_of_them(std::size_t n) {
    if (n == 0) return "";
    return n == 1 ? " (and fewer than four along one more)" : fmt::format(" (and fewer than four along {} more)", n);
}

/// A narrow place holds as long as the mean stress of the few blocks in it is below their strength.
std::vector<std::string> coarse_bridges(const GeometrySpec& geometry, const CutReport& report,
                                        const std::vector<InterfaceType>& types) {
    const LineSearch search(body_lines(geometry, report, types), report.resolution);
    std::set<std::pair<int, int>> bridges; // of two lines each
    double fewest = std::numeric_limits<double>::infinity();
    std::string of_fewest;
    for (int k = 0; k < static_cast<int>(geometry.fractures.size()); ++k) {
        const std::vector<Vec2>& points = search.line(k).points;
        if (!search.line(k).is_open || points.empty()) continue;
        if ((points.front() - points.back()).norm() <= report.resolution) continue; // closed: it has no end
        for (const Vec2& end : {points.front(), points.back()}) {
            if (!is_in_net(end, geometry)) continue;
            const auto bridge = search.bridge_at(end, k, fewest_in_a_bridge * spacing_at(end, 0.0, geometry));
            if (!bridge) continue;
            const double n = cells_along(end, search.line(bridge->line), bridge->length, geometry);
            if (n >= fewest_in_a_bridge) continue;
            bridges.emplace(std::minmax(k, bridge->line));
            if (n >= fewest * (1.0 - rounding)) continue;
            fewest = n;
            const FractureTrace& trace = geometry.fractures[static_cast<std::size_t>(k)];
            of_fewest = fmt::format("{}: {} ends at {}, {:.3g} m before {}", trace.place, trace.name, place_text(end),
                                    bridge->length, search.line(bridge->line).name);
        }
    }
    if (bridges.empty()) return {};
    return {fmt::format(
        "{}, with {} of the net along this rock bridge{}: bridges of so few are too strong, of triangles by 64 % with "
        "one, 38 % with two and 13 % with four; {} makes the net finer there",
        of_fewest, number_of_cells(fewest), more_of_them(bridges.size() - 1),
        geometry.tessellation->triangles ? "geometry.tessellation.triangles.grading.fractures (or a smaller spacing)"
                                         : "a smaller spacing")};
}

} // namespace

std::vector<std::string> coarse_places(const GeometrySpec& geometry, const CutReport& report,
                                       const std::vector<InterfaceType>& types) {
    if (!geometry.tessellation) return {};
    std::vector<std::string> warnings = coarse_openings(geometry);
    std::ranges::move(coarse_bridges(geometry, report, types), std::back_inserter(warnings));
    return warnings;
}

std::vector<std::string> openings_in_large_blocks(const GeometrySpec& geometry, const BlockSystem& system,
                                                  double resolution, Kinematics kinematics) {
    std::vector<std::string> warnings;
    if (geometry.tessellation || kinematics == Kinematics::rigid) return warnings;
    for (std::size_t k = 0; k < geometry.holes.size(); ++k) {
        const auto [block, share] = largest_at(geometry.holes[k], system, resolution);
        if (block < 0) continue;
        if (warnings.size() == most_holes_told) {
            warnings.push_back(fmt::format("{}: and more holes like this", geometry.places.domain));
            break;
        }
        const double times =
            system.blocks[static_cast<std::size_t>(block)].area / std::abs(signed_area(geometry.holes[k]));
        warnings.push_back(fmt::format(
            "{}: block {} has {:.0f} % of the edge of hole {} and {:.2g} times its area: a block has one uniform "
            "strain, so that neither the stress around the opening nor its closure is resolved (a tunnel of 4 m in a "
            "block of 30 m closed by 0.02 mm in place of 2.4 mm); a net of triangles "
            "(`geometry.tessellation.triangles`, with grading.openings) resolves both",
            geometry.places.domain, block_label(system, block), 100.0 * share, k, times));
    }
    return warnings;
}

} // namespace kluft

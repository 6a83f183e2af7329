#include "kluft/scene/coarse_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/place_text.hpp"
#include "kluft/geometry/polygon.hpp"
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

} // namespace kluft

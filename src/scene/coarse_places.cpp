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
#include "kluft/geometry/predicates.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

namespace {

constexpr std::size_t most_told = 3;       ///< holes
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
        if (warnings.size() == most_told) {
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

/// A fracture, or a side of the body or of a hole.
struct Line {
    std::vector<Vec2> points;
    std::string name;
    bool is_open = true; ///< not a potential crack
};

/// Two lines that are nearer to each other than what the net resolves are one.
bool are_joined(const Line& a, const Line& b, double resolution) {
    for (std::size_t i = 0; i + 1 < a.points.size(); ++i) {
        const auto [from, to] = std::pair(a.points[i], a.points[i + 1]);
        for (std::size_t j = 0; j + 1 < b.points.size(); ++j) {
            const auto [c, d] = std::pair(b.points[j], b.points[j + 1]);
            const double away = std::min({distance_to_segment(from, c, d), distance_to_segment(to, c, d),
                                          distance_to_segment(c, from, to), distance_to_segment(d, from, to)});
            if (away <= resolution || segments_meet(from, to, c, d)) return true;
        }
    }
    return false;
}

std::vector<Line> sides_of(const Polygon& polygon, const std::string& name) {
    std::vector<Line> sides;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sides.push_back({{polygon[i], polygon[(i + 1) % polygon.size()]}, name});
    return sides;
}

/// Fractures first, in their order; then all sides.
std::vector<Line> lines_of(const GeometrySpec& geometry, const std::vector<InterfaceType>& types) {
    std::vector<Line> lines;
    for (const FractureTrace& trace : geometry.fractures) {
        const InterfaceKind kind = types[static_cast<std::size_t>(trace.interface_type)].kind;
        lines.push_back({trace.points, trace.name, kind == InterfaceKind::fracture});
    }
    std::ranges::move(sides_of(geometry.domain, "the outline of the body"), std::back_inserter(lines));
    for (std::size_t k = 0; k < geometry.holes.size(); ++k)
        std::ranges::move(sides_of(geometry.holes[k], fmt::format("hole {}", k)), std::back_inserter(lines));
    return lines;
}

/// The lines with a grid of their segments.
class LineSearch {
public:
    explicit LineSearch(std::vector<Line> lines) : lines_(std::move(lines)), grid_(segments()) {}

    [[nodiscard]] const Line& line(int i) const { return lines_[static_cast<std::size_t>(i)]; }

    /// The nearest open one to a point of the line `own` that this is not joined to, and its distance (m), where that is below a
    /// limit; none where the point lies on another line.
    [[nodiscard]] std::optional<std::pair<int, double>> nearest_other(const Vec2& p, int own, double limit,
                                                                      double resolution) const {
        std::vector<std::pair<double, int>> found;
        const Vec2 reach = Vec2::Constant(limit);
        for (const int i : grid_.near({p - reach, p + reach})) {
            const double away = distance_to_segment(p, grid_.segment(i).first, grid_.segment(i).second);
            const int line = line_of_[static_cast<std::size_t>(i)];
            if (line == own || away >= limit) continue;
            if (away <= resolution) return std::nullopt;
            if (lines_[static_cast<std::size_t>(line)].is_open) found.emplace_back(away, line);
        }
        std::ranges::sort(found);
        const auto other = std::ranges::find_if(
            found, [&](const auto& each) { return !are_joined(line(own), line(each.second), resolution); });
        if (other == found.end()) return std::nullopt;
        return std::pair(other->second, other->first);
    }

private:
    std::vector<SegmentGrid::Segment> segments() {
        std::vector<SegmentGrid::Segment> all;
        for (std::size_t k = 0; k < lines_.size(); ++k) {
            const std::vector<Vec2>& points = lines_[k].points;
            for (std::size_t i = 0; i + 1 < points.size(); ++i) {
                all.emplace_back(points[i], points[i + 1]);
                line_of_.push_back(static_cast<int>(k));
            }
        }
        return all;
    }

    std::vector<Line> lines_;
    std::vector<int> line_of_; ///< of each segment
    SegmentGrid grid_;
};

/// Rock between the end of an open fracture and another line.
struct RockBridge {
    const FractureTrace* trace = nullptr;
    Vec2 end = Vec2::Zero();
    std::string other;
    double length = 0.0;                                      ///< m
    double n_cells = std::numeric_limits<double>::infinity(); ///< along it
};

bool is_in_net(const Vec2& p, const GeometrySpec& geometry) {
    const std::optional<Polygon>& region = geometry.tessellation->region;
    return contains(geometry.domain, p) && (!region || contains(*region, p)) &&
           std::ranges::none_of(geometry.holes, [&p](const Polygon& hole) { return contains(hole, p); });
}

std::string more_of_them(std::size_t n) {
    if (n == 0) return "";
    return n == 1 ? " (and fewer than four along one more)" : fmt::format(" (and fewer than four along {} more)", n);
}

/// A narrow place holds as long as the mean stress of the few blocks in it is below their strength.
std::vector<std::string> coarse_bridges(const GeometrySpec& geometry, const CutReport& report,
                                        const std::vector<InterfaceType>& types) {
    const LineSearch search(lines_of(geometry, types));
    RockBridge shortest;
    std::set<std::pair<int, int>> bridges; // of two lines each
    for (int k = 0; k < static_cast<int>(geometry.fractures.size()); ++k) {
        const bool is_left = std::ranges::none_of(report.lost, [k](const LostFracture& lost) {
            return lost.fracture == k && lost.cause != LostFracture::Cause::in_part;
        });
        if (!is_left || !search.line(k).is_open) continue;
        const FractureTrace& trace = geometry.fractures[static_cast<std::size_t>(k)];
        for (const Vec2& end : {trace.points.front(), trace.points.back()}) {
            if (!is_in_net(end, geometry)) continue;
            const double spacing = spacing_at(end, grading_of(geometry).fractures, geometry);
            const auto nearest = search.nearest_other(end, k, fewest_in_a_bridge * spacing, report.resolution);
            if (!nearest) continue;
            const auto& [other, length] = *nearest;
            bridges.emplace(std::minmax(k, other));
            if (length / spacing < shortest.n_cells * (1.0 - rounding))
                shortest = {&trace, end, search.line(other).name, length, length / spacing};
        }
    }
    if (bridges.empty()) return {};
    const bool of_triangles = geometry.tessellation->triangles.has_value();
    return {fmt::format(
        "{}: {} ends at {}, {:.3g} m before {}, with {:.2g} cells of the net along this rock bridge{}: bridges of so "
        "few "
        "are too strong, of triangles by 64 % with one, 38 % with two and 13 % with four; {} makes the net finer there",
        shortest.trace->place, shortest.trace->name, place_text(shortest.end), shortest.length, shortest.other,
        shortest.n_cells, more_of_them(bridges.size() - 1),
        of_triangles ? "geometry.tessellation.triangles.grading.fractures" : "a smaller spacing")};
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

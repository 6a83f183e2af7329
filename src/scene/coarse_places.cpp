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

/// A fracture, or a side of the body or of a hole.
struct Line {
    std::vector<Vec2> points; ///< none of a fracture that is left out
    std::string name;
    double graded = 0.0; ///< side of triangles along it, 0 where the scene gives none (m)
    bool is_open = true; ///< not a potential crack
};

void add_sides(const Polygon& polygon, const std::string& name, double graded, std::vector<Line>& lines) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
        lines.push_back({{polygon[i], polygon[(i + 1) % polygon.size()]}, name, graded});
}

/// Fractures first, in their order; then all sides.
std::vector<Line> lines_of(const GeometrySpec& geometry, const CutReport& report,
                           const std::vector<InterfaceType>& types) {
    const TriangleGrading grading = grading_of(geometry);
    std::vector<Line> lines;
    for (const FractureTrace& trace : geometry.fractures) {
        const InterfaceKind kind = types[static_cast<std::size_t>(trace.interface_type)].kind;
        lines.push_back({trace.points, trace.name, grading.fractures, kind == InterfaceKind::fracture});
    }
    for (const LostFracture& lost : report.lost)
        if (lost.cause != LostFracture::Cause::in_part) lines[static_cast<std::size_t>(lost.fracture)].points.clear();
    add_sides(geometry.domain, "the outline of the body", 0.0, lines);
    for (std::size_t k = 0; k < geometry.holes.size(); ++k)
        add_sides(geometry.holes[k], fmt::format("hole {}", k), grading.openings, lines);
    return lines;
}

/// Of two segments that meet; of two that overlap an end of theirs.
Vec2 meeting_point(const SegmentGrid::Segment& a, const SegmentGrid::Segment& b) {
    const Vec2 u = a.second - a.first;
    const Vec2 v = b.second - b.first;
    const double cross = u.x() * v.y() - u.y() * v.x();
    if (cross == 0.0) return nearest_point(b.first, a.first, a.second);
    const Vec2 between = b.first - a.first;
    return a.first + (between.x() * v.y() - between.y() * v.x()) / cross * u;
}

/// Rock between the end of an open fracture and another line.
struct RockBridge {
    int line = -1; ///< at the end of the bridge
    double length = std::numeric_limits<double>::infinity();
};

/// The lines with a grid of their segments. Lines that are nearer to each other than the resolution (m) are joined there.
class LineSearch {
public:
    LineSearch(std::vector<Line> lines, double resolution)
        : lines_(std::move(lines)), resolution_(resolution), grid_(segments()) {}

    [[nodiscard]] const Line& line(int i) const { return lines_[static_cast<std::size_t>(i)]; }

    /// The shortest one from an end of the line `own` that is shorter than a limit (m); none where the end lies on another line.
    [[nodiscard]] std::optional<RockBridge> bridge_at(const Vec2& end, int own, double limit) const {
        const std::vector<Vec2> junctions = junctions_of(own, end, longest_detour * limit);
        for (double reach = limit / 64.0;; reach = std::min(limit, 4.0 * reach)) { // most often the nearest is near
            for (const auto& [away, i] : nearest(end, own, reach)) {
                if (away <= resolution_) return std::nullopt;
                const int other = line_of_[static_cast<std::size_t>(i)];
                const Vec2 at = nearest_point(end, grid_.segment(i).first, grid_.segment(i).second);
                if (line(other).is_open && !is_round(end, at, junctions)) return RockBridge{other, away};
            }
            if (reach == limit) return std::nullopt;
        }
    }

private:
    static constexpr double longest_detour = 3.0; ///< over the bridge: rock that the lines themselves go round is none

    /// Whether a line leads from the end by one of its junctions to the other end of the bridge without a long way round.
    [[nodiscard]] static bool is_round(const Vec2& end, const Vec2& at, const std::vector<Vec2>& junctions) {
        return std::ranges::any_of(junctions, [&](const Vec2& junction) {
            return (end - junction).norm() + (junction - at).norm() <= longest_detour * (end - at).norm();
        });
    }

    /// Segments of other lines nearer than `reach` with their distances, ascending.
    [[nodiscard]] std::vector<std::pair<double, int>> nearest(const Vec2& p, int own, double reach) const {
        std::vector<std::pair<double, int>> found;
        for (const int i : grid_.near({p - Vec2::Constant(reach), p + Vec2::Constant(reach)})) {
            const double away = distance_to_segment(p, grid_.segment(i).first, grid_.segment(i).second);
            if (line_of_[static_cast<std::size_t>(i)] != own && away < reach) found.emplace_back(away, i);
        }
        std::ranges::sort(found);
        return found;
    }

    /// Where a line meets others, not farther from p than `reach`.
    [[nodiscard]] std::vector<Vec2> junctions_of(int own, const Vec2& p, double reach) const {
        std::vector<Vec2> junctions;
        const auto note = [&](const Vec2& at) {
            if ((at - p).norm() <= reach) junctions.push_back(at);
        };
        const std::vector<Vec2>& points = line(own).points;
        for (std::size_t k = 0; k + 1 < points.size(); ++k) {
            const SegmentGrid::Segment part{points[k], points[k + 1]};
            if (distance_to_segment(p, part.first, part.second) > reach) continue;
            const Box box = bounding_box({part.first, part.second});
            const Vec2 margin = Vec2::Constant(resolution_);
            for (const int i : grid_.near({box.lower - margin, box.upper + margin})) {
                if (line_of_[static_cast<std::size_t>(i)] == own) continue;
                const auto& [a, b] = grid_.segment(i);
                for (const Vec2& end : {part.first, part.second})
                    if (distance_to_segment(end, a, b) <= resolution_) note(end);
                for (const Vec2& end : {a, b})
                    if (distance_to_segment(end, part.first, part.second) <= resolution_) note(end);
                if (segments_meet(part.first, part.second, a, b)) note(meeting_point(part, grid_.segment(i)));
            }
        }
        return junctions;
    }

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
    double resolution_ = 0.0;
    SegmentGrid grid_;
};

bool is_in_net(const Vec2& p, const GeometrySpec& geometry) {
    const std::optional<Polygon>& region = geometry.tessellation->region;
    return contains(geometry.domain, p) && (!region || contains(*region, p)) &&
           std::ranges::none_of(geometry.holes, [&p](const Polygon& hole) { return contains(hole, p); });
}

/// Cells of the net along a bridge: sides grow from both of its ends until they are the spacing.
double cells_along(const Vec2& end, const Line& other, double length, const GeometrySpec& geometry) {
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
    const LineSearch search(lines_of(geometry, report, types), report.resolution);
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

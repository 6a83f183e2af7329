#include "kluft/scene/body_lines.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {

namespace {

constexpr double longest_detour = 3.0; ///< over the bridge: rock that the lines themselves go round is none

void add_sides(const Polygon& polygon, const std::string& name, double graded, std::vector<BodyLine>& lines) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
        lines.push_back({{polygon[i], polygon[(i + 1) % polygon.size()]}, name, graded});
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

/// Whether a line leads from the end by one of its junctions to the other end of the bridge without a long way round.
bool is_round(const Vec2& end, const Vec2& at, const std::vector<Vec2>& junctions) {
    return std::ranges::any_of(junctions, [&](const Vec2& junction) {
        return (end - junction).norm() + (junction - at).norm() <= longest_detour * (end - at).norm();
    });
}

} // namespace

std::vector<BodyLine> body_lines(const GeometrySpec& geometry, const CutReport& report,
                                 const std::vector<InterfaceType>& types) {
    const bool has_triangles = geometry.tessellation && geometry.tessellation->triangles;
    const TriangleGrading grading = has_triangles ? geometry.tessellation->triangles->grading : TriangleGrading{};
    std::vector<BodyLine> lines;
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

bool is_in_body(const Vec2& p, const GeometrySpec& geometry) {
    return contains(geometry.domain, p) &&
           std::ranges::none_of(geometry.holes, [&p](const Polygon& hole) { return contains(hole, p); });
}

LineSearch::LineSearch(std::vector<BodyLine> lines, double resolution)
    : lines_(std::move(lines)), resolution_(resolution), grid_(segments()) {}

std::optional<RockBridge> LineSearch::bridge_at(const Vec2& end, int own, double limit) const {
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

std::vector<std::pair<double, int>> LineSearch::nearest(const Vec2& p, int own, double reach) const {
    std::vector<std::pair<double, int>> found;
    for (const int i : grid_.near({p - Vec2::Constant(reach), p + Vec2::Constant(reach)})) {
        const double away = distance_to_segment(p, grid_.segment(i).first, grid_.segment(i).second);
        if (line_of_[static_cast<std::size_t>(i)] != own && away < reach) found.emplace_back(away, i);
    }
    std::ranges::sort(found);
    return found;
}

std::vector<Vec2> LineSearch::junctions_of(int own, const Vec2& p, double reach) const {
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

std::vector<SegmentGrid::Segment> LineSearch::segments() {
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

} // namespace kluft

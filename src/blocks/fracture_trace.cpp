#include "kluft/blocks/fracture_trace.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <boost/geometry/algorithms/simplify.hpp>
#include <boost/geometry/geometries/linestring.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/strategies/strategies.hpp>

#include "kluft/geometry/predicates.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

namespace {

SegmentGrid grid_of(const std::vector<SourceSegment>& segments) {
    std::vector<SegmentGrid::Segment> pairs;
    pairs.reserve(segments.size());
    for (const SourceSegment& segment : segments) pairs.emplace_back(segment.a, segment.b);
    return SegmentGrid(std::move(pairs));
}

/// The part of the segment ab in a box, from the first to the second share of its length (Liang and Barsky 1984).
std::optional<std::pair<long double, long double>> shares_in(const Box& box, const Vec2& a, const Vec2& b) {
    long double from = 0.0L;
    long double to = 1.0L;
    for (const int axis : {0, 1}) {
        const long double start = a[axis];
        const long double step = static_cast<long double>(b[axis]) - start;
        if (step == 0.0L) {
            if (start < box.lower[axis] || start > box.upper[axis]) return std::nullopt;
            continue;
        }
        const long double at_lower = (box.lower[axis] - start) / step;
        const long double at_upper = (box.upper[axis] - start) / step;
        from = std::max(from, std::min(at_lower, at_upper));
        to = std::min(to, std::max(at_lower, at_upper));
    }
    if (from >= to) return std::nullopt;
    return std::pair(from, to);
}

Vec2 at_share(const Vec2& a, const Vec2& b, long double share) {
    const auto coordinate = [&](int axis) {
        const long double start = a[axis];
        return static_cast<double>(start + share * (b[axis] - start));
    };
    return {coordinate(0), coordinate(1)};
}

/// Whether a segment is one of those that follow the first point of `points` within `arc` along the trace.
bool follows_closely(const std::vector<Vec2>& points, const SourceSegment& segment, double arc) {
    double along = 0.0;
    for (std::size_t i = 0; i + 1 < points.size() && along <= arc; ++i) {
        const bool same = (segment.a == points[i] && segment.b == points[i + 1]) ||
                          (segment.b == points[i] && segment.a == points[i + 1]);
        if (same) return true;
        along += (points[i + 1] - points[i]).norm();
    }
    return false;
}

/// Whether the trace meets ab already, at the latest `arc` after its first point.
bool meets_soon(const std::vector<Vec2>& points, const Vec2& a, const Vec2& b, double arc) {
    double along = 0.0;
    for (std::size_t i = 0; i + 1 < points.size() && along <= arc; ++i) {
        if (segments_meet(points[i], points[i + 1], a, b)) return true;
        along += (points[i + 1] - points[i]).norm();
    }
    return false;
}

/// From p across the segment ab, where the foot of p lies inside it.
std::optional<Vec2> point_across(const Vec2& p, const Vec2& a, const Vec2& b, double missing) {
    const int side = orientation(a, b, p);
    const Vec2 towards = static_cast<double>(side) * right_normal(b - a).normalized();
    const double scale = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff()});
    double past = std::max(missing, 4.0 * std::numeric_limits<double>::epsilon() * scale);
    for (int attempt = 0; attempt < 8; ++attempt, past *= 2.0) {
        const Vec2 q = p + (missing + past) * towards;
        if (q != p && segments_meet(p, q, a, b)) return q;
    }
    return std::nullopt;
}

/// The segment from the first point of `points` to what it nearly meets.
std::optional<SourceSegment> bridge(const std::vector<Vec2>& points, int source,
                                    const std::vector<SourceSegment>& segments, const SegmentGrid& grid, double reach) {
    const Vec2& p = points.front();
    int nearest = -1;
    double missing = reach;
    const Vec2 around(reach, reach);
    for (const int i : grid.near({p - around, p + around})) {
        const SourceSegment& other = segments[i];
        if (other.source == source && follows_closely(points, other, 4.0 * reach)) continue;
        const double distance = distance_to_segment(p, other.a, other.b);
        if (distance > missing) continue;
        if (meets_soon(points, other.a, other.b, 4.0 * reach)) return std::nullopt;
        missing = distance;
        nearest = i;
    }
    if (nearest < 0) return std::nullopt;
    const auto& [a, b, ignored] = segments[nearest];
    if ((p - a).dot(b - a) <= 0.0) return SourceSegment{p, a, source};
    if ((p - b).dot(a - b) <= 0.0) return SourceSegment{p, b, source};
    const auto across = point_across(p, a, b, missing);
    if (!across) return std::nullopt;
    return SourceSegment{p, *across, source};
}

} // namespace

std::vector<SourceSegment> bridge_ends(const std::vector<SourceTrace>& traces,
                                       const std::vector<SourceSegment>& segments, double reach) {
    const SegmentGrid grid = grid_of(segments);
    std::vector<SourceSegment> bridges;
    for (const SourceTrace& trace : traces) {
        if (trace.points.front() == trace.points.back()) continue;
        std::vector<Vec2> points = trace.points;
        for (int side = 0; side < 2; ++side) {
            if (const auto found = bridge(points, trace.source, segments, grid, reach)) bridges.push_back(*found);
            std::reverse(points.begin(), points.end());
        }
    }
    return bridges;
}

std::vector<Vec2> simplified(const std::vector<Vec2>& points, double tolerance) {
    using Point = boost::geometry::model::d2::point_xy<double>;
    boost::geometry::model::linestring<Point> line;
    boost::geometry::model::linestring<Point> simple;
    for (const Vec2& p : points) line.emplace_back(p.x(), p.y());
    boost::geometry::simplify(line, simple, tolerance);
    std::vector<Vec2> result;
    for (const Point& p : simple) result.emplace_back(p.x(), p.y());
    return result;
}

std::vector<std::vector<Vec2>> parts_near(const Box& box, const std::vector<Vec2>& points) {
    const Vec2 margin = Vec2::Constant((box.upper - box.lower).norm());
    const Box wide{box.lower - margin, box.upper + margin};
    std::vector<std::vector<Vec2>> parts;
    bool goes_on = false; // from the last point of the last part
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const auto shares = shares_in(wide, points[i], points[i + 1]);
        if (!shares) {
            goes_on = false;
            continue;
        }
        const auto [from, to] = *shares;
        if (!goes_on) parts.push_back({from > 0.0L ? at_share(points[i], points[i + 1], from) : points[i]});
        parts.back().push_back(to < 1.0L ? at_share(points[i], points[i + 1], to) : points[i + 1]);
        goes_on = to == 1.0L;
    }
    return parts;
}

} // namespace kluft

#include "kluft/blocks/fracture_trace.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

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

/// The segment from p to the nearest point of another one, a little across it; nothing where p lies on it.
std::optional<SourceSegment> segment_to(const Vec2& p, const SourceSegment& other, int source) {
    const auto& [a, b, ignored] = other;
    if ((p - a).dot(b - a) <= 0.0) return SourceSegment{p, a, source};
    if ((p - b).dot(a - b) <= 0.0) return SourceSegment{p, b, source};
    const auto across = point_across(p, a, b, distance_to_segment(p, a, b));
    return across ? std::optional(SourceSegment{p, *across, source}) : std::nullopt;
}

/// The ends of the traces of each source.
using TraceEnds = std::unordered_map<int, std::vector<Vec2>>;

TraceEnds ends_of(const std::vector<SourceTrace>& traces) {
    TraceEnds ends;
    for (const SourceTrace& trace : traces) {
        if (trace.points.front() == trace.points.back()) continue;
        for (const Vec2& end : {trace.points.front(), trace.points.back()}) ends[trace.source].push_back(end);
    }
    return ends;
}

/// All lines, and where the traces among them end.
struct Neighbourhood {
    const std::vector<SourceSegment>& segments;
    SegmentGrid grid;
    TraceEnds ends;
    double reach = 0.0;

    /// Whether a trace of `other` ends within reach of the first point of `points`, a trace of `source`, which is itself none of those.
    [[nodiscard]] bool ends_beside(const std::vector<Vec2>& points, int source, int other) const {
        const auto found = ends.find(other);
        if (found == ends.end()) return false;
        const auto n = std::ranges::count_if(found->second,
                                             [&](const Vec2& end) { return (end - points.front()).norm() <= reach; });
        return n > (other == source ? 1 : 0);
    }
};

/// The segments from the first point of `points` to what it nearly meets: to the nearest trace that ends beside it, and to the
/// nearest line that goes on there, each unless the trace meets one already.
std::vector<SourceSegment> bridges(const std::vector<Vec2>& points, int source, const Neighbourhood& around) {
    struct Nearest {
        int segment = -1;
        double missing = 0.0;
        bool is_met = false;
    };
    const Vec2& p = points.front();
    Nearest ending{.missing = around.reach};
    Nearest going_on{.missing = around.reach};
    const Vec2 margin(around.reach, around.reach);
    for (const int i : around.grid.near({p - margin, p + margin})) {
        const SourceSegment& other = around.segments[i];
        if (other.source == source && follows_closely(points, other, 4.0 * around.reach)) continue;
        Nearest& nearest = around.ends_beside(points, source, other.source) ? ending : going_on;
        const double distance = distance_to_segment(p, other.a, other.b);
        if (distance > nearest.missing) continue;
        nearest = {i, distance, nearest.is_met || meets_soon(points, other.a, other.b, 4.0 * around.reach)};
    }
    std::vector<SourceSegment> found;
    for (const Nearest& nearest : {ending, going_on}) {
        if (nearest.segment < 0 || nearest.is_met) continue;
        if (const auto segment = segment_to(p, around.segments[nearest.segment], source)) found.push_back(*segment);
    }
    return found;
}

/// The segment from a bend of the trace to a line that it would touch but for rounding, if there is one.
std::optional<SourceSegment> bridge_at_bend(const SourceTrace& trace, std::size_t bend, const Neighbourhood& around) {
    constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon(); // of the coordinates
    const Vec2& p = trace.points[bend];
    const Vec2& before = trace.points[bend - 1];
    const Vec2& after = trace.points[bend + 1];
    const double reach = std::min(rounding * p.cwiseAbs().maxCoeff(), around.reach);
    const Vec2 margin(reach, reach);
    for (const int i : around.grid.near({p - margin, p + margin})) {
        const SourceSegment& other = around.segments[i];
        const bool is_own = other.source == trace.source && (other.a == p || other.b == p);
        if (is_own || distance_to_segment(p, other.a, other.b) > reach) continue;
        if (segments_meet(before, p, other.a, other.b) || segments_meet(p, after, other.a, other.b)) continue;
        return segment_to(p, other, trace.source);
    }
    return std::nullopt;
}

} // namespace

std::vector<SourceSegment> bridge_ends(const std::vector<SourceTrace>& traces,
                                       const std::vector<SourceSegment>& segments, double reach) {
    const Neighbourhood around{segments, grid_of(segments), ends_of(traces), reach};
    std::vector<SourceSegment> found;
    for (const SourceTrace& trace : traces) {
        for (std::size_t i = 1; i + 1 < trace.points.size(); ++i)
            if (const auto of_bend = bridge_at_bend(trace, i, around)) found.push_back(*of_bend);
        if (trace.points.front() == trace.points.back()) continue;
        std::vector<Vec2> points = trace.points;
        for (int side = 0; side < 2; ++side) {
            const std::vector<SourceSegment> of_end = bridges(points, trace.source, around);
            found.insert(found.end(), of_end.begin(), of_end.end());
            std::reverse(points.begin(), points.end());
        }
    }
    return found;
}

std::vector<SourceSegment> bridge_notches(const std::vector<std::vector<Vec2>>& outlines,
                                          const std::vector<SourceSegment>& segments, double reach) {
    std::vector<SourceSegment> found;
    if (segments.empty()) return found;
    const SegmentGrid grid = grid_of(segments);
    const Vec2 margin(reach, reach);
    for (const std::vector<Vec2>& outline : outlines) {
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const Vec2& corner = outline[i];
            const Vec2 arriving = corner - outline[(i + outline.size() - 1) % outline.size()];
            const Vec2 leaving = outline[(i + 1) % outline.size()] - corner;
            if (cross(arriving, leaving) >= 0.0) continue;
            for (const int s : grid.near({corner - margin, corner + margin})) {
                const auto& [a, b, source] = segments[s];
                const Vec2 towards = nearest_point(corner, a, b) - corner;
                const bool is_beside = (corner - a).dot(b - a) > 0.0 && (corner - b).dot(a - b) > 0.0;
                const bool is_met = (is_beside && orientation(a, b, corner) == 0) || towards.isZero(0.0);
                if (is_met || towards.norm() > reach) continue;
                if (cross(arriving, towards) <= 0.0 && cross(leaving, towards) <= 0.0) continue; // before the body
                if (const auto segment = segment_to(corner, segments[s], source)) found.push_back(*segment);
            }
        }
    }
    return found;
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

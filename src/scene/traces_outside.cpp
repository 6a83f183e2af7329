#include "kluft/scene/traces_outside.hpp"

#include <algorithm>
#include <limits>

#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {

namespace {

/// The sides of a domain and of its holes, and what lies between them.
class BodyOutline {
public:
    BodyOutline(const Polygon& domain, const std::vector<Polygon>& holes)
        : domain_(domain), holes_(holes), window_(bounding_box(domain)) {
        constexpr double of_extent = 1e-12;
        constexpr double of_position = 16.0 * std::numeric_limits<double>::epsilon();
        const double farthest = std::max(window_.lower.cwiseAbs().maxCoeff(), window_.upper.cwiseAbs().maxCoeff());
        rounding_ = std::max(of_extent * (window_.upper - window_.lower).norm(), of_position * farthest);
        add(domain);
        for (const Polygon& hole : holes) add(hole);
    }

    /// Whether a part of the line lies in the body or along its outline.
    [[nodiscard]] bool has_part_of(const std::vector<Vec2>& line) const {
        for (std::size_t i = 1; i < line.size(); ++i)
            if (has_part_of(line[i - 1], line[i])) return true;
        return false;
    }

    /// Of a line without a part in the body. Its ends may lie on a wall, and beside it by rounding.
    [[nodiscard]] bool is_in_hole(const std::vector<Vec2>& line) const {
        for (std::size_t i = 1; i < line.size(); ++i)
            if (is_in_hole(line[i]) || is_in_hole(0.5 * (line[i - 1] + line[i]))) return true;
        return false;
    }

private:
    struct Side {
        Vec2 start;
        Vec2 end;
        Box box;
    };

    void add(const Polygon& polygon) {
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec2& start = polygon[i];
            const Vec2& end = polygon[(i + 1) % polygon.size()];
            sides_.push_back({start, end, bounding_box({start, end})});
        }
    }

    [[nodiscard]] bool is_near(const Box& a, const Box& b) const {
        return (a.lower.array() <= b.upper.array() + rounding_).all() &&
               (b.lower.array() <= a.upper.array() + rounding_).all();
    }

    /// Between two places where the segment meets a side it lies on one side of all of them.
    [[nodiscard]] bool has_part_of(const Vec2& start, const Vec2& end) const {
        const Box box = bounding_box({start, end});
        if (!is_near(window_, box)) return false;
        std::vector<double> cuts{0.0, 1.0};
        for (const Side& side : sides_)
            if (is_near(side.box, box)) add_cuts(start, end, side, cuts);
        std::ranges::sort(cuts);
        const double length = (end - start).norm();
        for (std::size_t i = 1; i < cuts.size(); ++i) {
            const bool is_whole = cuts.size() == 2;
            if (!is_whole && (cuts[i] - cuts[i - 1]) * length <= 4.0 * rounding_) continue;
            if (holds(start + 0.5 * (cuts[i - 1] + cuts[i]) * (end - start))) return true;
        }
        return false;
    }

    /// The parameters along the segment at which it meets the side.
    static void add_cuts(const Vec2& start, const Vec2& end, const Side& side, std::vector<double>& cuts) {
        const Vec2 along = end - start;
        const Vec2 across = side.end - side.start;
        const double turn = cross(along, across);
        const auto add = [&cuts](double at) {
            if (at > 0.0 && at < 1.0) cuts.push_back(at);
        };
        if (segments_meet(start, end, side.start, side.end) && turn != 0.0)
            add(cross(side.start - start, across) / turn);
        for (const Vec2& corner : {side.start, side.end}) add((corner - start).dot(along) / along.squaredNorm());
    }

    [[nodiscard]] bool is_in_hole(const Vec2& p) const {
        return std::ranges::any_of(holes_, [&p](const Polygon& hole) { return contains(hole, p); });
    }

    [[nodiscard]] bool holds(const Vec2& p) const {
        const auto is_here = [&](const Side& side) {
            return is_near(side.box, {p, p}) && distance_to_segment(p, side.start, side.end) <= rounding_;
        };
        return std::ranges::any_of(sides_, is_here) || (contains(domain_, p) && !is_in_hole(p));
    }

    const Polygon& domain_;
    const std::vector<Polygon>& holes_;
    Box window_;
    double rounding_ = 0.0;
    std::vector<Side> sides_;
};

} // namespace

std::vector<LineOutside> lines_outside(const Polygon& domain, const std::vector<Polygon>& holes,
                                       const std::vector<std::vector<Vec2>>& lines) {
    const BodyOutline outline(domain, holes);
    std::vector<LineOutside> outside;
    for (std::size_t i = 0; i < lines.size(); ++i)
        if (!lines[i].empty() && !outline.has_part_of(lines[i])) outside.push_back({i, outline.is_in_hole(lines[i])});
    return outside;
}

std::vector<LineOutside> traces_outside(const GeometrySpec& geometry) {
    std::vector<std::vector<Vec2>> lines;
    lines.reserve(geometry.fractures.size());
    for (const FractureTrace& trace : geometry.fractures) lines.push_back(trace.points);
    return lines_outside(geometry.domain, geometry.holes, lines);
}

bool is_outside(const Polygon& region, const Polygon& domain, const std::vector<Polygon>& holes) {
    Polygon closed = region;
    closed.push_back(region.front());
    return !lines_outside(domain, holes, {closed}).empty() && !contains(region, domain.front());
}

} // namespace kluft

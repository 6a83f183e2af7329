#include "kluft/geometry/polygon.hpp"

#include <algorithm>
#include <stdexcept>

#include "kluft/geometry/predicates.hpp"

namespace kluft {

double signed_area(const std::vector<Vec2>& polygon) {
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    }
    return 0.5 * twice;
}

bool contains(const std::vector<Vec2>& polygon, const Vec2& p) {
    bool inside = false;
    for (std::size_t i = 0, n = polygon.size(); i < n; ++i) {
        const Vec2& a = polygon[i];
        const Vec2& b = polygon[(i + 1) % n];
        if (on_segment(p, a, b)) return true;
        if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
        const Vec2& low = a.y() <= p.y() ? a : b;
        const Vec2& high = a.y() <= p.y() ? b : a;
        if (orientation(low, high, p) > 0) inside = !inside;
    }
    return inside;
}

bool is_simple(const std::vector<Vec2>& polygon) {
    const std::size_t n = polygon.size();
    if (n < 3) return false;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2& a = polygon[i];
        const Vec2& b = polygon[(i + 1) % n];
        const Vec2& c = polygon[(i + 2) % n];
        if (a == b) return false;
        if (orientation(a, b, c) == 0 && (b - a).dot(c - b) <= 0.0) return false;
        for (std::size_t j = i + 2; j < n; ++j) {
            if ((j + 1) % n == i) continue;
            if (segments_meet(a, b, polygon[j], polygon[(j + 1) % n])) return false;
        }
    }
    return true;
}

Box bounding_box(const std::vector<Vec2>& points) {
    if (points.empty()) throw std::invalid_argument("the box of no points");
    Box box{points.front(), points.front()};
    for (const Vec2& p : points) {
        box.lower = box.lower.cwiseMin(p);
        box.upper = box.upper.cwiseMax(p);
    }
    return box;
}

} // namespace kluft

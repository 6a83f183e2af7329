#include "kluft/scene/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft {

namespace {

int n_sides_of(const Polygon& polygon) { return static_cast<int>(polygon.size()); }

Vec2 side_direction(const Polygon& polygon, int side) {
    return polygon[(side + 1) % n_sides_of(polygon)] - polygon[side];
}

Facing facing_of(const Vec2& normal) {
    constexpr double diagonal = 1.0 + 1e-6; // what coordinates far from the origin leave of 45 degrees
    if (std::abs(normal.x()) > diagonal * std::abs(normal.y())) return normal.x() > 0.0 ? Facing::right : Facing::left;
    return normal.y() > 0.0 ? Facing::top : Facing::bottom;
}

/// Whether the segments a0-a1 and b0-b1 properly cross.
bool cross_properly(const Vec2& a0, const Vec2& a1, const Vec2& b0, const Vec2& b1) {
    const double b0_side = cross(a1 - a0, b0 - a0);
    const double b1_side = cross(a1 - a0, b1 - a0);
    const double a0_side = cross(b1 - b0, a0 - b0);
    const double a1_side = cross(b1 - b0, a1 - b0);
    const double round_off = 1e-12 * (a1 - a0).norm() * (b1 - b0).norm();
    const auto opposite = [&](double p, double q) {
        return (p > round_off && q < -round_off) || (p < -round_off && q > round_off);
    };
    return opposite(b0_side, b1_side) && opposite(a0_side, a1_side);
}

} // namespace

std::string_view facing_name(Facing facing) {
    switch (facing) {
    case Facing::left:
        return "left";
    case Facing::right:
        return "right";
    case Facing::top:
        return "top";
    case Facing::bottom:
        return "bottom";
    }
    return "";
}

Polygon counter_clockwise(const Polygon& polygon) {
    Polygon result = polygon;
    if (signed_area(polygon) < 0.0) std::reverse(result.begin() + 1, result.end());
    return result;
}

int counter_clockwise_side(int side, int n_sides, bool was_clockwise) {
    return was_clockwise ? n_sides - 1 - side : side;
}

std::vector<int> sides_facing(const Polygon& polygon, Facing facing) {
    std::vector<int> sides;
    for (int i = 0; i < n_sides_of(polygon); ++i) {
        const Vec2 direction = side_direction(polygon, i);
        if (direction.norm() > 0.0 && facing_of(right_normal(direction)) == facing) sides.push_back(i);
    }
    return sides;
}

std::optional<std::pair<int, int>> crossing_sides(const Polygon& polygon) {
    const int n = n_sides_of(polygon);
    const auto end_of = [&](int side) -> const Vec2& { return polygon[(side + 1) % n]; };
    const auto left_of = [&](int side) { return std::min(polygon[side].x(), end_of(side).x()); };
    const auto right_of = [&](int side) { return std::max(polygon[side].x(), end_of(side).x()); };
    std::vector<int> from_left(polygon.size());
    std::iota(from_left.begin(), from_left.end(), 0);
    std::ranges::stable_sort(from_left, {}, left_of);
    std::optional<std::pair<int, int>> first;
    for (auto a = from_left.begin(); a != from_left.end(); ++a) {
        for (auto b = a + 1; b != from_left.end() && left_of(*b) <= right_of(*a); ++b) {
            const auto [i, j] = std::minmax(*a, *b);
            const bool are_neighbours = j == i + 1 || (i == 0 && j == n - 1);
            if (are_neighbours || (first && *first < std::pair(i, j))) continue;
            if (cross_properly(polygon[i], end_of(i), polygon[j], end_of(j))) first = std::pair(i, j);
        }
    }
    return first;
}

} // namespace kluft

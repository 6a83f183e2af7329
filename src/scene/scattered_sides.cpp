#include "kluft/scene/scattered_sides.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "kluft/core/place_text.hpp"

namespace kluft {

namespace {

constexpr double well_behind = 0.05; ///< of the extent of the body along the normal

/// Sides of an outline that follow one another.
struct ChainOfSides {
    double outermost = -std::numeric_limits<double>::infinity(); ///< along the normal (m)
    double length = 0.0;                                         ///< m
    Vec2 middle = Vec2::Zero();                                  ///< of its longest side
    double longest = 0.0;                                        ///< m
};

Vec2 start_of(const Polygon& outline, int side) { return outline[side]; }
Vec2 end_of(const Polygon& outline, int side) { return outline[(side + 1) % static_cast<int>(outline.size())]; }

Vec2 mean_normal(const Polygon& outline, const std::vector<int>& sides) {
    Vec2 sum = Vec2::Zero();
    for (const int side : sides) sum += right_normal(end_of(outline, side) - start_of(outline, side));
    return sum.normalized();
}

/// `sides` are in ascending order; the last one and the first may follow one another.
std::vector<ChainOfSides> chains_of(const Polygon& outline, const std::vector<int>& sides, const Vec2& normal) {
    std::vector<ChainOfSides> chains;
    const auto n = static_cast<int>(outline.size());
    const auto is_taken = [&](int side) { return std::ranges::binary_search(sides, (side + n) % n); };
    for (const int first : sides) {
        if (is_taken(first - 1)) continue;
        ChainOfSides& chain = chains.emplace_back();
        for (int side = first; is_taken(side); ++side) {
            const Vec2 start = start_of(outline, side % n);
            const Vec2 end = end_of(outline, side % n);
            const double length = (end - start).norm();
            chain.length += length;
            chain.outermost = std::max({chain.outermost, normal.dot(start), normal.dot(end)});
            if (length <= chain.longest) continue;
            chain.longest = length;
            chain.middle = 0.5 * (start + end);
        }
    }
    return chains;
}

double extent_along(const Polygon& outline, const Vec2& normal) {
    const auto along = [&](const Vec2& x) { return normal.dot(x); };
    const auto [least, most] = std::ranges::minmax(outline, {}, along);
    return along(most) - along(least);
}

/// The longest chain that lies well behind another one, and how far behind.
std::optional<std::pair<ChainOfSides, double>> chain_behind(const Polygon& outline, std::vector<int> sides) {
    std::ranges::sort(sides);
    const Vec2 normal = mean_normal(outline, sides);
    std::vector<ChainOfSides> chains = chains_of(outline, sides, normal);
    if (chains.size() < 2) return std::nullopt;
    const double outermost = std::ranges::max_element(chains, {}, &ChainOfSides::outermost)->outermost;
    const double least = well_behind * extent_along(outline, normal);
    std::erase_if(chains, [&](const ChainOfSides& chain) { return outermost - chain.outermost <= least; });
    if (chains.empty()) return std::nullopt;
    const ChainOfSides longest = *std::ranges::max_element(chains, {}, &ChainOfSides::length);
    return std::pair(longest, outermost - longest.outermost);
}

bool presses(const LoadProgram& loads, int boundary) {
    return std::ranges::any_of(loads.stages, [&](const Stage& stage) {
        return std::ranges::any_of(stage.pressure,
                                   [&](const auto& each) { return each.first == boundary && each.second != 0.0; });
    });
}

} // namespace

std::vector<std::string> scattered_sides(const Scene& scene) {
    const GeometrySpec& geometry = scene.geometry;
    if (geometry.domain.empty()) return {};
    const auto n = static_cast<int>(geometry.boundaries.size());
    const auto holds = [&](int i) {
        return i < static_cast<int>(scene.loads.supports.size()) && scene.loads.supports[i] != Support::none;
    };
    const auto n_sides = static_cast<int>(geometry.domain.size()); // those of holes come after them
    std::ptrdiff_t n_loaded = 0;
    for (int i = 0; i < n; ++i)
        if (holds(i) || presses(scene.loads, i))
            n_loaded += std::ranges::count_if(geometry.boundaries[static_cast<std::size_t>(i)].sides,
                                              [&](int side) { return side < n_sides; });
    if (n_loaded >= n_sides) return {}; // all around it is meant so
    std::vector<std::string> found;
    for (int i = 0; i < n; ++i) {
        const BoundarySides& boundary = geometry.boundaries[static_cast<std::size_t>(i)];
        if (!boundary.by_direction || (!holds(i) && !presses(scene.loads, i))) continue;
        const auto behind = chain_behind(geometry.domain, boundary.sides);
        if (!behind) continue;
        found.push_back(fmt::format("the {} '{}' also {} sides around {}, {:.3g} m behind the outermost ones",
                                    holds(i) ? "support of" : "pressure on", boundary.name,
                                    holds(i) ? "holds" : "presses", place_text(behind->first.middle), behind->second));
    }
    if (found.empty()) return {};
    return {fmt::format(
        "each side of the outline belongs to the direction that it faces: {}; `sides` for each boundary tell the "
        "face of a slope or the underside of a ledge from the sides of the body",
        fmt::join(found, ", "))};
}

} // namespace kluft

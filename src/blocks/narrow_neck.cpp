#include "kluft/blocks/narrow_neck.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {

namespace {

constexpr double narrow = 0.01; ///< of the size of a part

/// Counter-clockwise.
std::vector<Vec2> outline_of(const BlockSystem& system, const Block& block) {
    const std::size_t n = block.loop_starts.size() > 1 ? block.loop_starts[1] : block.edges.size();
    std::vector<Vec2> outline;
    outline.reserve(n);
    for (std::size_t i = 0; i < n; ++i) outline.push_back(edge_start(system, block.edges[i]));
    return outline;
}

/// Of what the line from corner i to a point on side j cuts off.
double part_of(const std::vector<Vec2>& outline, std::size_t i, std::size_t j, const Vec2& on_side) {
    std::vector<Vec2> part;
    for (std::size_t k = i; k != (j + 1) % outline.size(); k = (k + 1) % outline.size()) part.push_back(outline[k]);
    part.push_back(on_side);
    return signed_area(part);
}

std::optional<NarrowNeck> narrowest_neck(const BlockSystem& system, int b) {
    const Block& block = system.blocks[b];
    const std::vector<Vec2> outline = outline_of(system, block);
    const std::size_t n = outline.size();
    std::optional<NarrowNeck> narrowest;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2& corner = outline[i];
        const Vec2 arriving = corner - outline[(i + n - 1) % n];
        const Vec2 leaving = outline[(i + 1) % n] - corner;
        if (cross(arriving, leaving) >= 0.0) continue; // beside a neck there is a notch
        for (std::size_t j = (i + 1) % n; j != (i + n - 1) % n; j = (j + 1) % n) {
            const Vec2 across = nearest_point(corner, outline[j], outline[(j + 1) % n]) - corner;
            const double width = across.norm();
            const bool is_inside = cross(arriving, across) > 0.0 || cross(leaving, across) > 0.0;
            if (!is_inside || width >= narrow * block.size) continue;
            const double part = part_of(outline, i, j, corner + across);
            const double smaller = std::min(part, block.area - part);
            if (smaller <= 0.0 || width >= narrow * std::sqrt(smaller)) continue;
            const bool is_narrower =
                !narrowest || width * std::sqrt(narrowest->smaller_part) < narrowest->width * std::sqrt(smaller);
            if (is_narrower) narrowest = NarrowNeck{b, width, smaller, corner};
        }
    }
    return narrowest;
}

} // namespace

std::vector<NarrowNeck> narrow_necks(const BlockSystem& system) {
    std::vector<NarrowNeck> necks;
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (system.blocks[b].fixed) continue;
        if (const auto neck = narrowest_neck(system, b)) necks.push_back(*neck);
    }
    return necks;
}

} // namespace kluft

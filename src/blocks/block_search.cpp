#include "kluft/blocks/block_search.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {

namespace {

/// A point that is nearer to an outline than this part of the body's diagonal lies on it.
constexpr double on_outline = 1e-9;

double distance_to_outline(const BlockSystem& system, const Block& block, const Vec2& local) {
    double least = std::numeric_limits<double>::infinity();
    for (const Edge& edge : block.edges)
        least = std::min(least, distance_to_segment(local, edge_start(system, edge), edge_end(system, edge)));
    return least;
}

/// By the number of edges to the right of the point.
bool is_inside(const BlockSystem& system, const Block& block, const Vec2& local) {
    bool inside = false;
    for (const Edge& edge : block.edges) {
        const Vec2& a = edge_start(system, edge);
        const Vec2& b = edge_end(system, edge);
        if ((a.y() > local.y()) == (b.y() > local.y())) continue;
        const int side = orientation(a, b, local);
        if (side == (b.y() > a.y() ? 1 : -1)) inside = !inside;
    }
    return inside;
}

} // namespace

std::string block_label(const BlockSystem& system, int block) {
    return system.block_names.empty() ? std::to_string(block) : fmt::format("'{}'", system.block_names[block]);
}

std::vector<int> blocks_called(const BlockSystem& system, const std::string& name) {
    const auto set = std::ranges::find(system.sets, name, &BlockSet::name);
    if (set != system.sets.end()) return set->blocks;
    const auto block = std::ranges::find(system.block_names, name);
    if (block == system.block_names.end()) return {};
    return {static_cast<int>(block - system.block_names.begin())};
}

int block_called(const BlockSystem& system, const std::string& name, const std::string& what) {
    const auto blocks = blocks_called(system, name);
    if (blocks.size() == 1) return blocks.front();
    throw InputError(fmt::format("{}: expected one block, found '{}', which is {} of them", what, name, blocks.size()));
}

bool block_contains(const BlockSystem& system, int block, const Vec2& point) {
    const Vec2 local = point - system.origin;
    const Block& b = system.blocks[block];
    const double tolerance = on_outline * (system.upper - system.lower).norm();
    return is_inside(system, b, local) || distance_to_outline(system, b, local) <= tolerance;
}

std::vector<int> blocks_containing(const BlockSystem& system, const Vec2& point) {
    std::vector<int> blocks;
    for (int b = 0; b < system.n_blocks(); ++b)
        if (block_contains(system, b, point)) blocks.push_back(b);
    std::stable_partition(blocks.begin(), blocks.end(), [&](int b) { return !system.blocks[b].fixed; });
    return blocks;
}

int block_containing(const BlockSystem& system, const Vec2& point) {
    const std::vector<int> blocks = blocks_containing(system, point);
    return blocks.empty() ? -1 : blocks.front();
}

void form_sets(const GeometrySpec& spec, BlockSystem& system) {
    for (const BlockSetSpec& given : spec.sets) {
        BlockSet set{given.name, given.blocks};
        if (!given.polygon.empty()) {
            for (int b = 0; b < system.n_blocks(); ++b)
                if (contains(given.polygon, system.origin + system.blocks[b].centroid)) set.blocks.push_back(b);
        }
        std::ranges::sort(set.blocks);
        set.blocks.erase(std::unique(set.blocks.begin(), set.blocks.end()), set.blocks.end());
        if (set.blocks.empty())
            throw InputError(fmt::format("geometry.sets.{}: expected a polygon with the centroid of a block in it, "
                                         "found none",
                                         given.name));
        for (const int b : set.blocks) system.blocks[b].fixed = system.blocks[b].fixed || given.fixed;
        system.sets.push_back(std::move(set));
    }
}

double sliver_area(const BlockSystem& system) { return 1e-5 * area_of(system) / system.n_blocks(); }

} // namespace kluft

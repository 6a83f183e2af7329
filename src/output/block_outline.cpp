#include "kluft/output/block_outline.hpp"

#include <algorithm>
#include <limits>

namespace kluft {

namespace {

const Vec2& place(const BlockSystem& system, const Block& block, int edge) {
    return edge_start(system, block.edges[edge]);
}

/// Whether the open segments a-b and c-d meet.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const double side_c = cross(b - a, c - a);
    const double side_d = cross(b - a, d - a);
    const double side_a = cross(d - c, a - c);
    const double side_b = cross(d - c, b - c);
    return side_c * side_d < 0.0 && side_a * side_b < 0.0;
}

/// Whether the bridge from a to b crosses an edge of the block.
bool bridge_is_free(const BlockSystem& system, const Block& block, const Vec2& a, const Vec2& b) {
    return std::none_of(block.edges.begin(), block.edges.end(), [&](const Edge& edge) {
        return segments_meet(a, b, edge_start(system, edge), edge_end(system, edge));
    });
}

/// Inserts a hole into the polygon at the shortest bridge that crosses no edge.
void join_hole(const BlockSystem& system, const Block& block, std::pair<int, int> hole, std::vector<int>& polygon) {
    std::size_t best_outer = 0;
    int best_inner = hole.first;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t outer = 0; outer < polygon.size(); ++outer) {
        for (int inner = hole.first; inner < hole.second; ++inner) {
            const Vec2& a = place(system, block, polygon[outer]);
            const Vec2& b = place(system, block, inner);
            const double length = (b - a).squaredNorm();
            if (length >= best || !bridge_is_free(system, block, a, b)) continue;
            best = length;
            best_outer = outer;
            best_inner = inner;
        }
    }
    std::vector<int> bridged;
    for (int edge = best_inner; edge < hole.second; ++edge) bridged.push_back(edge);
    for (int edge = hole.first; edge <= best_inner; ++edge) bridged.push_back(edge);
    bridged.push_back(polygon[best_outer]);
    polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(best_outer) + 1, bridged.begin(), bridged.end());
}

} // namespace

std::vector<std::size_t> first_vertices(const BlockSystem& system) {
    std::vector<std::size_t> first{0};
    first.reserve(system.blocks.size() + 1);
    for (const Block& block : system.blocks) first.push_back(first.back() + block.edges.size());
    return first;
}

std::vector<std::pair<int, int>> loop_ranges(const Block& block) {
    std::vector<std::pair<int, int>> ranges;
    for (std::size_t i = 0; i < block.loop_starts.size(); ++i) {
        const bool last = i + 1 == block.loop_starts.size();
        ranges.emplace_back(block.loop_starts[i],
                            last ? static_cast<int>(block.edges.size()) : block.loop_starts[i + 1]);
    }
    return ranges;
}

int next_edge(const Block& block, int edge) {
    for (const auto& [begin, end] : loop_ranges(block))
        if (edge >= begin && edge < end) return edge + 1 < end ? edge + 1 : begin;
    return edge;
}

std::vector<int> keyhole_polygon(const BlockSystem& system, const Block& block) {
    const auto loops = loop_ranges(block);
    std::vector<int> polygon;
    if (loops.empty()) return polygon;
    for (int edge = loops.front().first; edge < loops.front().second; ++edge) polygon.push_back(edge);
    for (std::size_t i = 1; i < loops.size(); ++i) join_hole(system, block, loops[i], polygon);
    return polygon;
}

InterfaceMotion interface_motion(const BlockSystem& system, const std::vector<std::size_t>& first,
                                 const std::vector<Vec2>& displacement, const Interface& interface) {
    const Block& a = system.blocks[interface.block_a];
    const Block& b = system.blocks[interface.block_b];
    const std::size_t first_a = first[interface.block_a];
    const std::size_t first_b = first[interface.block_b];
    InterfaceMotion motion;
    motion.start_a = displacement[first_a + interface.edge_a];
    motion.end_a = displacement[first_a + next_edge(a, interface.edge_a)];
    motion.start_b = displacement[first_b + next_edge(b, interface.edge_b)];
    motion.end_b = displacement[first_b + interface.edge_b];
    return motion;
}

} // namespace kluft

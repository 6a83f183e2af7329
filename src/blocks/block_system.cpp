#include "kluft/blocks/block_system.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace kluft {

namespace {

constexpr double small_block = 4.0; ///< times smaller than the net's cells: from there on its own size limits a block

} // namespace

double spacing_of(const Block& block) { return std::sqrt(2.0 * block.area / std::numbers::sqrt3); }

bool is_cell_of_net(const BlockSystem& system, const Block& block) {
    constexpr double largest_cell = 2.0; // in spacings of the net
    return spacing_of(block) <= largest_cell * system.spacing;
}

double motion_scale(const BlockSystem& system, const Block& block) {
    return std::min(system.spacing, small_block * spacing_of(block));
}

void compute_block_moments(const std::vector<Vec2>& vertices, Block& block) {
    block.area = 0.0;
    block.centroid.setZero();
    block.second_moment.setZero();
    block.size = 0.0;
    if (block.edges.empty()) return;

    // About the first vertex, so that the place of the block costs no digits. For the triangle (0, a, b), with twice
    // its area w = a x b: integral of X = w (a + b)/6, of X X^T = w/24 (a a^T + b b^T + (a + b)(a + b)^T).
    const Vec2 from = vertices[block.edges.front().start];
    double twice = 0.0;
    Vec2 first = Vec2::Zero();
    Mat2 second = Mat2::Zero();
    for (const Edge& edge : block.edges) {
        const Vec2 a = vertices[edge.start] - from;
        const Vec2 b = vertices[edge.end] - from;
        const double w = cross(a, b);
        const Vec2 sum = a + b;
        twice += w;
        first += w / 6.0 * sum;
        second += w / 24.0 * (a * a.transpose() + b * b.transpose() + sum * sum.transpose());
    }
    block.area = 0.5 * twice;
    const Vec2 centre = first / block.area;
    block.centroid = from + centre;
    block.size = std::sqrt(block.area);
    block.second_moment = second - block.area * (centre * centre.transpose());
}

double area_of(const BlockSystem& system) {
    return std::accumulate(system.blocks.begin(), system.blocks.end(), 0.0,
                           [](double sum, const Block& block) { return sum + block.area; });
}

double edges_per_triangle_area(const BlockSystem& system) {
    double area = 0.0;
    for (const Block& block : system.blocks)
        if (block.edges.size() == 3) area += block.area / (system.spacing * system.spacing);
    double edges = 0.0;
    for (const Interface& interface : system.interfaces) {
        if (interface.origin != EdgeOrigin::tessellation) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        const double d = interface.spacing > 0.0 ? interface.spacing : system.spacing;
        edges += (edge_end(system, edge) - edge_start(system, edge)).norm() * d / (system.spacing * system.spacing);
    }
    return area > 0.0 ? edges / area : 0.0;
}

} // namespace kluft

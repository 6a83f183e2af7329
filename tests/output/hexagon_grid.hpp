// A body of whole hexagons, made by hand, with fields that are known in closed form.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "kluft/blocks/block_system.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft::testing {

/// n_x times n_y pointed hexagons of the given spacing (m). Vertices are shared by way of integer lattice indices:
/// x in units of spacing/2, y in units of spacing/(2 sqrt(3)).
inline BlockSystem hexagon_grid(int n_x, int n_y, double spacing, const Vec2& origin = Vec2::Zero()) {
    BlockSystem system;
    system.spacing = spacing;
    system.origin = origin;
    std::map<std::pair<int, int>, int> vertex_of;
    std::map<std::pair<int, int>, std::pair<int, int>> edge_of; // (start, end) -> (block, edge)
    const std::array<std::pair<int, int>, 6> corners{{{1, -1}, {1, 1}, {0, 2}, {-1, 1}, {-1, -1}, {0, -2}}};
    for (int row = 0; row < n_y; ++row)
        for (int column = 0; column < n_x; ++column) {
            Block block;
            block.loop_starts = {0};
            block.area = 0.5 * std::sqrt(3.0) * spacing * spacing;
            block.size = std::sqrt(block.area);
            const int i = 2 * column + row % 2 + 1;
            const int j = 3 * row + 2;
            block.centroid = {0.5 * spacing * i, spacing / (2.0 * std::sqrt(3.0)) * j};
            std::array<int, 6> indices{};
            for (std::size_t k = 0; k < 6; ++k) {
                const std::pair key{i + corners[k].first, j + corners[k].second};
                const auto [found, is_new] = vertex_of.try_emplace(key, static_cast<int>(system.vertices.size()));
                if (is_new)
                    system.vertices.emplace_back(0.5 * spacing * key.first,
                                                 spacing / (2.0 * std::sqrt(3.0)) * key.second);
                indices[k] = found->second;
            }
            for (std::size_t k = 0; k < 6; ++k) {
                Edge edge{indices[k], indices[(k + 1) % 6], -1, -1};
                const int block_index = static_cast<int>(system.blocks.size());
                if (const auto other = edge_of.find({edge.end, edge.start}); other != edge_of.end()) {
                    const auto [block_a, edge_a] = other->second;
                    edge.interface = static_cast<int>(system.interfaces.size());
                    system.blocks[block_a].edges[edge_a].interface = edge.interface;
                    system.interfaces.push_back(
                        {block_a, edge_a, block_index, static_cast<int>(k), EdgeOrigin::tessellation, -1, 0});
                }
                edge_of[{edge.start, edge.end}] = {block_index, static_cast<int>(k)};
                block.edges.push_back(edge);
            }
            system.blocks.push_back(block);
        }
    for (const Vec2& vertex : system.vertices) {
        system.lower = system.lower.cwiseMin(vertex);
        system.upper = system.upper.cwiseMax(vertex);
    }
    return system;
}

/// Fields of the affine motion u(X) = gradient X with one stress everywhere; every interface bonded and locked.
inline FieldRecord affine_fields(const BlockSystem& system, const Mat2& gradient, const Mat2& stress) {
    FieldRecord fields;
    for (const Block& block : system.blocks) {
        for (const Edge& edge : block.edges) fields.displacement.push_back(gradient * edge_start(system, edge));
        fields.stress.push_back(stress);
        fields.stress_zz.push_back(0.0);
    }
    fields.interfaces.resize(system.interfaces.size());
    for (auto& interface : fields.interfaces) interface.bonded = true;
    return fields;
}

/// A square block [0, 3]^2 with a square hole [1, 2]^2, alone.
inline BlockSystem block_with_hole() {
    BlockSystem system;
    system.vertices = {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {1, 1}, {1, 2}, {2, 2}, {2, 1}};
    Block block;
    block.loop_starts = {0, 4};
    for (int i = 0; i < 4; ++i) block.edges.push_back({i, (i + 1) % 4, -1, -1});
    for (int i = 0; i < 4; ++i) block.edges.push_back({4 + i, 4 + (i + 1) % 4, -1, -1});
    block.area = 8.0;
    block.size = std::sqrt(8.0);
    block.centroid = {1.5, 1.5};
    system.blocks = {block};
    system.upper = {3.0, 3.0};
    system.spacing = 1.0;
    return system;
}

} // namespace kluft::testing

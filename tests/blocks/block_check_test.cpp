#include "kluft/blocks/block_check.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"

namespace kluft {
namespace {

/// Four blocks around a vertex.
BlockSystem sound_system() {
    GeometrySpec spec = cut_scenes::rectangle(2, 2);
    cut_scenes::add_trace(spec, {{0, 1}, {2, 1}});
    cut_scenes::add_trace(spec, {{1, 0}, {1, 2}});
    return cut_blocks(spec).system;
}

TEST(BlockCheck, FindsNothingInASoundSystem) {
    EXPECT_TRUE(check_block_system(sound_system(), {.domain_area = 4.0, .minimum_area = 1.0}).empty());
}

TEST(BlockCheck, SeesWhatItExpects) {
    EXPECT_EQ(check_block_system(sound_system(), {.domain_area = 4.0 + 1e-9}).size(), 1U);
    EXPECT_EQ(check_block_system(sound_system(), {.minimum_area = 1.1}).size(), 4U);
}

// Each of these breaks one thing in a sound system.
TEST(BlockCheck, HasASentenceForEveryFault) {
    using Fault = std::function<void(BlockSystem&)>;
    const std::vector<std::pair<std::string, Fault>> faults{
        {"does not close", [](BlockSystem& s) { s.blocks[0].edges[0].end = s.blocks[0].edges[1].end; }},
        {"vertex that does not exist", [](BlockSystem& s) { s.blocks[1].edges[0].end = 99; }},
        {"interface that does not exist", [](BlockSystem& s) { s.blocks[1].edges[0].interface = 99; }},
        {"boundary that does not exist", [](BlockSystem& s) { s.blocks[1].edges[0].boundary = 99; }},
        {"edge that does not exist", [](BlockSystem& s) { s.interfaces[0].edge_b = 4; }},
        {"no outline", [](BlockSystem& s) { s.blocks[0].loop_starts.clear(); }},
        {"is not simple",
         [](BlockSystem& s) {
             const Edge edge = s.blocks[0].edges[0];
             std::swap(s.vertices[edge.start], s.vertices[edge.end]);
         }},
        {"wrong way round",
         [](BlockSystem& s) {
             Block& block = s.blocks[0];
             std::reverse(block.edges.begin(), block.edges.end());
             for (Edge& edge : block.edges) std::swap(edge.start, edge.end);
         }},
        {"moments", [](BlockSystem& s) { s.blocks[2].centroid.x() += 1e-6; }},
        {"moments", [](BlockSystem& s) { s.blocks[2].size *= 1.0001; }},
        {"do not name it", [](BlockSystem& s) { std::swap(s.interfaces[0], s.interfaces[1]); }},
        {"do not match",
         [](BlockSystem& s) {
             const Interface joint = s.interfaces[0];
             Edge& edge = s.blocks[joint.block_b].edges[joint.edge_b];
             std::swap(edge.start, edge.end);
         }},
        {"both sides", [](BlockSystem& s) { s.interfaces[0].block_b = s.interfaces[0].block_a; }},
        {"lies on a boundary",
         [](BlockSystem& s) {
             const Interface joint = s.interfaces[0];
             s.blocks[joint.block_b].edges[joint.edge_b].boundary = 0;
         }},
        {"on the outline", [](BlockSystem& s) { s.interfaces[0].origin = EdgeOrigin::boundary; }},
        {"on a fracture", [](BlockSystem& s) { s.interfaces[0].fracture = -1; }},
        {"neighbour and no interface",
         [](BlockSystem& s) {
             for (Block& block : s.blocks) {
                 for (Edge& edge : block.edges) edge.interface = edge.interface == 0 ? -1 : edge.interface;
             }
         }},
        {"belongs to two blocks", [](BlockSystem& s) { s.blocks.push_back(s.blocks[0]); }},
        {"does not name it", [](BlockSystem& s) { std::swap(s.boundaries[0], s.boundaries[1]); }},
        {"boundaries list", [](BlockSystem& s) { s.boundaries[0].edges.pop_back(); }},
        {"no block uses vertex", [](BlockSystem& s) { s.vertices.emplace_back(0.5, 0.5); }},
    };
    for (const auto& [expected, break_it] : faults) {
        BlockSystem system = sound_system();
        break_it(system);
        std::string text;
        for (const std::string& sentence : check_block_system(system)) text += sentence + '\n';
        EXPECT_NE(text.find(expected), std::string::npos) << "expected: " << expected << "\nfound: " << text;
    }
}

// A block in a hole of another: a hole that leaves the outline, and one that runs the wrong way round.
TEST(BlockCheck, LooksAtHoles) {
    GeometrySpec spec = cut_scenes::rectangle(4, 4);
    cut_scenes::add_trace(spec, {{1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}});
    const BlockSystem sound = cut_blocks(spec).system;
    EXPECT_TRUE(check_block_system(sound, {.domain_area = 16.0}).empty());
    BlockSystem moved = sound;
    for (Vec2& p : moved.vertices) {
        if (p.x() > 0.5 && p.x() < 2.5) p.x() += 3.0;
    }
    std::string text;
    for (const std::string& sentence : check_block_system(moved)) text += sentence + '\n';
    EXPECT_NE(text.find("leaves its outline"), std::string::npos) << text;
}

} // namespace
} // namespace kluft

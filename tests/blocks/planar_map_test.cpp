#include "kluft/blocks/planar_map.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "kluft/blocks/arrangement.hpp"

namespace kluft {
namespace {

/// 3 x 1 unit squares; the vertical line at x = i has the source i.
PlanarMap three_squares() {
    std::vector<SourceSegment> segments{{{0, 0}, {3, 0}, 10}, {{0, 1}, {3, 1}, 11}};
    for (int i = 0; i <= 3; ++i) segments.push_back({{i * 1.0, 0.0}, {i * 1.0, 1.0}, i});
    return arrange(segments);
}

void expect_linked(PlanarMap& map) {
    for (int h = 0; h < 2 * map.n_edges(); ++h) {
        if (map.alive[PlanarMap::edge_of(h)] == 0) continue;
        EXPECT_EQ(map.previous(map.next(h)), h);
        EXPECT_EQ(map.start(map.next(h)), map.end(h));
        EXPECT_EQ(map.face(map.next(h)), map.face(h));
    }
    for (int v = 0; v < static_cast<int>(map.positions.size()); ++v) {
        for (const int h : map.star(v)) EXPECT_EQ(map.start(h), v);
    }
}

int half_edge_at(const PlanarMap& map, const Vec2& a, const Vec2& b) {
    for (int h = 0; h < 2 * map.n_edges(); ++h) {
        const bool there = map.positions[map.start(h)] == a && map.positions[map.end(h)] == b;
        if (there && map.alive[PlanarMap::edge_of(h)] != 0) return h;
    }
    return -1;
}

TEST(PlanarMap, MergingFacesRemovesAllEdgesBetweenThem) {
    PlanarMap map = three_squares();
    const int middle = half_edge_at(map, {1, 0}, {1, 1});
    const int left = map.face(middle);
    const int right = map.face(PlanarMap::twin(middle));
    map.merge_faces(left, right);
    expect_linked(map);
    EXPECT_DOUBLE_EQ(map.area(left), 2.0);
    EXPECT_TRUE(map.half_edges_of(right).empty());
    EXPECT_EQ(half_edge_at(map, {1, 0}, {1, 1}), -1);
    EXPECT_EQ(map.loops(left).size(), 1U);
    EXPECT_EQ(map.loops(left)[0].size(), 6U);
}

TEST(PlanarMap, DissolvingAVertexJoinsItsTwoEdges) {
    PlanarMap map = three_squares();
    const int middle = half_edge_at(map, {1, 0}, {1, 1});
    const int foot = map.start(middle);
    const int face = map.face(middle);
    map.merge_faces(face, map.face(PlanarMap::twin(middle)));
    ASSERT_EQ(map.degree(foot, 5), 2);
    map.dissolve_vertex(foot);
    expect_linked(map);
    EXPECT_EQ(map.degree(foot, 5), 0);
    EXPECT_GE(half_edge_at(map, {0, 0}, {2, 0}), 0);
    EXPECT_DOUBLE_EQ(map.area(face), 2.0);
    EXPECT_EQ(map.loops(face)[0].size(), 5U);
}

TEST(PlanarMap, ContractingAnEdgeMovesItsEndToItsStart) {
    PlanarMap map = three_squares();
    const int h = half_edge_at(map, {0, 0}, {1, 0});
    const int face = map.face(h);
    const int kept = map.contract_edge(h);
    expect_linked(map);
    EXPECT_EQ(map.positions[kept], Vec2(0, 0));
    EXPECT_EQ(map.degree(kept, 9), 3);
    EXPECT_DOUBLE_EQ(map.area(face), 0.5);
    EXPECT_DOUBLE_EQ(map.area(map.face(half_edge_at(map, {0, 0}, {2, 0}))), 1.5);
}

TEST(PlanarMap, EdgesInsideAFaceAreTheOnesThatSeparateNothing) {
    PlanarMap map = arrange({{{0, 0}, {4, 0}, 0},
                             {{4, 0}, {4, 4}, 0},
                             {{4, 4}, {0, 0}, 0},
                             {{3, 1}, {3, 2}, 1},
                             {{4, 2}, {9, 2}, 1},
                             {{4, 3}, {3.5, 3}, 1}});
    ASSERT_EQ(map.n_edges(), 8);
    map.remove_edges_inside_faces();
    expect_linked(map);
    EXPECT_EQ(std::count(map.alive.begin(), map.alive.end(), 1), 5);
}

TEST(PlanarMap, ALoopThatPassesAVertexTwiceIsSplitThere) {
    PlanarMap map = arrange({{{0, 0}, {4, 0}, 0},
                             {{4, 0}, {4, 4}, 0},
                             {{4, 4}, {0, 4}, 0},
                             {{0, 4}, {0, 0}, 0},
                             {{0, 0}, {2, 1}, 1},
                             {{2, 1}, {1, 2}, 1},
                             {{1, 2}, {0, 0}, 1}});
    int n_split = 0;
    for (int f = 1; f < map.n_faces(); ++f) {
        const auto loops = map.loops(f);
        if (loops.size() != 2) continue;
        ++n_split;
        const double a = map.loop_area(loops[0]);
        const double b = map.loop_area(loops[1]);
        EXPECT_DOUBLE_EQ(std::max(a, b), 16.0);
        EXPECT_DOUBLE_EQ(std::min(a, b), -1.5);
    }
    EXPECT_EQ(n_split, 1);
}

} // namespace
} // namespace kluft

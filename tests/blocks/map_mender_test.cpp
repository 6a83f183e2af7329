#include "kluft/blocks/map_mender.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "kluft/blocks/arrangement.hpp"

namespace kluft {
namespace {

constexpr int fracture = 10;
constexpr int tessellation = 20;

std::vector<SourceSegment> square(double side) {
    return {{{0, 0}, {side, 0}, 0}, {{side, 0}, {side, side}, 1}, {{side, side}, {0, side}, 2}, {{0, side}, {0, 0}, 3}};
}

/// The faces of the segments within the outline (face 0 is what lies beyond it).
PlanarMap body_of(const std::vector<SourceSegment>& segments) {
    PlanarMap map = arrange(segments);
    for (const int h : map.faces[0]) map.half_edges[h].face = PlanarMap::outside;
    map.faces[0] = {};
    map.remove_edges_inside_faces();
    return map;
}

MendLimits limits(double area, double edge) {
    return {.area = area, .edge = edge, .rounding = 1e-14, .first_fracture = fracture, .tessellation = tessellation};
}

int n_faces(PlanarMap& map) {
    int count = 0;
    for (int f = 0; f < map.n_faces(); ++f) count += map.half_edges_of(f).empty() ? 0 : 1;
    return count;
}

double length_of(const PlanarMap& map, int source) {
    double length = 0.0;
    for (int e = 0; e < map.n_edges(); ++e) {
        if (map.alive[e] != 0 && map.sources[e] == source) length += map.length(2 * e);
    }
    return length;
}

// A strip between a fracture at x = 1 and a hexagon edge at x = 1.1: it leaves across the latter.
TEST(MapMender, ASliverLeavesAcrossTheTessellation) {
    std::vector<SourceSegment> segments = square(4);
    segments.push_back({{1, 0}, {1, 4}, fracture});
    segments.push_back({{1.1, 0}, {1.1, 4}, tessellation});
    PlanarMap map = body_of(segments);
    const MendReport report = mend(map, limits(0.5, 0.0));
    ASSERT_EQ(report.merged.size(), 1U);
    EXPECT_NEAR(report.merged[0].area, 0.4, 1e-14);
    EXPECT_NEAR(report.merged[0].at.x(), 1.05, 1e-14);
    EXPECT_EQ(n_faces(map), 2);
    EXPECT_DOUBLE_EQ(length_of(map, fracture), 4.0);
    EXPECT_DOUBLE_EQ(length_of(map, tessellation), 0.0);
}

// Between two fractures the longer of its edges goes.
TEST(MapMender, WithoutTessellationASliverLeavesAcrossItsLongestEdge) {
    std::vector<SourceSegment> segments = square(4);
    segments.push_back({{1, 0}, {1, 4}, fracture});
    segments.push_back({{1.1, 0}, {1.2, 4}, fracture + 1});
    PlanarMap map = body_of(segments);
    EXPECT_EQ(mend(map, limits(1.0, 0.0)).merged.size(), 1U);
    EXPECT_DOUBLE_EQ(length_of(map, fracture), 4.0);
    EXPECT_DOUBLE_EQ(length_of(map, fracture + 1), 0.0);
}

TEST(MapMender, SliversThatTogetherAreLargeEnoughStay) {
    std::vector<SourceSegment> segments = square(4);
    for (const double x : {0.1, 0.2, 0.3}) segments.push_back({{x, 0}, {x, 4}, tessellation});
    PlanarMap map = body_of(segments);
    EXPECT_EQ(mend(map, limits(0.7, 0.0)).merged.size(), 2U);
    EXPECT_EQ(n_faces(map), 2);
}

// The foot of a fracture at 0.01 from the corner moves into the corner, which stays.
TEST(MapMender, AShortEdgeAtACornerCollapsesIntoTheCorner) {
    std::vector<SourceSegment> segments = square(4);
    segments.push_back({{0.01, 0}, {2, 4}, fracture});
    PlanarMap map = body_of(segments);
    EXPECT_EQ(mend(map, limits(0.0, 0.02)).collapsed_edges, 1);
    EXPECT_EQ(n_faces(map), 2);
    std::vector<double> areas;
    for (int f = 0; f < map.n_faces(); ++f) {
        if (!map.half_edges_of(f).empty()) areas.push_back(map.area(f));
    }
    std::sort(areas.begin(), areas.end());
    EXPECT_DOUBLE_EQ(areas[0], 4.0);
    EXPECT_DOUBLE_EQ(areas[1], 12.0);
}

// A short side of the outline between two corners stays, and so does a triangle.
TEST(MapMender, WhatCannotCollapseStays) {
    std::vector<SourceSegment> segments{{{0, 0}, {4, 0}, 0},
                                        {{4, 0}, {4, 4}, 1},
                                        {{4, 4}, {0.01, 4}, 2},
                                        {{0.01, 4}, {0, 3.99}, 3},
                                        {{0, 3.99}, {0, 0}, 4}};
    segments.push_back({{2, 0}, {2, 4}, fracture});
    PlanarMap map = body_of(segments);
    EXPECT_EQ(mend(map, limits(0.0, 0.02)).collapsed_edges, 0);
    std::vector<SourceSegment> needle = square(4);
    needle.push_back({{2, 0}, {2, 4}, fracture});
    needle.push_back({{2.01, 0}, {2, 4}, fracture + 1});
    PlanarMap with_needle = body_of(needle);
    EXPECT_EQ(mend(with_needle, limits(0.0, 0.02)).collapsed_edges, 0);
    EXPECT_EQ(n_faces(with_needle), 3);
}

TEST(MapMender, VerticesInStraightEdgesOfOneSourceGo) {
    std::vector<SourceSegment> segments = square(4);
    segments.push_back({{0, 1}, {2, 1}, fracture});
    segments.push_back({{2, 1}, {4, 1}, fracture});
    segments.push_back({{0, 2}, {2, 2}, fracture});
    segments.push_back({{2, 2}, {4, 2}, fracture + 1});
    segments.push_back({{0, 3}, {2, 3.5}, fracture});
    segments.push_back({{2, 3.5}, {4, 3}, fracture});
    PlanarMap map = body_of(segments);
    static_cast<void>(mend(map, limits(0.0, 0.0)));
    const auto n_alive = [&map](int source) {
        int count = 0;
        for (int e = 0; e < map.n_edges(); ++e) count += map.alive[e] != 0 && map.sources[e] == source ? 1 : 0;
        return count;
    };
    EXPECT_EQ(n_alive(fracture), 1 + 1 + 2); // straight, up to where the other fracture takes over, with a bend
    EXPECT_EQ(n_alive(fracture + 1), 1);
}

double freed_length(const MendReport& report, int source) {
    double length = 0.0;
    for (const SourceSegment& piece : report.freed) length += piece.source == source ? (piece.b - piece.a).norm() : 0.0;
    return length;
}

// A strip that ends inside the body leaves across one of its long sides; the other one and both ends, which join it
// with what goes on from there, are free.
TEST(MapMender, OfAStripInsideAFaceOneSideIsFreed) {
    std::vector<SourceSegment> segments = square(4);
    segments.push_back({{1, 2}, {3, 2}, fracture});
    segments.push_back({{1, 2.05}, {3, 2.05}, fracture + 1});
    segments.push_back({{1, 2}, {1, 2.05}, fracture + 2});
    segments.push_back({{3, 2}, {3, 2.05}, fracture + 2});
    PlanarMap map = body_of(segments);
    const MendReport report = mend(map, limits(0.2, 0.1));
    EXPECT_EQ(report.merged.size(), 1U);
    EXPECT_EQ(n_faces(map), 1);
    EXPECT_NEAR(freed_length(report, fracture) + freed_length(report, fracture + 1), 2.0, 1e-14);
    EXPECT_NEAR(freed_length(report, fracture + 2), 2 * 0.05, 1e-14);
}

// One trace that turns round a bend of 90 degrees and comes back at a distance of 0.05: lengths of its sides are
// 2 x 2 and 2 x 1.95, and it is closed by ends of 0.05. One whole side is left, not one leg of each.
TEST(MapMender, ASideGoesOnRoundABendButNotRoundTheEndOfAStrip) {
    std::vector<SourceSegment> segments = square(4);
    const std::vector<Vec2> hairpin{{1, 3}, {1, 1}, {3, 1}, {3, 1.05}, {1.05, 1.05}, {1.05, 3}, {1, 3}};
    for (std::size_t i = 0; i + 1 < hairpin.size(); ++i) segments.push_back({hairpin[i], hairpin[i + 1], fracture});
    PlanarMap map = body_of(segments);
    const MendReport report = mend(map, limits(0.5, 0.1));
    EXPECT_EQ(n_faces(map), 1);
    EXPECT_NEAR(freed_length(report, fracture), 2 * 1.95 + 2 * 0.05, 1e-12);
}

} // namespace
} // namespace kluft

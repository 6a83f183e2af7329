#include "kluft/blocks/arrangement.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(Arrangement, OfTwoCrossingSegmentsHasFourEdgesAndOneFace) {
    const PlanarMap map = arrange({{{0, 0}, {2, 2}, 3}, {{0, 2}, {2, 0}, 5}});
    EXPECT_EQ(map.n_edges(), 4);
    EXPECT_EQ(map.n_faces(), 1);
    EXPECT_EQ(map.positions.size(), 5U);
    EXPECT_EQ(std::count(map.sources.begin(), map.sources.end(), 3), 2);
    EXPECT_EQ(std::count(map.sources.begin(), map.sources.end(), 5), 2);
}

TEST(Arrangement, OverlapsBelongToTheSmallestSourceInAnyOrder) {
    std::vector<SourceSegment> segments{{{0, 0}, {2, 0}, 9}, {{1, 0}, {3, 0}, 4}, {{3, 0}, {1.5, 0}, 2}};
    std::sort(segments.begin(), segments.end(), [](const auto& a, const auto& b) { return a.source < b.source; });
    do {
        const PlanarMap map = arrange(segments);
        ASSERT_EQ(map.n_edges(), 4); // 0-1, 1-1.5, 1.5-2, 2-3
        for (int h = 0; h < 2 * map.n_edges(); h += 2) {
            const double middle = 0.5 * (map.positions[map.start(h)].x() + map.positions[map.end(h)].x());
            EXPECT_EQ(map.source(h), middle < 1.0 ? 9 : (middle < 1.5 ? 4 : 2));
        }
    } while (std::next_permutation(segments.begin(), segments.end(),
                                   [](const auto& a, const auto& b) { return a.source < b.source; }));
}

TEST(Arrangement, LeavesSegmentsWithoutLengthOut) {
    const PlanarMap map = arrange({{{1, 1}, {1, 1}, 0}});
    EXPECT_EQ(map.n_edges(), 0);
    EXPECT_EQ(map.n_faces(), 1);
}

// Half-edges are linked consistently: next and previous are inverse, a half-edge ends where its next starts.
TEST(Arrangement, LinksItsHalfEdges) {
    const PlanarMap map = arrange(
        {{{0, 0}, {4, 0}, 0}, {{4, 0}, {4, 4}, 1}, {{4, 4}, {0, 0}, 2}, {{3, 1}, {3, 2}, 3}, {{2, -1}, {2, 5}, 4}});
    for (int h = 0; h < 2 * map.n_edges(); ++h) {
        EXPECT_EQ(map.previous(map.next(h)), h);
        EXPECT_EQ(map.start(map.next(h)), map.end(h));
        EXPECT_EQ(map.face(map.next(h)), map.face(h));
    }
    for (std::size_t v = 0; v < map.positions.size(); ++v) EXPECT_EQ(map.start(map.outgoing[v]), static_cast<int>(v));
}

// Nearly parallel segments: x = 2/3 exactly on y = 2^-40 x and y = 2^-41 (1 - x/2) + 2^-42 x... crossing by the ratio of
// the end distances: differences 1 and -2 in units of 2^-40 at x = 0 and x = 3, so x = 1 exactly.
TEST(Arrangement, RoundsCrossingsToTheNearestDouble) {
    const double unit = std::ldexp(1.0, -40);
    const PlanarMap map = arrange({{{0, unit}, {3, 0}, 0}, {{0, 0}, {3, 2 * unit}, 1}});
    ASSERT_EQ(map.positions.size(), 5U);
    const auto crossing = std::find_if(map.positions.begin(), map.positions.end(),
                                       [](const Vec2& p) { return p.x() > 0.0 && p.x() < 3.0; });
    EXPECT_EQ(crossing->x(), 1.0);
    EXPECT_NEAR(crossing->y(), 2.0 * unit / 3.0, 1e-16 * unit);
}

} // namespace
} // namespace kluft

#include "kluft/geometry/segment_grid.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "kluft/geometry/predicates.hpp"

namespace kluft {
namespace {

// Asking every segment gives the same nearest distance.
TEST(SegmentGrid, FindsTheNearestSegmentWithinTheLimit) {
    std::mt19937_64 random(5);
    const auto unit = [&random] { return static_cast<double>(random() >> 11U) * 0x1.0p-53; };
    for (int round = 0; round < 20; ++round) {
        std::vector<SegmentGrid::Segment> segments;
        const double length = round % 2 == 0 ? 0.05 : 5.0;
        for (int i = 0; i < 200; ++i) {
            const Vec2 a(10.0 * unit(), 3.0 * unit());
            segments.emplace_back(a, a + length * Vec2(unit() - 0.5, i % 5 == 0 ? 0.0 : unit() - 0.5));
        }
        const SegmentGrid grid(segments);
        for (int i = 0; i < 300; ++i) {
            const double farther = i % 3 == 0 ? 20.0 : 1.0; // also far beyond what the grid covers
            const Vec2 p = farther * Vec2(12.0 * unit() - 1.0, 5.0 * unit() - 1.0);
            const double limit = (i % 2 == 0 ? 0.3 : 60.0) * unit();
            double least = std::numeric_limits<double>::infinity();
            for (const auto& [a, b] : segments) least = std::min(least, distance_to_segment(p, a, b));
            EXPECT_EQ(grid.distance(p, limit), least <= limit ? least : std::numeric_limits<double>::infinity());
        }
    }
}

// Every segment with a point in the box is found, each once and in order, also by many questions with the same marks.
TEST(SegmentGrid, FindsWhatIsNearABoxWithMarksAsWithout) {
    std::mt19937_64 random(6);
    const auto unit = [&random] { return static_cast<double>(random() >> 11U) * 0x1.0p-53; };
    std::vector<SegmentGrid::Segment> segments;
    for (int i = 0; i < 300; ++i) {
        const Vec2 a(unit(), unit());
        segments.emplace_back(a, i % 3 == 0 ? Vec2(a.x(), unit()) : Vec2(unit(), unit()));
    }
    const SegmentGrid grid(segments);
    std::vector<char> asked;
    for (int k = 0; k < 100; ++k) {
        const Box box = bounding_box({Vec2(unit(), unit()), Vec2(unit(), unit())});
        const std::vector<int> found = grid.near(box, asked);
        EXPECT_EQ(found, grid.near(box));
        for (int i = 0; i < 300; ++i) {
            const auto in_box = [&box](const Vec2& p) {
                return (p.array() >= box.lower.array()).all() && (p.array() <= box.upper.array()).all();
            };
            const bool has_end_there = in_box(segments[i].first) || in_box(segments[i].second);
            EXPECT_TRUE(!has_end_there || std::ranges::binary_search(found, i)) << i;
        }
    }
}

TEST(SegmentGrid, IsEmptyWithoutSegmentsAndHoldsASinglePoint) {
    EXPECT_TRUE(SegmentGrid({}).near({Vec2(0, 0), Vec2(1, 1)}).empty());
    const SegmentGrid point({{Vec2(2, 3), Vec2(2, 3)}});
    EXPECT_DOUBLE_EQ(point.distance({2, 4}, 1.5), 1.0);
}

} // namespace
} // namespace kluft

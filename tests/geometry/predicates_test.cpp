#include "kluft/geometry/predicates.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace kluft {
namespace {

TEST(Orientation, IsPositiveToTheLeft) {
    EXPECT_EQ(orientation({0, 0}, {1, 0}, {0, 1}), 1);
    EXPECT_EQ(orientation({0, 0}, {1, 0}, {0, -1}), -1);
    EXPECT_EQ(orientation({0, 0}, {1, 1}, {3, 3}), 0);
}

// Points a few units of the last place beside the line y = x: the side is the sign of the difference of the offsets.
// The plain formula gives hundreds of wrong signs on this grid (Kettner et al. 2008).
TEST(Orientation, IsExactWhereRoundingWouldDecide) {
    const double unit = std::ldexp(1.0, -53);
    for (int i = 0; i < 64; ++i) {
        for (int j = 0; j < 64; ++j) {
            const Vec2 p(0.5 + i * unit, 0.5 + j * unit);
            const int expected = j > i ? 1 : (j < i ? -1 : 0);
            ASSERT_EQ(orientation({12, 12}, {24, 24}, p), expected) << i << ' ' << j;
            ASSERT_EQ(orientation(p, {12, 12}, {24, 24}), expected) << i << ' ' << j;
            ASSERT_EQ(orientation({24, 24}, {12, 12}, p), -expected) << i << ' ' << j;
        }
    }
}

TEST(SegmentsMeet, AtCrossingsTouchesAndOverlaps) {
    EXPECT_TRUE(segments_meet({0, 0}, {2, 2}, {0, 2}, {2, 0}));
    EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {1, 5}));
    EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {2, 0}, {3, 1}));
    EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {5, 0}));
    EXPECT_TRUE(segments_meet({0, 0}, {9, 0}, {4, 0}, {5, 0}));
}

TEST(SegmentsMeet, NotBesideOrBeyond) {
    EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {3, 0}, {4, 0}));
    EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {0, 1}, {2, 1}));
    EXPECT_FALSE(segments_meet({0, 0}, {2, 2}, {2, 0}, {1.5, 0.5}));
    EXPECT_FALSE(segments_meet({0, 0}, {1, 0}, {0.5, 1e-300}, {0.5, 1}));
}

TEST(OnSegment, HoldsForItsEndsAndItsInteriorOnly) {
    EXPECT_TRUE(on_segment({0, 0}, {0, 0}, {3, 1}));
    EXPECT_TRUE(on_segment({1.5, 0.5}, {0, 0}, {3, 1}));
    EXPECT_FALSE(on_segment({6, 2}, {0, 0}, {3, 1}));
    EXPECT_FALSE(on_segment({1.5, std::nextafter(0.5, 1.0)}, {0, 0}, {3, 1}));
}

TEST(DistanceToSegment, IsThatOfTheFootOrOfTheNearerEnd) {
    EXPECT_DOUBLE_EQ(distance_to_segment({1, 2}, {0, 0}, {4, 0}), 2.0);
    EXPECT_DOUBLE_EQ(distance_to_segment({7, 4}, {0, 0}, {4, 0}), 5.0);
    EXPECT_DOUBLE_EQ(distance_to_segment({3, 4}, {0, 0}, {0, 0}), 5.0);
}

} // namespace
} // namespace kluft

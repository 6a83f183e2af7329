#include "kluft/blocks/fracture_trace.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "kluft/geometry/predicates.hpp"

namespace kluft {
namespace {

std::vector<SourceSegment> segments_of(const std::vector<SourceTrace>& traces) {
    std::vector<SourceSegment> segments;
    for (const SourceTrace& trace : traces) {
        for (std::size_t i = 0; i + 1 < trace.points.size(); ++i) {
            segments.push_back({trace.points[i], trace.points[i + 1], trace.source});
        }
    }
    return segments;
}

std::vector<SourceSegment> bridges(const std::vector<SourceTrace>& traces, double reach) {
    return bridge_ends(traces, segments_of(traces), reach);
}

TEST(BridgeEnds, CrossesWhatTheEndMissesByLittle) {
    const Vec2 a(0, 0);
    const Vec2 b(10, 3);
    for (const double missing : {0.05, 1e-5, 1e-10, 1e-15}) {
        const Vec2 end = Vec2(5, 1.5) + missing * Vec2(-3, 10).normalized();
        const auto found = bridges({{{a, b}, 0}, {{{4, 9}, end}, 1}}, 0.1);
        if (orientation(a, b, end) == 0) continue;
        ASSERT_EQ(found.size(), 1U) << missing;
        EXPECT_EQ(found[0].source, 1);
        EXPECT_EQ(found[0].a, end);
        EXPECT_TRUE(segments_meet(found[0].a, found[0].b, a, b));
        EXPECT_LE((found[0].b - end).norm(), 2.0 * missing + 1e-13);
    }
}

TEST(BridgeEnds, LeavesWideGapsAndClosedOnesAlone) {
    const SourceTrace through{{{0, 0}, {10, 0}}, 0};
    EXPECT_TRUE(bridges({through, {{{5, 0.2}, {5, 4}}, 1}}, 0.1).empty());
    EXPECT_TRUE(bridges({through, {{{5, 0}, {5, 4}}, 1}}, 0.1).empty());
    EXPECT_TRUE(bridges({through, {{{5, -0.05}, {5, 4}}, 1}}, 0.1).empty()); // crosses it already
}

TEST(BridgeEnds, GoesToTheNearestPointAlsoWhereThatIsAnEnd) {
    const auto found = bridges({{{{0, 0}, {10, 0}}, 0}, {{{10.03, 0.04}, {14, 4}}, 1}}, 0.1);
    ASSERT_EQ(found.size(), 2U); // from both sides
    EXPECT_EQ(found[0].b, Vec2(10.03, 0.04));
    EXPECT_EQ(found[1].b, Vec2(10, 0));
}

// Two traces with one tip, or with tips that differ in the last digits or cross there, which misses a line by as little: the
// tip has to reach the line all the same.
TEST(BridgeEnds, TracesThatEndTogetherAreJoinedWithWhatGoesOnThere) {
    const SourceTrace through{{{0, 0}, {10, 0}}, 0};
    const Vec2 tip(5, 1e-14);
    for (const Vec2& other_tip : {tip, Vec2(5 + 1e-13, 2e-14), Vec2(5 - 1e-13, 2e-14), Vec2(5.01, 0.02)}) {
        const auto found = bridges({through, {{tip, {1, 4}}, 1}, {{other_tip, {9, 4}}, 2}}, 0.1);
        for (const int source : {1, 2}) {
            const bool reaches = std::ranges::any_of(found, [&](const SourceSegment& bridge) {
                return bridge.source == source && segments_meet(bridge.a, bridge.b, {0, 0}, {10, 0});
            });
            EXPECT_TRUE(reaches) << source << ": " << other_tip.transpose();
        }
    }
    EXPECT_TRUE(bridges({{{{5, 3}, {1, 4}}, 1}, {{{5, 3}, {9, 4}}, 2}}, 0.1).empty()); // nothing else is near
}

TEST(BridgeEnds, ATraceMayCloseOnItselfButNotOnItsOwnStart) {
    const SourceTrace nearly_closed{{{0, 0}, {4, 0}, {4, 4}, {0.05, 0.02}}, 0};
    EXPECT_EQ(bridges({nearly_closed}, 0.1).size(), 2U);
    const SourceTrace fine_steps{{{0, 0}, {0.01, 0}, {0.02, 0.001}, {0.03, 0}, {3, 0}}, 0};
    EXPECT_TRUE(bridges({fine_steps}, 0.1).empty());
    const SourceTrace closed{{{0, 0}, {4, 0}, {4, 4}, {0, 0}}, 0};
    EXPECT_TRUE(bridges({closed}, 0.1).empty());
}

// The box has a diagonal of 5: segments are kept within 5 of it, and one that passes beyond splits the trace.
TEST(PartsNear, KeepsWhatIsNearAndSplitsWhatGoesFarAway) {
    const Box box{{0, 0}, {4, 3}};
    const std::vector<Vec2> inside{{-1, 1}, {2, 2}, {5, 1}};
    EXPECT_EQ(parts_near(box, inside), (std::vector<std::vector<Vec2>>{inside}));
    EXPECT_TRUE(parts_near(box, {{100, 0}, {100, 50}}).empty());
    const auto parts = parts_near(box, {{-1e9, 1}, {1e9, 1}, {1e9, 2}, {-1e9, 2}});
    ASSERT_EQ(parts.size(), 2U);
    ASSERT_EQ(parts[0].size(), 2U);
    ASSERT_EQ(parts[1].size(), 2U);
    constexpr double rounding = 1e-9; // that of the ends far away is 1e-7
    EXPECT_NEAR((parts[0][0] - Vec2(-5, 1)).norm(), 0.0, rounding);
    EXPECT_NEAR((parts[0][1] - Vec2(9, 1)).norm(), 0.0, rounding);
    EXPECT_NEAR((parts[1][0] - Vec2(9, 2)).norm(), 0.0, rounding);
    EXPECT_NEAR((parts[1][1] - Vec2(-5, 2)).norm(), 0.0, rounding);
}

} // namespace
} // namespace kluft

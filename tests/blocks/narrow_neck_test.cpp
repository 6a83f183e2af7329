#include "kluft/blocks/narrow_neck.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/blocks/block_check.hpp"
#include "kluft/blocks/block_cutter.hpp"

namespace kluft {
namespace {

/// A slope of 10 m with flat ground before its toe, which lies at the origin, and a joint of 40 degrees that passes below the toe.
BlockSystem slope_with_joint_below_toe(double depth, double reference_spacing = 0.0) {
    const double slope = std::tan(40.0 * std::numbers::pi / 180.0);
    GeometrySpec spec;
    spec.reference_spacing = reference_spacing;
    spec.domain = {{-10, -5}, {30, -5}, {30, 10}, {3, 10}, {0, 0}, {-10, 0}};
    cut_scenes::add_trace(spec, {{-12, -12 * slope - depth}, {20, 20 * slope - depth}});
    return cut_blocks(spec).system;
}

// The wedge before the joint, 44.6 m2, and the ground, which the joint cuts off below at 5 m, hang together by d cos 40.
TEST(NarrowNeck, IsFoundWhereAJointPassesBelowACorner) {
    for (const double depth : {1e-6, 1e-3, 0.03}) {
        const auto necks = narrow_necks(slope_with_joint_below_toe(depth));
        ASSERT_EQ(necks.size(), 1U) << depth;
        EXPECT_NEAR(necks[0].width, depth * std::cos(40.0 * std::numbers::pi / 180.0), 1e-6 * depth + 1e-14);
        const double of_ground = 10.0 * 5.0 - 0.5 * 5.0 * 5.0 / std::tan(40.0 * std::numbers::pi / 180.0);
        EXPECT_NEAR(necks[0].smaller_part, of_ground, 10.0 * depth + 0.01);
    }
}

// Above the toe, or far enough below it, nothing hangs together that narrowly.
TEST(NarrowNeck, IsNoneWhereBlocksAreParted) {
    for (const double depth : {-1e-3, 0.0, 0.5})
        EXPECT_THAT(narrow_necks(slope_with_joint_below_toe(depth)), testing::IsEmpty()) << depth;
}

// What is not resolved, round-off or 2 % of a spacing of 2 m, holds nothing together: rock below, wedge and ground are three blocks.
TEST(NarrowNeck, IsPartedWhereItIsNotResolved) {
    for (const auto& [depth, spacing] : {std::pair(1e-9, 0.0), std::pair(1e-9, 2.0), std::pair(1e-6, 2.0),
                                         std::pair(1e-3, 2.0), std::pair(0.03, 2.0)}) {
        const BlockSystem parted = slope_with_joint_below_toe(depth, spacing);
        EXPECT_EQ(parted.n_blocks(), 3) << depth;
        EXPECT_THAT(narrow_necks(parted), testing::IsEmpty()) << depth;
        EXPECT_THAT(check_block_system(parted), testing::IsEmpty()) << depth;
    }
}

// A digitised trace has a vertex there, bent towards the toe or away from it: its nearest point is an end of two of its segments.
TEST(NarrowNeck, IsPartedWhereATraceBendsBesideTheToe) {
    for (const Vec2& below : {Vec2(-5, -10), Vec2(-2, -12), Vec2(-11.9, -10)}) {
        GeometrySpec spec;
        spec.reference_spacing = 5.0;
        spec.domain = {{-10, -10}, {30, -10}, {30, 10}, {5.7735, 10}, {0, 0}, {-10, 0}};
        cut_scenes::add_trace(spec, {below, {0, -1e-3}, {14, 11.747}});
        const BlockSystem parted = cut_blocks(spec).system;
        EXPECT_EQ(parted.n_blocks(), 3) << below.transpose();
        EXPECT_THAT(narrow_necks(parted), testing::IsEmpty()) << below.transpose();
    }
}

} // namespace
} // namespace kluft

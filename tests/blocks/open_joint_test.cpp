#include "kluft/blocks/open_joint.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double same = 1e-9;

/// What lies before the upper side of a block of 1 m2, from (1, 0) to (0, 0), where another one of `size` (m) has this side.
std::vector<CoveredPart> covered_by(const Vec2& start, const Vec2& end, double size = 1.0) {
    return covered_parts({{{1, 0}, {0, 0}, 0}, {start, end, 1}}, 0, {0, 1}, {1.0, size}, same);
}

TEST(OpenJoint, CoversWhatLiesStraightBeforeASide) {
    const auto whole = covered_by({-1, 0.01}, {2, 0.01});
    ASSERT_THAT(whole, SizeIs(1));
    EXPECT_EQ(whole[0].from, 0.0);
    EXPECT_EQ(whole[0].to, 1.0);
    EXPECT_EQ(whole[0].other, 1);
    EXPECT_DOUBLE_EQ(whole[0].gap, 0.01);
    const auto half = covered_by({-1, 0.01}, {0.5, 0.01}); // the side runs to the left
    ASSERT_THAT(half, SizeIs(1));
    EXPECT_DOUBLE_EQ(half[0].from, 0.5 - 0.05) << "not below the other one's corner";
    EXPECT_EQ(half[0].to, 1.0);
}

TEST(OpenJoint, IsNarrowBesideTheSmallerBlock) {
    EXPECT_THAT(covered_by({0, 0.049}, {1, 0.049}), SizeIs(1));
    EXPECT_THAT(covered_by({0, 0.051}, {1, 0.051}), IsEmpty());
    EXPECT_THAT(covered_by({0, 0.049}, {1, 0.049}, 0.5), IsEmpty());
    EXPECT_THAT(covered_by({0, 0.049}, {1, 0.049}, 20.0), SizeIs(1));
    EXPECT_THAT(covered_by({0, -0.01}, {1, -0.01}), IsEmpty()) << "behind the side";
    EXPECT_THAT(covered_by({1, 0.01}, {0, 0.01}), IsEmpty()) << "faces away";
}

// A gap that opens by tan(angle) reaches a twentieth of the size at 0.05/tan(angle) from where it begins.
TEST(OpenJoint, EndsWhereItsSidesAreTooFarApart) {
    const auto opening_at = [](double degrees) {
        return covered_by({0, 0}, {1, std::tan(degrees * std::numbers::pi / 180.0)});
    };
    const auto wedge = opening_at(14.0);
    ASSERT_THAT(wedge, SizeIs(1));
    EXPECT_NEAR(wedge[0].from, 1.0 - 0.05 / std::tan(14.0 * std::numbers::pi / 180.0) - 0.05, 1e-12);
    EXPECT_EQ(wedge[0].to, 1.0);
    EXPECT_NEAR(wedge[0].gap, 0.05, 1e-12);
    EXPECT_THAT(opening_at(16.0), IsEmpty()) << "an overhang";
}

TEST(OpenJoint, HasTheStripsThatCornersLeaveWhichDoNotMatch) {
    const auto almost = covered_by({0.009, 0.0}, {1.2, 0.0});
    ASSERT_THAT(almost, SizeIs(1));
    EXPECT_EQ(almost[0].to, 1.0);
    EXPECT_EQ(almost[0].gap, 0.0);
    EXPECT_NEAR(almost[0].strips, 0.009, 1e-12);
    const auto step = covered_by({0.011, 0.0}, {1.2, 0.0});
    ASSERT_THAT(step, SizeIs(1));
    EXPECT_DOUBLE_EQ(step[0].to, 0.989);
    EXPECT_EQ(step[0].strips, 0.0);
    EXPECT_THAT(covered_by({-1, 0.01}, {0.009, 0.01}), IsEmpty()) << "a corner";
}

// Two blocks of 0.4 m side by side, 3 mm from each other and 5 mm before the side.
TEST(OpenJoint, GoesOnBetweenTwoBlocksSideBySide) {
    const std::vector<SideOfBlock> sides{
        {{1, 0}, {0, 0}, 0}, {{0.1, 0.005}, {0.5, 0.005}, 1}, {{0.503, 0.006}, {0.9, 0.006}, 2}};
    const auto parts = covered_parts(sides, 0, {0, 1, 2}, {1.0, 0.4, 0.4}, same);
    ASSERT_THAT(parts, SizeIs(1));
    EXPECT_DOUBLE_EQ(parts[0].from, 0.1 - 0.05 * 0.4);
    EXPECT_DOUBLE_EQ(parts[0].to, 0.9 + 0.05 * 0.4);
    EXPECT_EQ(parts[0].other, 2) << "the one farther away";
    EXPECT_DOUBLE_EQ(parts[0].gap, 0.006);
}

// One that touches ends 4 cm before the one that does not: what is between them is no outside, and that one's edge stays as it is.
TEST(OpenJoint, EndsAtABlockThatTouches) {
    const std::vector<SideOfBlock> sides{{{1, 0}, {0, 0}, 0}, {{0, 0}, {0.5, 0}, 1}, {{0.56, 0.005}, {0.9, 0.005}, 2}};
    const auto near_by = covered_parts(sides, 0, {0, 1, 2}, {1.0, 1.0, 1.3}, same);
    ASSERT_THAT(near_by, SizeIs(2));
    EXPECT_DOUBLE_EQ(near_by[0].from, 0.1 - 0.05);
    EXPECT_DOUBLE_EQ(near_by[0].to, 0.44 + 0.05);
    EXPECT_DOUBLE_EQ(near_by[1].from, 0.5) << "touches to the end";
    EXPECT_EQ(near_by[1].gap, 0.0);
    const std::vector<SideOfBlock> nearer{sides[0], sides[1], {{0.54, 0.005}, {0.9, 0.005}, 2}};
    const auto one = covered_parts(nearer, 0, {0, 1, 2}, {1.0, 1.0, 1.3}, same);
    ASSERT_THAT(one, SizeIs(1));
    EXPECT_EQ(one[0].to, 1.0);
}

} // namespace
} // namespace kluft

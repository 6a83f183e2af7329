#include "kluft/geometry/polygon.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

namespace kluft {
namespace {

const std::vector<Vec2> square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
const std::vector<Vec2> hook{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {0, 1}};

TEST(SignedArea, IsPositiveCounterClockwise) {
    EXPECT_DOUBLE_EQ(signed_area(square), 4.0);
    EXPECT_DOUBLE_EQ(signed_area({square.rbegin(), square.rend()}), -4.0);
    EXPECT_DOUBLE_EQ(signed_area(hook), 5.0);
}

// A regular n-gon in the unit circle has the area n/2 sin(2 pi/n), also seven digits away from the origin; the
// coordinates themselves are rounded to 1e-9 there.
TEST(SignedArea, KeepsItsDigitsFarFromTheOrigin) {
    std::vector<Vec2> polygon;
    for (int i = 0; i < 12; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 12;
        polygon.emplace_back(466011.0 + std::cos(angle), 6692134.0 + std::sin(angle));
    }
    EXPECT_NEAR(signed_area(polygon), 3.0, 1e-8);
}

TEST(Contains, CountsTheOutlineAsInside) {
    EXPECT_TRUE(contains(hook, {1, 0.5}));
    EXPECT_TRUE(contains(hook, {2.5, 2.5}));
    EXPECT_FALSE(contains(hook, {1, 2}));
    EXPECT_FALSE(contains(hook, {-1, 1}));
    for (const Vec2& vertex : hook) EXPECT_TRUE(contains(hook, vertex));
    EXPECT_TRUE(contains(hook, {1, 1}));
    EXPECT_TRUE(contains({hook.rbegin(), hook.rend()}, {1, 0.5}));
}

TEST(IsSimple, RejectsCrossingsTouchesAndSpikes) {
    EXPECT_TRUE(is_simple(square));
    EXPECT_TRUE(is_simple(hook));
    EXPECT_FALSE(is_simple({{0, 0}, {2, 2}, {2, 0}, {0, 2}}));
    EXPECT_FALSE(is_simple({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}));
    EXPECT_FALSE(is_simple({{0, 0}, {2, 0}, {2, 2}, {2, 0}}));
    EXPECT_FALSE(is_simple({{0, 0}, {1, 0}, {1, 0}, {0, 1}}));
    EXPECT_FALSE(is_simple({{0, 0}, {1, 0}}));
}

TEST(IsSimple, AcceptsVerticesInAStraightSide) { EXPECT_TRUE(is_simple({{0, 0}, {1, 0}, {2, 0}, {1, 1}})); }

TEST(BoundingBox, HoldsAllPointsAndNeedsOne) {
    const Box box = bounding_box(hook);
    EXPECT_EQ(box.lower, Vec2(0, 0));
    EXPECT_EQ(box.upper, Vec2(3, 3));
    EXPECT_THROW(static_cast<void>(bounding_box({})), std::invalid_argument);
}

} // namespace
} // namespace kluft

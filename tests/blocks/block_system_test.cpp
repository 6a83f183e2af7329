#include "kluft/blocks/block_system.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace kluft {
namespace {

Block block_of(const std::vector<std::vector<Vec2>>& loops, std::vector<Vec2>& vertices) {
    Block block;
    for (const auto& loop : loops) {
        const int first = static_cast<int>(vertices.size());
        const int n = static_cast<int>(loop.size());
        block.loop_starts.push_back(static_cast<int>(block.edges.size()));
        for (int i = 0; i < n; ++i) {
            vertices.push_back(loop[i]);
            block.edges.push_back({.start = first + i, .end = first + (i + 1) % n});
        }
    }
    compute_block_moments(vertices, block);
    return block;
}

// Rectangle a x b: integral of x^2 about the centre = a^3 b/12.
TEST(BlockMoments, OfARectangle) {
    std::vector<Vec2> vertices;
    const Block block = block_of({{{1, 2}, {4, 2}, {4, 4}, {1, 4}}}, vertices);
    EXPECT_DOUBLE_EQ(block.area, 6.0);
    EXPECT_DOUBLE_EQ(block.size, std::sqrt(6.0));
    EXPECT_TRUE(block.centroid.isApprox(Vec2(2.5, 3.0), 1e-14));
    Mat2 expected;
    expected << 27.0 * 2.0 / 12.0, 0.0, 0.0, 8.0 * 3.0 / 12.0;
    EXPECT_TRUE(block.second_moment.isApprox(expected, 1e-13)) << block.second_moment;
}

// Triangle with legs a, b: area ab/2; about the centroid a^3 b/36, b^3 a/36 and -a^2 b^2/72.
TEST(BlockMoments, OfARightTriangle) {
    std::vector<Vec2> vertices;
    const Block block = block_of({{{0, 0}, {3, 0}, {0, 2}}}, vertices);
    EXPECT_DOUBLE_EQ(block.area, 3.0);
    EXPECT_TRUE(block.centroid.isApprox(Vec2(1.0, 2.0 / 3.0), 1e-14));
    Mat2 expected;
    expected << 27.0 * 2.0 / 36.0, -36.0 / 72.0, -36.0 / 72.0, 8.0 * 3.0 / 36.0;
    EXPECT_TRUE(block.second_moment.isApprox(expected, 1e-13)) << block.second_moment;
}

// A square of side 4 without the square of side 2 in its middle: 4^4/12 - 2^4/12.
TEST(BlockMoments, SubtractHoles) {
    std::vector<Vec2> vertices;
    const Block block = block_of({{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {1, 3}, {3, 3}, {3, 1}}}, vertices);
    EXPECT_DOUBLE_EQ(block.area, 12.0);
    EXPECT_TRUE(block.centroid.isApprox(Vec2(2, 2), 1e-14));
    EXPECT_TRUE(block.second_moment.isApprox(20.0 * Mat2::Identity(), 1e-13));
}

// Regular hexagon of side a: area 3 sqrt(3)/2 a^2, second moment 5 sqrt(3)/16 a^4 about any axis; the place costs
// only the digits of the coordinates.
TEST(BlockMoments, OfAHexagonFarFromTheOrigin) {
    std::vector<Vec2> hexagon;
    for (int i = 0; i < 6; ++i) {
        const double angle = std::numbers::pi / 3.0 * i;
        hexagon.emplace_back(1e4 + 2.0 * std::cos(angle), -1e4 + 2.0 * std::sin(angle));
    }
    std::vector<Vec2> vertices;
    const Block block = block_of({hexagon}, vertices);
    EXPECT_NEAR(block.area, 6.0 * std::numbers::sqrt3, 1e-10);
    EXPECT_TRUE(block.second_moment.isApprox(5.0 * std::numbers::sqrt3 * Mat2::Identity(), 1e-11));
}

} // namespace
} // namespace kluft

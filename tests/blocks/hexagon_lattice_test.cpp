#include "kluft/blocks/hexagon_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/core/diagnostics.hpp"

namespace kluft {
namespace {

using cut_scenes::everywhere;
using Point = std::pair<double, double>;

Point key(const Vec2& p) { return {p.x(), p.y()}; }

std::vector<std::pair<Vec2, Vec2>> whole_net(const HexagonLattice& lattice) {
    return hexagon_edges(lattice, {Vec2(0, 0), Vec2(1, 1)}, everywhere);
}

// In the interior of a hexagon net three edges meet at every vertex; vertices that differed in a bit would have one.
TEST(HexagonLattice, NeighboursShareTheBitsOfTheirVertices) {
    for (const double rotation : {0.0, 0.3, 1.1}) {
        for (const double jitter : {0.0, 0.2}) {
            std::map<Point, int> degree;
            for (const auto& [a, b] : whole_net({.spacing = 0.03, .rotation = rotation, .jitter = jitter})) {
                ++degree[key(a)];
                ++degree[key(b)];
            }
            int inside = 0;
            for (const auto& [p, n] : degree) {
                const bool well_inside = p.first > 0.05 && p.first < 0.95 && p.second > 0.05 && p.second < 0.95;
                if (!well_inside) continue;
                ++inside;
                ASSERT_EQ(n, 3) << p.first << ' ' << p.second;
            }
            // Two vertices for each hexagon of area sqrt(3)/2 d^2, on the 0.9 x 0.9 looked at.
            EXPECT_NEAR(inside, 2.0 * 0.81 / hexagon_area(0.03), 60.0);
        }
    }
}

TEST(HexagonLattice, HasEachEdgeOnceAndOfTheRegularLength) {
    std::set<std::pair<Point, Point>> seen;
    for (const auto& [a, b] : whole_net({.spacing = 0.05, .rotation = 0.2, .offset = {0.01, 0.02}})) {
        EXPECT_TRUE(seen.insert(std::minmax(key(a), key(b))).second);
        EXPECT_NEAR((b - a).norm(), 0.05 / std::numbers::sqrt3, 1e-15);
    }
}

TEST(HexagonLattice, HasVerticalFlatsAboutItsOffsetWithoutRotation) {
    const HexagonLattice lattice{.spacing = 0.25, .offset = {0.5, 0.5}};
    const auto only_that = [](const Vec2& centre) { return (centre - Vec2(0.5, 0.5)).norm() < 1e-12; };
    const auto edges = hexagon_edges(lattice, {Vec2(0, 0), Vec2(1, 1)}, only_that);
    ASSERT_EQ(edges.size(), 6U);
    EXPECT_EQ(std::count_if(edges.begin(), edges.end(),
                            [](const auto& edge) { return edge.first.x() == 0.625 && edge.second.x() == 0.625; }),
              1);
    EXPECT_EQ(std::count_if(edges.begin(), edges.end(),
                            [](const auto& edge) { return edge.first.x() == 0.375 && edge.second.x() == 0.375; }),
              1);
}

TEST(HexagonLattice, JitterDependsOnSeedAndIndicesOnly) {
    const HexagonLattice lattice{.spacing = 0.1, .jitter = 0.2, .seed = 7};
    std::set<std::pair<Point, Point>> large;
    for (const auto& [a, b] : hexagon_edges(lattice, {Vec2(-1, -1), Vec2(2, 2)}, everywhere)) {
        large.insert(std::minmax(key(a), key(b)));
    }
    for (const auto& [a, b] : whole_net(lattice)) EXPECT_TRUE(large.contains(std::minmax(key(a), key(b))));

    HexagonLattice other = lattice;
    other.seed = 8;
    EXPECT_NE(whole_net(lattice).front().first, whole_net(other).front().first);
}

// A uniform distribution in the disc of radius r has the mean of |x|^2 = r^2/2 and the mean of x = 0.
TEST(HexagonLattice, JitterFillsADiscOfItsSize) {
    const HexagonLattice still{.spacing = 0.02};
    HexagonLattice moved = still;
    moved.jitter = 0.1;
    const Box box{Vec2(0, 0), Vec2(1, 1)};
    const auto in_the_middle = [](const Vec2& centre) { return (centre - Vec2(0.5, 0.5)).norm() < 0.3; };
    const auto before = hexagon_edges(still, box, in_the_middle);
    const auto after = hexagon_edges(moved, box, in_the_middle);
    ASSERT_EQ(before.size(), after.size());
    const double r = 0.1 * 0.02;
    double largest = 0.0;
    double squares = 0.0;
    Vec2 sum = Vec2::Zero();
    for (std::size_t i = 0; i < before.size(); ++i) {
        const Vec2 shift = after[i].first - before[i].first;
        largest = std::max(largest, shift.norm());
        squares += shift.squaredNorm();
        sum += shift;
    }
    const double n = static_cast<double>(before.size());
    EXPECT_LE(largest, r * (1.0 + 1e-10));
    EXPECT_GT(largest, 0.98 * r);
    EXPECT_NEAR(squares / n, 0.5 * r * r, 0.03 * r * r);
    EXPECT_LT(sum.norm() / n, 0.05 * r);
}

// Each edge of the net lies between two whole hexagons, or is among the other edges; also the sides of whole hexagons that
// have no whole one across are.
TEST(HexagonLattice, IsTheSameNetInWholeHexagonsAndOtherEdges) {
    for (const double rotation : {0.0, 0.4}) {
        const HexagonLattice lattice{.spacing = 0.05, .rotation = rotation, .jitter = 0.1};
        const Box box{Vec2(0, 0), Vec2(1, 1)};
        const auto keeps = [](const Vec2& centre) { return (centre - Vec2(0.5, 0.5)).norm() < 0.5; };
        const auto is_clear = [](const Vec2& centre) {
            return centre.x() > 0.1 && centre.x() < 0.6 && centre.y() > 0.1 && centre.y() < 0.9;
        };
        std::set<std::pair<Point, Point>> expected;
        for (const auto& [a, b] : hexagon_edges(lattice, box, keeps)) expected.insert(std::minmax(key(a), key(b)));

        const HexagonNet net = hexagon_net(lattice, box, keeps, is_clear);
        std::set<std::pair<Point, Point>> found;
        for (const auto& [a, b] : net.edges) EXPECT_TRUE(found.insert(std::minmax(key(a), key(b))).second);
        const auto& cells = net.whole.cells;
        const auto side = [&](int cell, int k) {
            const auto& corners = cells[cell].vertices;
            return std::pair(net.whole.vertices[corners[k]], net.whole.vertices[corners[(k + 1) % 6]]);
        };
        for (int c = 0; c < static_cast<int>(cells.size()); ++c) {
            for (int k = 0; k < 6; ++k) {
                const auto [a, b] = side(c, k);
                const int across = cells[c].across[k];
                const bool is_other_edge = found.contains(std::minmax(key(a), key(b)));
                if (across > c) {
                    EXPECT_EQ(side(across, (k + 3) % 6), std::pair(b, a));
                    EXPECT_TRUE(found.insert(std::minmax(key(a), key(b))).second);
                } else {
                    EXPECT_TRUE(is_other_edge);
                }
            }
        }
        EXPECT_EQ(found, expected);
        // 0.5 m by 0.8 m but for the corners and a row along the rim of the net
        EXPECT_NEAR(static_cast<double>(cells.size()), 0.36 / hexagon_area(0.05), 18.0);
    }
}

TEST(HexagonLattice, HasNoWholeHexagonWhereNoneIsClearOrKept) {
    const HexagonLattice lattice{.spacing = 0.05, .offset = {0.5, 0.5}};
    const Box box{Vec2(0, 0), Vec2(1, 1)};
    const auto nowhere = [](const Vec2&) { return false; };
    EXPECT_TRUE(hexagon_net(lattice, box, everywhere, nowhere).whole.cells.empty());
    EXPECT_TRUE(hexagon_net(lattice, box, nowhere, everywhere).whole.cells.empty());
    const auto one = [](const Vec2& centre) { return (centre - Vec2(0.5, 0.5)).norm() < 1e-12; };
    EXPECT_TRUE(hexagon_net(lattice, box, one, everywhere).whole.cells.empty()); // its neighbours are not kept
    EXPECT_EQ(hexagon_net(lattice, box, everywhere, one).whole.cells.size(), 1U);
}

TEST(HexagonLattice, RefusesSpacingsAndJittersOutOfRange) {
    EXPECT_THROW(whole_net({.spacing = 0.0}), InputError);
    EXPECT_THROW(whole_net({.spacing = -1.0}), InputError);
    EXPECT_THROW(whole_net({.spacing = std::nan("")}), InputError);
    EXPECT_THROW(whole_net({.spacing = 0.1, .jitter = 0.25}), InputError);
    EXPECT_THROW(whole_net({.spacing = 0.1, .jitter = -0.1}), InputError);
    EXPECT_THROW(whole_net({.spacing = 1e-9}), InputError);
}

} // namespace
} // namespace kluft

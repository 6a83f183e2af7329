#include "kluft/blocks/voronoi_cells.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {
namespace {

using namespace cut_scenes;

const double side = std::sqrt(0.5 * std::numbers::sqrt3); ///< a of a net with d = 1
const double unit = side / 65536.0;

Box box_of(double width, double height) { return {Vec2(0, 0), Vec2(width, height)}; }

bool inside(const Box& box, const Vec2& p, double margin) {
    return (p.array() > box.lower.array() + margin).all() && (p.array() < box.upper.array() - margin).all();
}

/// Distances of all points from a place, smallest first, with the points' numbers.
std::vector<std::pair<double, int>> by_distance(const std::vector<Vec2>& points, const Vec2& place) {
    std::vector<std::pair<double, int>> found;
    for (int i = 0; i < static_cast<int>(points.size()); ++i) found.emplace_back((points[i] - place).norm(), i);
    std::sort(found.begin(), found.end());
    return found;
}

/// The part of a polygon that is not farther from p than from q.
Polygon nearer_part(const Polygon& polygon, const Vec2& p, const Vec2& q) {
    const Vec2 middle = 0.5 * (p + q);
    const auto beyond = [&](const Vec2& x) { return (x - middle).dot(q - p); };
    Polygon part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2& a = polygon[i];
        const Vec2& b = polygon[(i + 1) % polygon.size()];
        const double at_a = beyond(a);
        const double at_b = beyond(b);
        if (at_a <= 0.0) part.push_back(a);
        if ((at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0))
            part.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    return part;
}

/// The cell of a point by cutting a large square along the bisectors with all other points near it.
Polygon cell_of(const std::vector<Vec2>& points, int i) {
    const Vec2& p = points[i];
    Polygon cell{p + Vec2(-3, -3), p + Vec2(3, -3), p + Vec2(3, 3), p + Vec2(-3, 3)};
    for (int j = 0; j < static_cast<int>(points.size()); ++j) {
        if (j != i && (points[j] - p).norm() < 8.0) cell = nearer_part(cell, p, points[j]);
    }
    return cell;
}

Vec2 centroid_of(const Polygon& polygon) {
    double twice = 0.0;
    Vec2 moment = Vec2::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const double part = cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        twice += part;
        moment += part / 3.0 * (polygon[0] + polygon[i] + polygon[i + 1]);
    }
    return moment / twice;
}

// By definition of the cells, with all points asked: both points of an edge are the nearest to its middle, and as near;
// three at least to its ends. Vertices are rounded to one unit.
TEST(VoronoiCells, EdgesAreAsFarFromTheirTwoPointsAndFartherFromAllOthers) {
    for (const int relaxation : {0, 2}) {
        const Box box = box_of(12, 9);
        const VoronoiNet net = voronoi_net({.spacing = 1.0, .relaxation = relaxation, .seed = 3}, box);
        for (const VoronoiNet::Edge& edge : net.edges) {
            if (!inside(box, edge.start, 0.0) || !inside(box, edge.end, 0.0)) continue;
            const auto nearest = by_distance(net.points, 0.5 * (edge.start + edge.end));
            EXPECT_NEAR((net.points[edge.left] - 0.5 * (edge.start + edge.end)).norm(), nearest[0].first, 2.0 * unit);
            EXPECT_NEAR((net.points[edge.right] - 0.5 * (edge.start + edge.end)).norm(), nearest[0].first, 2.0 * unit);
            for (const Vec2& end : {edge.start, edge.end}) {
                const auto around = by_distance(net.points, end);
                EXPECT_NEAR(around[2].first, around[0].first, 2.0 * unit);
            }
            EXPECT_GT(cross(edge.end - edge.start, net.points[edge.left] - edge.start), 0.0);
            EXPECT_LT(cross(edge.end - edge.start, net.points[edge.right] - edge.start), 0.0);
        }
    }
}

// Cells made by bisectors instead: each pass of Lloyd's moves the points to their centroids.
TEST(VoronoiCells, EachPassMovesThePointsToTheCentroidsOfTheirCells) {
    const Box box = box_of(6, 7);
    for (const int relaxation : {0, 1, 4}) {
        VoronoiCells cells{.spacing = 1.0, .offset = {0.3, -0.2}, .relaxation = relaxation, .seed = 11};
        const VoronoiNet before = voronoi_net(cells, box);
        ++cells.relaxation;
        const VoronoiNet after = voronoi_net(cells, box);
        for (int i = 0; i < static_cast<int>(before.points.size()); ++i) {
            if (!inside(box, before.points[i], 0.0)) continue;
            const Vec2 expected = centroid_of(cell_of(before.points, i));
            EXPECT_LT(by_distance(after.points, expected)[0].first, 2.0 * unit);
        }
    }
}

// The numbers are those of the hash in the header, computed with arbitrary integers: squares (0, 0), (3, -2), (-1, 5).
TEST(VoronoiCells, HaveOnePointForEachSquareThatDependsOnSeedAndSquareOnly) {
    const VoronoiNet net = voronoi_net({.spacing = 1.0, .offset = {0.25, 0.5}}, {Vec2(-3, -3), Vec2(6, 6)});
    for (const Vec2& expected : {Vec2(8715, 86604), Vec2(209849, -66158), Vec2(-4050, 357241)}) {
        EXPECT_LT(by_distance(net.points, Vec2(0.25, 0.5) + unit * expected)[0].first, 1e-12);
    }
}

TEST(VoronoiCells, AreTheSameToTheBitForEveryBox) {
    const VoronoiCells cells{.spacing = 0.1, .offset = {0.01, 0.02}, .relaxation = 3, .seed = 5};
    const Box small = {Vec2(0.4, 0.3), Vec2(1.1, 0.9)};
    std::set<std::pair<std::pair<double, double>, std::pair<double, double>>> all;
    for (const auto& [a, b] : voronoi_edges(cells, {Vec2(-2, -1), Vec2(3, 2)}, everywhere)) {
        all.insert({{a.x(), a.y()}, {b.x(), b.y()}});
        all.insert({{b.x(), b.y()}, {a.x(), a.y()}});
    }
    const auto part = voronoi_edges(cells, small, everywhere);
    EXPECT_GT(part.size(), 100U);
    for (const auto& [a, b] : part) EXPECT_TRUE(all.contains({{a.x(), a.y()}, {b.x(), b.y()}}));
}

TEST(VoronoiCells, OffsetMovesTheNetAsAWhole) {
    const VoronoiCells still{.spacing = 1.0, .relaxation = 2, .seed = 2};
    const Box box = box_of(5, 5);
    for (const Vec2& offset : {Vec2(0.37, -0.21), Vec2(1234.5, -77.25), Vec2(-3.0e6, 6.7e6)}) {
        VoronoiCells moved = still;
        moved.offset = offset;
        const VoronoiNet net = voronoi_net(moved, box);
        const VoronoiNet same = voronoi_net(still, {box.lower - offset, box.upper - offset});
        ASSERT_EQ(net.edges.size(), same.edges.size());
        for (std::size_t i = 0; i < net.points.size(); ++i)
            EXPECT_LT((net.points[i] - offset - same.points[i]).norm(), 1e-15 * offset.norm() + 1e-14);
    }
}

// Where no vertex of a net has another degree than three, V - E + F = 2 gives six neighbours in the mean. Counted inside
// a box of 40 by 40 only, which leaves the rim's part of it.
TEST(VoronoiCells, HaveSixNeighboursInTheMeanAndThreeAtEachVertex) {
    const Box box = box_of(40, 40);
    const VoronoiNet net = voronoi_net({.spacing = 1.0, .relaxation = 2}, box);
    std::vector<int> neighbours(net.points.size(), 0);
    std::map<std::pair<double, double>, int> degree;
    for (const VoronoiNet::Edge& edge : net.edges) {
        ++neighbours[edge.left];
        ++neighbours[edge.right];
        for (const Vec2& end : {edge.start, edge.end}) {
            if (inside(box, end, 0.0)) ++degree[{end.x(), end.y()}];
        }
    }
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < net.points.size(); ++i) {
        if (!inside(box, net.points[i], 0.0)) continue;
        sum += neighbours[i];
        ++count;
    }
    EXPECT_NEAR(sum / count, 6.0, 0.03);
    // One point per square: what the box holds scatters by the squares near its rim only, 172 in a row, of which three
    // rows may lie in or out, with a variance of 1/4 each at most.
    EXPECT_NEAR(count, 1600.0 / hexagon_area(1.0), 4.0 * 0.5 * std::sqrt(3.0 * 172.0));
    for (const auto& [at, n] : degree) EXPECT_EQ(n, 3) << at.first << ' ' << at.second;
}

/// |sum of l exp(i n theta)| / sum of l over the edges: 1 if all directions differ by multiples of 2 pi/n.
double order(const std::vector<std::pair<Vec2, Vec2>>& edges, int n) {
    std::complex<double> sum = 0.0;
    double total = 0.0;
    for (const auto& [a, b] : edges) {
        sum += std::polar((b - a).norm(), n * std::atan2(b.y() - a.y(), b.x() - a.x()));
        total += (b - a).norm();
    }
    return std::abs(sum) / total;
}

// 7500 edges of random directions: 1/sqrt(7500) = 0.012 in the mean.
TEST(VoronoiCells, HaveNoPreferredDirections) {
    const Box box = box_of(50, 43);
    EXPECT_NEAR(order(hexagon_edges({.spacing = 1.0}, box, everywhere), 6), 1.0, 1e-9);
    for (const int relaxation : {0, 2, 5}) {
        const auto edges = voronoi_edges({.spacing = 1.0, .relaxation = relaxation, .seed = 9}, box, everywhere);
        for (const int n : {2, 4, 6}) EXPECT_LT(order(edges, n), 0.05) << relaxation << ' ' << n;
    }
}

TEST(SlowVoronoiCells, PassesMakeShortEdgesRarer) {
    double last = 1.0;
    for (const int relaxation : {0, 2, 8}) {
        const auto edges = voronoi_edges({.spacing = 1.0, .relaxation = relaxation}, box_of(40, 40), everywhere);
        const auto n_short =
            std::ranges::count_if(edges, [](const auto& edge) { return (edge.second - edge.first).norm() < 0.1; });
        const double share = static_cast<double>(n_short) / static_cast<double>(edges.size());
        EXPECT_LT(share, last);
        last = share;
    }
    EXPECT_LT(last, 0.05);
}

TEST(VoronoiCells, RefuseWhatIsOutOfRange) {
    const Box box = box_of(1, 1);
    const auto refused = [](const VoronoiCells& cells, const Box& in) {
        EXPECT_THROW((void)voronoi_net(cells, in), InputError);
    };
    refused({.spacing = 0.0}, box);
    refused({.spacing = -1.0}, box);
    refused({.spacing = std::nan("")}, box);
    refused({.spacing = 0.1, .relaxation = -1}, box);
    refused({.spacing = 0.1, .relaxation = 21}, box);
    refused({.spacing = 0.1, .offset = {1e9, 0}}, box);
    refused({.spacing = 0.1, .offset = {0, std::nan("")}}, box);
    refused({.spacing = 1e-5}, box);
}

GeometrySpec voronoi_spec(double width, double height, const VoronoiCells& cells) {
    GeometrySpec spec = rectangle(width, height);
    spec.tessellation = Tessellation{{}, 1, {}, cells};
    return spec;
}

// Two places lie in one block if and only if one point is the nearest to both. Places within 0.05 d of an edge are left
// out, since edges shorter than 0.02 d are collapsed.
TEST(VoronoiCells, BlocksAreThePlacesThatOnePointIsNearestTo) {
    const VoronoiCells cells{.spacing = 0.1, .relaxation = 1, .seed = 4};
    GeometrySpec spec = voronoi_spec(1.0, 0.8, cells);
    spec.minimum_area = 0.0;
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    const std::vector<Vec2> points = voronoi_net(cells, box_of(1.0, 0.8)).points;
    Uniform uniform(1);
    std::map<int, std::set<int>> points_of_block;
    std::set<int> used;
    for (int i = 0; i < 3000; ++i) {
        const Vec2 place(uniform(0, 1.0), uniform(0, 0.8));
        const auto nearest = by_distance(points, place);
        if (nearest[1].first - nearest[0].first < 0.01) continue;
        points_of_block[block_containing(body.system, place)].insert(nearest[0].second);
        used.insert(nearest[0].second);
    }
    EXPECT_EQ(points_of_block.size(), used.size());
    for (const auto& [block, own] : points_of_block) EXPECT_EQ(own.size(), 1U) << block;
}

TEST(VoronoiCells, ARegionKeepsWholeCellsWithTheirPointInIt) {
    const VoronoiCells cells{.spacing = 0.1, .relaxation = 2};
    GeometrySpec spec = voronoi_spec(2.0, 2.0, cells);
    spec.tessellation->region = Polygon{{0.5, 0.5}, {1.5, 0.5}, {1.5, 1.5}, {0.5, 1.5}};
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    const std::vector<Vec2> points = voronoi_net(cells, box_of(2.0, 2.0)).points;
    const auto n_inside =
        std::ranges::count_if(points, [&](const Vec2& p) { return contains(*spec.tessellation->region, p); });
    EXPECT_EQ(body.system.n_blocks(), n_inside + 1);
}

// The domain's corner is a multiple of 2^-20 m, and the net counts from it.
TEST(VoronoiCells, BlocksFarFromTheOriginAreTheSame) {
    GeometrySpec spec = voronoi_spec(1.0, 1.0, {.spacing = 0.125, .relaxation = 2, .seed = 8});
    const BlockSystem here = cut_blocks(spec).system;
    for (Vec2& p : spec.domain) p += Vec2(6.7e6, -6.7e6);
    EXPECT_TRUE(same_blocks(here, cut_blocks(spec).system));
    EXPECT_EQ(here.spacing, 0.125);
}

class VoronoiCut : public testing::TestWithParam<int> {};

// As of hexagons: areas sum to the domain's, no block is below the minimum, no edge is left that is not shared.
TEST_P(VoronoiCut, WithFracturesIsAPartition) {
    Uniform uniform(4000 + GetParam());
    const double width = uniform(0.2, 2.0);
    const double height = uniform(0.2, 2.0);
    GeometrySpec spec = voronoi_spec(width, height,
                                     {.spacing = 0.12 * std::sqrt(width * height),
                                      .offset = {uniform(), uniform()},
                                      .relaxation = GetParam() % 4,
                                      .seed = static_cast<std::uint64_t>(GetParam())});
    if (GetParam() % 2 == 1) add_random_traces(spec, 12, width, height, uniform);
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    if (body.system.n_blocks() > 1) {
        EXPECT_GE(body.report.smallest_area, 0.05 * hexagon_area(body.system.spacing));
    }
}

INSTANTIATE_TEST_SUITE_P(SlowSeeds, VoronoiCut, testing::Range(0, 40));

} // namespace
} // namespace kluft

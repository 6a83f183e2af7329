#include "kluft/blocks/block_cutter.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {
namespace {

using namespace cut_scenes;

CutBody sound_cut(const GeometrySpec& spec) {
    CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    return body;
}

std::vector<int> edge_counts(const BlockSystem& system) {
    std::vector<int> counts;
    for (const Block& block : system.blocks) counts.push_back(static_cast<int>(block.edges.size()));
    std::sort(counts.begin(), counts.end());
    return counts;
}

TEST(BlockCutter, ADomainWithoutCutsIsOneBlockWithItsFourSides) {
    const CutBody body = sound_cut(rectangle(0.38, 1.0));
    ASSERT_EQ(body.system.n_blocks(), 1);
    EXPECT_EQ(body.system.n_interfaces(), 0);
    EXPECT_EQ(body.system.blocks[0].edges.size(), 4U);
    EXPECT_DOUBLE_EQ(body.system.blocks[0].area, 0.38);
    ASSERT_EQ(body.system.boundaries.size(), 4U);
    EXPECT_EQ(body.system.boundaries[3].name, "left");
    for (const Boundary& side : body.system.boundaries) EXPECT_EQ(side.edges.size(), 1U);
    EXPECT_DOUBLE_EQ(body.system.spacing, std::sqrt(0.38));
    EXPECT_DOUBLE_EQ(body.report.smallest_area, 0.38);
    EXPECT_DOUBLE_EQ(body.report.smallest_edge, 0.38);
    EXPECT_DOUBLE_EQ(body.report.smallest_angle, 0.5 * std::numbers::pi);
}

TEST(BlockCutter, CrossingTracesMakeFourBlocksThatMeetAtOneVertex) {
    GeometrySpec spec = rectangle(2, 2);
    add_trace(spec, {{-1, 0.5}, {3, 0.5}}, 4);
    add_trace(spec, {{1.5, -1}, {1.5, 3}}, 5);
    const BlockSystem system = sound_cut(spec).system;
    ASSERT_EQ(system.n_blocks(), 4);
    EXPECT_EQ(system.n_interfaces(), 4);
    EXPECT_EQ(sorted_areas(system), (std::vector<double>{0.25, 0.75, 0.75, 2.25}));
    EXPECT_EQ(system.vertices.size(), 9U);
    // Rows upwards, to the right in a row.
    EXPECT_DOUBLE_EQ(system.blocks[0].area, 0.75);
    EXPECT_DOUBLE_EQ(system.blocks[1].area, 0.25);
    EXPECT_DOUBLE_EQ(system.blocks[2].area, 2.25);
    for (const Interface& joint : system.interfaces) EXPECT_EQ(joint.interface_type, 4 + joint.fracture);
    EXPECT_DOUBLE_EQ(interface_length(system, EdgeOrigin::fracture, 0), 2.0);
    EXPECT_DOUBLE_EQ(interface_length(system, EdgeOrigin::fracture, 1), 2.0);
}

// At a T-junction the block beyond the through-going fracture keeps the vertex, so that each interface is one edge.
TEST(BlockCutter, AnAbuttingTraceSplitsTheEdgeOppositeToIt) {
    GeometrySpec spec = rectangle(2, 2);
    add_trace(spec, {{-1, 1}, {3, 1}});
    add_trace(spec, {{1, 1}, {1, 3}});
    const BlockSystem system = sound_cut(spec).system;
    EXPECT_EQ(system.n_blocks(), 3);
    EXPECT_EQ(system.n_interfaces(), 3);
    EXPECT_EQ(edge_counts(system), (std::vector<int>{4, 4, 5}));
}

TEST(BlockCutter, TheNormalToTheRightOfAnInterfacePointsFromAToB) {
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.1}, 3, {}};
    const BlockSystem system = sound_cut(spec).system;
    for (const Interface& joint : system.interfaces) {
        const Edge& edge = system.blocks[joint.block_a].edges[joint.edge_a];
        const Vec2 normal = right_normal(edge_end(system, edge) - edge_start(system, edge));
        EXPECT_GT(normal.dot(system.blocks[joint.block_b].centroid - system.blocks[joint.block_a].centroid), 0.0);
        EXPECT_LT(joint.block_a, joint.block_b);
        EXPECT_EQ(joint.interface_type, 3);
    }
}

class GapAtAnAbutment : public testing::TestWithParam<std::pair<double, int>> {};

// d = 1, so 0.02 is the smallest gap that stays open.
TEST_P(GapAtAnAbutment, IsClosedBelowTheResolution) {
    const auto [gap, n_blocks] = GetParam();
    GeometrySpec spec = rectangle(20, 20);
    spec.reference_spacing = 1.0;
    add_trace(spec, {{-1, 10}, {21, 10.3}});
    const double y = 10.0 + 0.3 * 8.0 / 22.0;
    add_trace(spec, {{7, y + gap}, {7, 25}});
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), n_blocks);
    EXPECT_EQ(body.report.pruned.size(), n_blocks == 3 ? 0 : 1);
    EXPECT_EQ(body.report.merged.size(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Gaps, GapAtAnAbutment,
                         testing::Values(std::pair(0.019, 3), std::pair(1e-4, 3), std::pair(1e-12, 3),
                                         std::pair(2e-15, 3), std::pair(0.0, 3), std::pair(-2e-15, 3),
                                         std::pair(-1e-12, 3), std::pair(-1e-4, 3), std::pair(0.021, 2)));

TEST(BlockCutter, TwoTracesWhoseEndsNearlyMeetMakeOneJoint) {
    GeometrySpec spec = rectangle(20, 20);
    spec.reference_spacing = 1.0;
    add_trace(spec, {{-1, 9}, {10, 9}});
    add_trace(spec, {{10.01, 9.005}, {21, 9}});
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), 2);
    EXPECT_EQ(body.report.joined_ends, 2);
    EXPECT_EQ(body.report.pruned.size(), 0);
}

/// A bed y = 0.6 x through a square of 10 m, and two joints that meet at a place of it that rounding puts on one side or the other; as
/// two traces from there, two to there, or one that bends there.
GeometrySpec bed_with_two_joints(double x, int kind) {
    GeometrySpec spec = rectangle(10, 10);
    add_trace(spec, {{-1, -0.6}, {11, 6.6}});
    const Vec2 tip(x, 0.6 * x);
    const Vec2 left(x - 6, 0.6 * x + 10);
    const Vec2 right(x + 3, 0.6 * x + 10);
    if (kind == 0) {
        add_trace(spec, {tip, left});
        add_trace(spec, {tip, right});
    } else if (kind == 1) {
        add_trace(spec, {left, tip});
        add_trace(spec, {right, tip});
    } else {
        add_trace(spec, {left, tip, right});
    }
    return spec;
}

TEST(BlockCutter, JointsThatMeetOnALineCutItWhateverTheRounding) {
    for (int kind = 0; kind < 3; ++kind) {
        for (int i = 30; i <= 60; ++i) {
            const CutBody body = sound_cut(bed_with_two_joints(0.1 * i, kind));
            EXPECT_EQ(body.system.n_blocks(), 4) << kind << ", " << i;
            for (const auto& sliver : body.report.merged) EXPECT_LT(sliver.area, 1e-12) << kind << ", " << i;
        }
    }
}

// A sloping face in place of the bed.
TEST(BlockCutter, JointsThatMeetOnASlopingFaceReachIt) {
    for (int i = 3; i <= 60; ++i) {
        const double y = 0.1 * i;
        GeometrySpec spec;
        spec.domain = {{0, 0}, {20, 0}, {14, 10}, {0, 10}};
        const Vec2 tip(20.0 - 0.6 * y, y);
        add_trace(spec, {tip, tip + Vec2(-std::sqrt(300.0), 10)});
        add_trace(spec, {tip, tip + Vec2(-12, 12)});
        EXPECT_EQ(sound_cut(spec).system.n_blocks(), 3) << y;
    }
}

TEST(BlockCutter, ATraceThatEndsJustShortOfTheOutlineReachesIt) {
    GeometrySpec spec = rectangle(20, 20);
    spec.reference_spacing = 1.0;
    add_trace(spec, {{0.01, 9}, {19.99, 9}});
    EXPECT_EQ(sound_cut(spec).system.n_blocks(), 2);
}

// What ends freely separates nothing: the cut is the same as without it, needless vertices included.
TEST(BlockCutter, DanglingAndIsolatedTracesLeaveNoTrace) {
    GeometrySpec spec = rectangle(2, 2);
    add_trace(spec, {{-1, 1}, {3, 1.3}});
    spec.tessellation = Tessellation{{.spacing = 0.5}, 0, {}};
    const CutBody plain = sound_cut(spec);
    GeometrySpec with = spec;
    add_trace(with, {{0.95, 0.42}, {1.05, 0.44}});                        // across one flat
    add_trace(with, {{-0.1, 0.45}, {0.13, 0.45}});                        // from beyond the outline into a block
    add_trace(with, {{1.3, 0.4}, {1.3, 0.5}, {1.2, 0.45}, {1.27, 0.42}}); // inside a hexagon, with knees
    const CutBody body = sound_cut(with);
    EXPECT_TRUE(same_blocks(body.system, plain.system));
    EXPECT_EQ(body.report.pruned.size(), plain.report.pruned.size() + 3);
}

// A plane at 30 degrees comes out at the face of a slope, and another trace crosses it there and ends in rock: what is too small for a
// block goes with the end of that one, by which of its two sides it is longer does not matter. A block on the plane was welded to the rock
// (a factor of safety of 3.92 for tan 35 / tan 30 = 1.213).
TEST(BlockCutter, APlaneComesOutWhereThePieceBesideItIsTooSmall) {
    for (const double shift : {-0.04, 0.0, 0.04}) {
        GeometrySpec spec;
        spec.domain = {{0, 0}, {20, 0}, {20, 15}, {10, 15}, {5, 5}, {0, 5}};
        add_trace(spec, {{5.5, 7.021}, {21, 15.9696}});
        add_trace(spec, {{15, 11}, {14.8, 16}});
        add_trace(spec, {{6.1, 7.589 + shift}, {6.4, 7.5415 + shift}, {7.2, 7.41 + shift}});
        spec.tessellation = Tessellation{};
        spec.tessellation->triangles = TriangleNet{.spacing = 1.0, .grading = {}};
        const CutBody body = sound_cut(spec);
        ASSERT_EQ(body.report.merged.size(), 1U) << shift;
        EXPECT_EQ(body.report.merged[0].fracture, 2) << shift;
        EXPECT_TRUE(body.report.merged[0].daylights) << shift;
        const double slope = (15.9696 - 7.021) / 15.5; // the plane meets the face y = 2 x - 5
        const double foot = (7.021 + 5.0 - 5.5 * slope) / (2.0 - slope);
        const double head = 5.5 + (15.0 - 7.021) / slope; // and the top
        const double whole = (head - foot) * std::hypot(1.0, slope);
        EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture, 0), whole, 1e-9) << shift;
    }
}

// Two traces cross 0.1 m behind a side of 2 m: what is left there is a triangle of 0.01 m2, 0.2 m wide. Whichever neighbour it went
// into, one of the two fractures would end at X and lock what slides along it.
TEST(BlockCutter, APieceAtAFreeSideIsTakenOffWhereItWouldLockAFracture) {
    for (const bool has_net : {false, true}) {
        GeometrySpec spec;
        spec.domain = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
        add_trace(spec, {{0.3, 0.2}, {2.1, 2.0}});
        add_trace(spec, {{0.3, 2.2}, {2.1, 0.4}});
        for (FractureTrace& fracture : spec.fractures)
            for (Vec2& p : fracture.points) p += Vec2(0.6, -0.2); // they cross at (1.9, 1.0)
        spec.boundaries = {{"base", {0}}};
        if (has_net) {
            spec.tessellation = Tessellation{};
            spec.tessellation->triangles = TriangleNet{.spacing = 1.5, .grading = {}};
            spec.minimum_area = 0.02;
        } else {
            spec.reference_spacing = 1.0;
            spec.minimum_area = 0.02;
        }
        const CutBody free = sound_cut(spec);
        EXPECT_EQ(free.report.merged.size(), 0U) << has_net;
        ASSERT_EQ(free.report.taken_off.size(), 1U) << has_net;
        EXPECT_NEAR(free.report.taken_off[0].area, 0.01, 1e-12);
        EXPECT_NEAR(free.report.taken_off[0].length, 0.2, 1e-12);
        EXPECT_LT((free.report.taken_off[0].at - Vec2(2.0 - 0.1 / 3.0, 1.0)).norm(), 1e-12);

        spec.boundaries.push_back({"face", {1}}); // which may be pressed or held
        const CutBody named = sound_cut(spec);
        EXPECT_EQ(named.report.taken_off.size(), 0U) << has_net;
        ASSERT_EQ(named.report.merged.size(), 1U) << has_net;
        EXPECT_NEAR(boundary_length(named.system, named.system.boundaries[1]), 2.0, 1e-12);
        const auto fractures = [](const CutBody& body) {
            return interface_length(body.system, EdgeOrigin::fracture, 0) +
                   interface_length(body.system, EdgeOrigin::fracture, 1);
        };
        EXPECT_NEAR(fractures(named) - fractures(free), 0.1 * std::numbers::sqrt2, 1e-9) << has_net;
    }
}

TEST(BlockCutter, ASlitBehindAFreeSideStaysClosed) {
    GeometrySpec spec; // traces at 0.2 degrees to each other: between them and the side a piece 1 m long
    spec.domain = {{0, 0}, {3, 0}, {3, 2}, {0, 2}};
    add_trace(spec, {{-1, 1.01}, {4, 0.99}});
    add_trace(spec, {{-1, 0.99}, {4, 1.01}});
    spec.reference_spacing = 1.0;
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.report.taken_off.size(), 0U);
}

TEST(BlockCutter, TheSmallestBlockIsSmallerWhereTracesAloneMakeTheBlocks) {
    GeometrySpec spec = rectangle(2, 2);
    spec.reference_spacing = 1.0;
    EXPECT_EQ(minimum_area_share(spec), 0.002);
    spec.tessellation = Tessellation{};
    EXPECT_EQ(minimum_area_share(spec), 0.05);
    spec.minimum_area = 0.01;
    EXPECT_EQ(minimum_area_share(spec), 0.01);
}

TEST(BlockCutter, TracesBeyondTheDomainAreClipped) {
    GeometrySpec spec = rectangle(1, 1);
    add_trace(spec, {{-3, 0.5}, {-2, 0.7}, {5, 0.7}});
    add_trace(spec, {{-3, 2}, {5, 3}});
    add_trace(spec, {{2, -1}, {2, 5}});
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), 2);
    EXPECT_EQ(body.report.pruned.size(), 0);
    EXPECT_DOUBLE_EQ(interface_length(body.system, EdgeOrigin::fracture, 0), 1.0);
}

TEST(BlockCutter, ATraceAlongTheOutlineCutsNothing) {
    GeometrySpec spec = rectangle(1, 1);
    add_trace(spec, {{-0.5, 0}, {0.5, 0}});
    add_trace(spec, {{1, 0.25}, {1, 0.75}});
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), 1);
    EXPECT_EQ(body.system.blocks[0].edges.size(), 4U);
}

TEST(BlockCutter, OverlappingTracesBelongToTheFirstOne) {
    GeometrySpec spec = rectangle(4, 1);
    add_trace(spec, {{3, 0.5}, {1, 0.5}});
    add_trace(spec, {{0, 0.5}, {2, 0.5}});
    add_trace(spec, {{1.5, 0.5}, {4, 0.5}});
    const BlockSystem system = sound_cut(spec).system;
    EXPECT_EQ(system.n_blocks(), 2);
    EXPECT_EQ(system.n_interfaces(), 3);
    EXPECT_DOUBLE_EQ(interface_length(system, EdgeOrigin::fracture, 0), 2.0);
    EXPECT_DOUBLE_EQ(interface_length(system, EdgeOrigin::fracture, 1), 1.0);
    EXPECT_DOUBLE_EQ(interface_length(system, EdgeOrigin::fracture, 2), 1.0);
}

TEST(BlockCutter, DuplicateTracesChangeNothing) {
    Uniform uniform(3);
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.2}, 0, {}};
    add_random_traces(spec, 6, 1, 1, uniform);
    const CutBody once = sound_cut(spec);
    GeometrySpec twice = spec;
    for (const FractureTrace& trace : spec.fractures) add_trace(twice, {trace.points.rbegin(), trace.points.rend()});
    EXPECT_TRUE(same_blocks(sound_cut(twice).system, once.system));
}

// Twice the same trace but for the last digit: the strip between them is far below what the cut resolves.
TEST(BlockCutter, NearlyDuplicateTracesMakeOneJoint) {
    GeometrySpec spec = rectangle(1, 1);
    add_trace(spec, {{-0.1, 0.3}, {1.1, 0.71}});
    add_trace(spec, {{-0.1, std::nextafter(0.3, 1.0)}, {1.1, std::nextafter(0.71, 1.0)}});
    add_trace(spec, {{-0.1, std::nextafter(0.3, 1.0)}, {1.1, std::nextafter(0.71, 0.0)}});
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), 2);
    EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture), std::hypot(1.0, 0.41 / 1.2), 1e-12);
}

TEST(BlockCutter, AClosedLoopIsABlockInAHole) {
    GeometrySpec spec = rectangle(4, 4);
    add_trace(spec, {{1, 1}, {3, 1}, {3, 2}, {1, 2}, {1, 1}});
    const BlockSystem system = sound_cut(spec).system;
    ASSERT_EQ(system.n_blocks(), 2);
    EXPECT_EQ(system.n_interfaces(), 4);
    EXPECT_EQ(sorted_areas(system), (std::vector<double>{2.0, 14.0}));
    const Block& ring = system.blocks[system.blocks[0].area > 3.0 ? 0 : 1];
    EXPECT_EQ(ring.loop_starts, (std::vector<int>{0, 4}));
    EXPECT_EQ(ring.edges.size(), 8U);
}

TEST(BlockCutter, ABridgeToAClosedLoopIsPruned) {
    GeometrySpec spec = rectangle(4, 4);
    add_trace(spec, {{1, 1}, {3, 1}, {3, 2}, {1, 2}, {1, 1}});
    add_trace(spec, {{2, 2}, {2, 4}});
    const CutBody body = sound_cut(spec);
    ASSERT_EQ(body.system.n_blocks(), 2);
    EXPECT_EQ(body.system.n_interfaces(), 4);
    EXPECT_EQ(body.report.pruned.size(), 1);
}

TEST(BlockCutter, LoopsInLoopsAndBesideEachOther) {
    GeometrySpec spec = rectangle(8, 4);
    add_trace(spec, {{1, 1}, {3, 1}, {3, 3}, {1, 3}, {1, 1}});
    add_trace(spec, {{1.5, 1.5}, {2, 1.5}, {2, 2}, {1.5, 2}, {1.5, 1.5}});
    add_trace(spec, {{5, 1}, {7, 1}, {6, 3}, {5, 1}});
    const BlockSystem system = sound_cut(spec).system;
    EXPECT_EQ(sorted_areas(system), (std::vector<double>{0.25, 2.0, 3.75, 26.0}));
    for (const Block& block : system.blocks) {
        EXPECT_EQ(block.loop_starts.size(), block.area > 20.0 ? 3U : (block.area == 3.75 ? 2U : 1U));
    }
}

// A loop that touches the outline of its block, or another loop, in one vertex: every loop stays simple.
TEST(BlockCutter, LoopsThatTouchInAVertexStayApart) {
    GeometrySpec spec = rectangle(4, 4);
    add_trace(spec, {{2, 0}, {3, 1}, {1, 1}, {2, 0}});
    add_trace(spec, {{3, 1}, {3.5, 2}, {3, 2}, {3, 1}});
    const BlockSystem system = sound_cut(spec).system;
    ASSERT_EQ(system.n_blocks(), 3);
    EXPECT_EQ(sorted_areas(system), (std::vector<double>{0.25, 1.0, 14.75}));
}

TEST(BlockCutter, ATraceMayCrossAndTouchItself) {
    GeometrySpec spec = rectangle(4, 4);
    add_trace(spec, {{0, 1}, {3, 1}, {3, 3}, {2, 3}, {2, 0}});
    const BlockSystem system = sound_cut(spec).system;
    EXPECT_EQ(sorted_areas(system), (std::vector<double>{2.0, 2.0, 12.0}));
}

TEST(BlockCutter, HolesOfTheDomainBelongToNoBlock) {
    GeometrySpec spec = rectangle(4, 4);
    spec.holes = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}, {{3, 3}, {3, 3.5}, {3.5, 3}}};
    add_trace(spec, {{1.5, -1}, {1.5, 5}});
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), 2);
    EXPECT_EQ(body.system.n_interfaces(), 2);
    EXPECT_EQ(sorted_areas(body.system), (std::vector<double>{5.5, 9.375}));
    EXPECT_DOUBLE_EQ(interface_length(body.system, EdgeOrigin::fracture), 3.0);
}

TEST(BlockCutter, NamesBelongToTheSidesInTheOrderGiven) {
    GeometrySpec spec = rectangle(2, 1);
    spec.domain = {{0, 1}, {2, 1}, {2, 0}, {0, 0}}; // sides: top, right, bottom, left
    spec.boundaries = {{"top", {0}}, {"walls", {1, 3}}};
    add_trace(spec, {{-1, 0.25}, {3, 0.25}});
    const BlockSystem system = sound_cut(spec).system;
    ASSERT_EQ(system.boundaries.size(), 2U);
    EXPECT_EQ(system.boundaries[0].edges.size(), 1U);
    EXPECT_DOUBLE_EQ(boundary_length(system, system.boundaries[0]), 2.0);
    EXPECT_EQ(system.boundaries[1].edges.size(), 4U);
    EXPECT_DOUBLE_EQ(boundary_length(system, system.boundaries[1]), 2.0);
}

// A hexagon inside has the area sqrt(3)/2 d^2 and the second moment 5 sqrt(3)/16 a^4 with a = d/sqrt(3).
TEST(BlockCutter, HexagonsInsideAreRegular) {
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.1, .rotation = 0.4, .offset = {0.013, 0.027}}, 0, {}};
    const BlockSystem system = sound_cut(spec).system;
    EXPECT_DOUBLE_EQ(system.spacing, 0.1);
    int n_inside = 0;
    for (const Block& block : system.blocks) {
        const bool inside =
            std::all_of(block.edges.begin(), block.edges.end(), [](const Edge& e) { return e.interface >= 0; });
        const Vec2 from_edge = block.centroid.cwiseMin(Vec2(1, 1) - block.centroid);
        if (!inside || from_edge.minCoeff() < 0.15) continue;
        ++n_inside;
        EXPECT_EQ(block.edges.size(), 6U);
        EXPECT_NEAR(block.area, 0.5 * std::numbers::sqrt3 * 0.01, 1e-15);
        const double expected = 5.0 * std::numbers::sqrt3 / 16.0 * std::pow(0.1 / std::numbers::sqrt3, 4);
        EXPECT_TRUE(block.second_moment.isApprox(expected * Mat2::Identity(), 1e-10));
    }
    EXPECT_GT(n_inside, 40);
}

// Hexagons that the outline does not cut stay whole: a body of hexagons only has 3 n interfaces less the rim's.
TEST(BlockCutter, ARegionKeepsWholeHexagonsWithTheirCentreInIt) {
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.125, .offset = {0.5, 0.5}}, 0, {}};
    spec.tessellation->region = Polygon{{0.49, 0.49}, {0.51, 0.49}, {0.51, 0.51}, {0.49, 0.51}};
    const BlockSystem system = sound_cut(spec).system;
    ASSERT_EQ(system.n_blocks(), 2);
    EXPECT_EQ(system.n_interfaces(), 6);
    EXPECT_NEAR(sorted_areas(system)[0], hexagon_area(0.125), 1e-16);
}

// The zigzag of hexagon edges itself, given as a fracture: no new blocks, the edges become the fracture's.
TEST(BlockCutter, AFractureAlongHexagonEdgesTakesThemOver) {
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.2, .offset = {0.03, 0.04}}, 1, {}};
    const CutBody plain = sound_cut(spec);
    const auto edges =
        hexagon_edges(spec.tessellation->hexagons, {Vec2(0, 0), Vec2(1, 1)}, [](const Vec2&) { return true; });
    double inside = 0.0;
    for (std::size_t i = 0; i < edges.size(); i += 3) {
        const auto& [a, b] = edges[i];
        const Box box{Vec2(0.2, 0.2), Vec2(0.8, 0.8)};
        if ((a - box.lower).minCoeff() < 0 || (box.upper - a).minCoeff() < 0 || (b - box.lower).minCoeff() < 0 ||
            (box.upper - b).minCoeff() < 0) {
            continue;
        }
        add_trace(spec, {a, b}, 2);
        inside += (b - a).norm();
    }
    ASSERT_GE(spec.fractures.size(), 5U);
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), plain.system.n_blocks());
    EXPECT_EQ(body.system.n_interfaces(), plain.system.n_interfaces());
    EXPECT_EQ(body.system.vertices.size(), plain.system.vertices.size());
    EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture), inside, 1e-13);
}

// Through the vertical flats of one column of hexagons: flats and the hexagons between are cut by one straight joint.
TEST(BlockCutter, AStraightFractureThroughFlatsIsOneJointWithoutSlivers) {
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.125, .offset = {0.0, 0.01}}, 1, {}};
    add_trace(spec, {{0.4375, -1}, {0.4375, 2}});
    const CutBody body = sound_cut(spec);
    EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture, 0), 1.0, 1e-14);
    for (const Interface& joint : body.system.interfaces) {
        if (joint.origin != EdgeOrigin::fracture) continue;
        const Edge& edge = body.system.blocks[joint.block_a].edges[joint.edge_a];
        EXPECT_EQ(edge_start(body.system, edge).x(), 0.4375);
    }
    for (const auto& piece : body.report.merged) {
        EXPECT_TRUE(piece.at.x() < 0.01 || piece.at.x() > 0.99 || piece.at.y() < 0.05 || piece.at.y() > 0.95);
    }
}

// Nearly along the flats: one sliver beside each flat, all of which go.
TEST(BlockCutter, AFractureNearlyAlongFlatsLeavesNoSlivers) {
    for (const double beside : {1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
        GeometrySpec spec = rectangle(1, 1);
        spec.tessellation = Tessellation{{.spacing = 0.125, .offset = {0.0, 0.01}}, 1, {}};
        add_trace(spec, {{0.4375 + beside, -1}, {0.4375 - beside, 2}});
        const CutBody body = sound_cut(spec);
        EXPECT_GE(body.report.smallest_area, 0.05 * hexagon_area(0.125));
        EXPECT_GE(body.report.smallest_edge, 0.02 * 0.125);
        EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture, 0), 1.0, 1e-5);
    }
}

// The strip of 0.005 m2 beside the outline is below 20 % of a hexagon of d = 0.2 (0.0069 m2), above 5 % of it.
TEST(BlockCutter, ASliverGoesIntoItsNeighbourAndIsReported) {
    GeometrySpec spec;
    spec.domain = {{10, 20}, {11, 20}, {11, 21}, {10, 21}};
    spec.reference_spacing = 0.2;
    add_trace(spec, {{10.005, 19}, {10.005, 22}});
    EXPECT_EQ(sound_cut(spec).system.n_blocks(), 2);

    spec.minimum_area = 0.2;
    const CutBody body = sound_cut(spec);
    ASSERT_EQ(body.system.n_blocks(), 1);
    EXPECT_EQ(body.system.blocks[0].edges.size(), 4U);
    ASSERT_EQ(body.report.merged.size(), 1U);
    EXPECT_NEAR(body.report.merged[0].area, 0.005, 1e-12);
    EXPECT_NEAR(body.report.merged[0].at.x(), 10.0025, 1e-12);
    EXPECT_NEAR(body.report.merged[0].at.y(), 20.5, 1e-12);
}

// Half a body is no sliver, however large the cells of the net are: 5 % of such a cell, 21.7 m2, would be 1.08 m2.
TEST(BlockCutter, ACellLargerThanTheBodyLosesNoJoint) {
    GeometrySpec spec = rectangle(1, 2);
    spec.tessellation = Tessellation{{.spacing = 5.0, .offset = {}}, 1, {}};
    add_trace(spec, {{-0.2, 0.0}, {1.2, 0.9}});
    const CutBody body = sound_cut(spec);
    EXPECT_TRUE(body.report.lost.empty());
    EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture, 0), std::hypot(1.0, 0.9 / 1.4), 1e-12);
}

// A corner of 0.5 x 0.1 x 0.1 m2 on a body of 1 m2: more or less than the minimum area, a fraction of that body.
TEST(BlockCutter, AJointThatCutsOffTooLittleIsSaidToDoSo) {
    GeometrySpec spec = rectangle(1, 1);
    spec.reference_spacing = 5.0;
    add_trace(spec, {{0.0, 0.1}, {0.1, 0.0}});
    spec.minimum_area = 0.004;
    EXPECT_EQ(sound_cut(spec).system.n_blocks(), 2);
    spec.minimum_area = 0.006;
    const CutBody body = sound_cut(spec);
    EXPECT_EQ(body.system.n_blocks(), 1);
    EXPECT_DOUBLE_EQ(body.report.minimum_area, 0.006);
    ASSERT_EQ(body.report.lost.size(), 1U);
    EXPECT_EQ(body.report.lost[0].cause, LostFracture::Cause::cuts_off_little);
    EXPECT_NEAR(body.report.lost[0].area, 0.005, 1e-12);
}

// One joint that is drawn twice, as on a map: what lies between the two lines is no block, though its area is above the minimum.
// Between two that are 1e-5 of the body's size apart lies a layer.
TEST(BlockCutter, AHairBetweenTwoTracesIsNoBlock) {
    for (const double apart : {1e-10, 1e-8, 1e-6}) {
        const std::vector<std::pair<Vec2, Vec2>> second = {{{-1, 2.0 - apart}, {11, 3.0 + apart}},
                                                           {{-1, 2}, {11, 3.0 + apart}},
                                                           {{-1, 2.0 + apart}, {11, 3.0 + apart}}};
        for (const auto& [from, to] : second) {
            GeometrySpec spec = rectangle(10, 10);
            add_trace(spec, {{-1, 2}, {11, 3}});
            add_trace(spec, {from, to});
            const CutBody body = sound_cut(spec);
            EXPECT_EQ(body.system.n_blocks(), 2) << apart;
            ASSERT_EQ(body.report.lost.size(), 1U) << apart;
            EXPECT_EQ(body.report.lost[0].cause, LostFracture::Cause::cuts_off_a_hair) << apart;
        }
    }
    GeometrySpec layer = rectangle(10, 10);
    add_trace(layer, {{-1, 2}, {11, 3}});
    add_trace(layer, {{-1, 2.0001}, {11, 3.0001}});
    EXPECT_EQ(sound_cut(layer).system.n_blocks(), 3);
}

TEST(BlockCutter, SliversPreferToLeaveAcrossTheTessellation) {
    for (int seed = 0; seed < 20; ++seed) {
        Uniform uniform(100 + seed);
        GeometrySpec spec = rectangle(1, 1);
        spec.tessellation = Tessellation{{.spacing = 0.1, .offset = {uniform(), uniform()}}, 1, {}};
        const double tilt = uniform(-0.3, 0.3);
        add_trace(spec, {{-0.1, 0.5 - tilt}, {1.1, 0.5 + tilt}});
        const CutBody body = sound_cut(spec);
        // No piece leaves across the one fracture, which so stays whole and straight but for its collapsed edges.
        EXPECT_NEAR(interface_length(body.system, EdgeOrigin::fracture, 0), std::hypot(1.0, 2.0 * tilt / 1.2), 1e-12);
    }
}

TEST(BlockCutter, MaterialsComeFromTheCentroid) {
    GeometrySpec spec = rectangle(4, 1);
    spec.material = 7;
    spec.regions = {{{{0, 0}, {2.2, 0}, {2.2, 1}, {0, 1}}, 1}, {{{0, 0}, {0.7, 0}, {0.7, 1}, {0, 1}}, 2}};
    for (const double x : {1.0, 2.0, 3.0}) add_trace(spec, {{x, 0}, {x, 1}});
    const BlockSystem system = sound_cut(spec).system;
    ASSERT_EQ(system.n_blocks(), 4);
    EXPECT_EQ(system.blocks[0].material, 2);
    EXPECT_EQ(system.blocks[1].material, 1);
    EXPECT_EQ(system.blocks[2].material, 7);
    EXPECT_EQ(system.blocks[3].material, 7);
}

GeometrySpec shifted(GeometrySpec spec, const Vec2& by) {
    const auto shift = [&by](std::vector<Vec2>& points) {
        for (Vec2& p : points) p += by;
    };
    shift(spec.domain);
    for (Polygon& hole : spec.holes) shift(hole);
    for (FractureTrace& trace : spec.fractures) shift(trace.points);
    return spec;
}

// Coordinates that are multiples of 2^-20 are exact near 6.7e6: a map far away is cut into the same bits.
TEST(BlockCutter, TheMapsOffsetDoesNotMatter) {
    Uniform uniform(11);
    GeometrySpec spec = rectangle(1, 1);
    const auto representable = [&uniform] { return std::round(uniform(-0.1, 1.1) * 0x1p20) * 0x1p-20; };
    for (int i = 0; i < 8; ++i) {
        const double x = representable();
        const double y = representable();
        const double u = representable();
        add_trace(spec, {{x, y}, {u, representable()}});
    }
    spec.tessellation = Tessellation{{.spacing = 0.1, .rotation = 0.1, .jitter = 0.1}, 0, {}};
    const Vec2 far(466011.0, 6692134.0);
    const CutBody near_body = sound_cut(spec);
    const CutBody far_body = sound_cut(shifted(spec, far));
    EXPECT_EQ(far_body.system.origin, near_body.system.origin + far);
    EXPECT_TRUE(same_blocks(near_body.system, far_body.system));
}

TEST(BlockCutter, TheOrderOfTheTracesDoesNotMatter) {
    Uniform uniform(12);
    GeometrySpec spec = rectangle(1, 1);
    add_random_traces(spec, 30, 1, 1, uniform);
    const auto areas = sorted_areas(sound_cut(spec).system);
    std::reverse(spec.fractures.begin(), spec.fractures.end());
    const auto reversed = sorted_areas(sound_cut(spec).system);
    ASSERT_EQ(areas.size(), reversed.size());
    for (std::size_t i = 0; i < areas.size(); ++i) EXPECT_NEAR(areas[i], reversed[i], 1e-13);
}

TEST(BlockCutter, RepeatsToTheBit) {
    Uniform uniform(13);
    GeometrySpec spec = rectangle(1, 1);
    spec.tessellation = Tessellation{{.spacing = 0.05, .jitter = 0.15, .seed = 4}, 0, {}};
    add_random_traces(spec, 10, 1, 1, uniform);
    EXPECT_TRUE(same_blocks(sound_cut(spec).system, sound_cut(spec).system));
}

class RandomCut : public testing::TestWithParam<int> {};

// Whatever crosses the body, the cut is a partition: areas and the lengths of the sides sum to the domain's, and a
// connected net without holes obeys Euler's V - E + F = 1.
TEST_P(RandomCut, IsAPartition) {
    Uniform uniform(1000 + GetParam());
    const double width = uniform(0.2, 2.0);
    const double height = uniform(0.2, 2.0);
    GeometrySpec spec = rectangle(width, height);
    const int kind = GetParam() % 4;
    if (kind != 3) {
        const double d = 0.15 * std::sqrt(width * height);
        spec.tessellation = Tessellation{{.spacing = d,
                                          .rotation = uniform(0, 1.0),
                                          .offset = {uniform(), uniform()},
                                          .jitter = kind == 0 ? 0.0 : 0.24 * uniform(),
                                          .seed = static_cast<std::uint64_t>(GetParam())},
                                         1,
                                         {}};
    } else {
        spec.reference_spacing = 0.1;
    }
    add_random_traces(spec, kind == 2 ? 60 : 8, width, height, uniform);
    const CutBody body = cut_blocks(spec);
    ASSERT_EQ(faults(spec, body), "");
    const BlockSystem& system = body.system;
    EXPECT_NEAR(boundary_length(system, system.boundaries[0]), width, 1e-12);
    EXPECT_NEAR(boundary_length(system, system.boundaries[1]), height, 1e-12);
    EXPECT_NEAR(boundary_length(system, system.boundaries[2]), width, 1e-12);
    EXPECT_NEAR(boundary_length(system, system.boundaries[3]), height, 1e-12);
    int n_loops = 0;
    int n_sides = 0;
    for (const Block& block : system.blocks) {
        n_loops += static_cast<int>(block.loop_starts.size());
        n_sides += static_cast<int>(block.edges.size());
    }
    if (n_loops == system.n_blocks()) {
        const int n_edges = n_sides - system.n_interfaces();
        EXPECT_EQ(static_cast<int>(system.vertices.size()) - n_edges + system.n_blocks(), 1);
    }
    if (spec.tessellation && system.n_blocks() > 1) {
        EXPECT_GE(body.report.smallest_area, 0.05 * hexagon_area(system.spacing));
    }
}

INSTANTIATE_TEST_SUITE_P(SlowSeeds, RandomCut, testing::Range(0, 120));

// Star-shaped outlines with acute corners in and out, and holes.
TEST_P(RandomCut, OfABentDomainWithHolesIsAPartition) {
    Uniform uniform(2000 + GetParam());
    GeometrySpec spec;
    const auto star = [&uniform](int n, double inner, double outer) {
        Polygon polygon;
        for (int i = 0; i < n; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / n;
            polygon.push_back(Vec2(5, 7) + uniform(inner, outer) * Vec2(std::cos(angle), std::sin(angle)));
        }
        return polygon;
    };
    spec.domain = star(8 + GetParam() % 20, 2.0, 4.0);
    if (GetParam() % 2 == 0) spec.holes = {star(5, 0.3, 1.0)};
    if (GetParam() % 3 != 0) {
        spec.tessellation = Tessellation{{.spacing = 0.6, .rotation = uniform(), .jitter = 0.1}, 1, {}};
        if (GetParam() % 5 == 0) spec.tessellation->region = star(6, 1.0, 3.0);
    } else {
        spec.reference_spacing = 0.3;
    }
    add_random_traces(spec, 10, 10, 14, uniform);
    EXPECT_EQ(faults(spec, cut_blocks(spec)), "");
}

class TurnedHexagons : public testing::TestWithParam<int> {};

// The parameter is the rotation in degrees. Offsets near and far, with and without jitter: a partition, no slivers.
TEST_P(TurnedHexagons, ArePartitionsAtAnyOffsetAndJitter) {
    Uniform uniform(5000 + GetParam());
    for (const double reach : {0.1, 30.0, 6.7e6}) {
        for (const double jitter : {0.0, 0.1, 0.24}) {
            GeometrySpec spec = rectangle(0.76, 1.0);
            spec.tessellation = Tessellation{{.spacing = 0.1,
                                              .rotation = GetParam() * std::numbers::pi / 180.0,
                                              .offset = {uniform(-reach, reach), uniform(-reach, reach)},
                                              .jitter = jitter,
                                              .seed = static_cast<std::uint64_t>(GetParam())},
                                             1,
                                             {}};
            add_random_traces(spec, 3, 0.76, 1.0, uniform);
            const CutBody body = cut_blocks(spec);
            EXPECT_EQ(faults(spec, body), "") << reach << ' ' << jitter;
            EXPECT_GE(body.report.smallest_area, 0.05 * hexagon_area(0.1));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(SlowDegrees, TurnedHexagons, testing::Range(0, 31));

// The net has the period (d, 0) along its rows: whole periods away it cuts the same blocks.
TEST(BlockCutter, HexagonsAreTheSameAfterWholePeriodsOfTheirOffset) {
    const auto cut_at = [](const Vec2& offset) {
        GeometrySpec spec = rectangle(1, 1);
        spec.tessellation = Tessellation{{.spacing = 0.125, .rotation = 0.4, .offset = offset}, 1, {}};
        return sorted_areas(sound_cut(spec).system);
    };
    const Vec2 along = 0.125 * Vec2(std::cos(0.4), std::sin(0.4));
    const auto near = cut_at({0.02, 0.03});
    const auto far = cut_at(Vec2(0.02, 0.03) + 4.0e7 * along); // 5000 km: its last digit is 9e-10 m
    ASSERT_EQ(near.size(), far.size());
    for (std::size_t i = 0; i < near.size(); ++i) EXPECT_NEAR(near[i], far[i], 1e-9);
}

class DegenerateCut : public testing::TestWithParam<int> {};

// Traces between the points of a coarse grid, so that many meet in a point, overlap or run along the outline; in odd
// rounds moved off it by 1e-3 to 1e-16, so that they nearly do.
TEST_P(DegenerateCut, OfTracesOnAGridIsAPartition) {
    Uniform uniform(3000 + GetParam());
    GeometrySpec spec = rectangle(1, 1);
    if (GetParam() % 3 != 0) spec.tessellation = Tessellation{{.spacing = 0.125}, 1, {}};
    const auto point = [&] {
        const Vec2 at(std::round(16.0 * uniform(-0.1, 1.1)) / 16.0, std::round(16.0 * uniform(-0.1, 1.1)) / 16.0);
        const double off = GetParam() % 2 == 0 ? 0.0 : std::pow(10.0, -uniform(3, 16));
        return Vec2(at + off * Vec2(uniform(-1, 1), uniform(-1, 1)));
    };
    for (int i = 0; i < 30; ++i) {
        const Vec2 a = point();
        add_trace(spec, {a, point()});
    }
    EXPECT_EQ(faults(spec, cut_blocks(spec)), "");
}

// Up to 60 traces that differ by 1e-1 to 1e-17 of the body: their ends on the outline round to the same doubles.
TEST_P(DegenerateCut, OfABundleOfTracesIsAPartition) {
    Uniform uniform(4000 + GetParam());
    GeometrySpec spec = rectangle(1, 1);
    if (GetParam() % 2 == 0) spec.tessellation = Tessellation{{.spacing = 0.1, .rotation = uniform()}, 1, {}};
    const std::vector<Vec2> first{{-0.1, uniform()}, {1.1, uniform()}};
    for (int i = 0; i < 2 * GetParam(); ++i) {
        std::vector<Vec2> points = first;
        const double off = std::pow(10.0, -uniform(1, 17));
        for (Vec2& p : points) p += off * Vec2(uniform(-1, 1), uniform(-1, 1));
        add_trace(spec, points);
    }
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    EXPECT_GE(body.system.n_blocks(), GetParam() > 0 ? 2 : 1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DegenerateCut, testing::Range(0, 30));

/// A domain, a spacing or an option out of range, and what the message must name.
struct BadSpec {
    std::string name;
    GeometrySpec spec;
    std::string named;
};

std::vector<BadSpec> bad_specs() {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const GeometrySpec good = rectangle(1, 1);
    std::vector<BadSpec> all;
    const auto add = [&](const std::string& name, const std::string& named) -> GeometrySpec& {
        all.push_back({name, good, named});
        return all.back().spec;
    };
    add("Empty", "geometry.domain").domain = {};
    add("TwoPoints", "geometry.domain").domain = {{0, 0}, {1, 0}};
    add("NotANumber", "geometry.domain").domain[2] = {nan, 0};
    add("Infinite", "geometry.domain").domain[2] = {1, std::numeric_limits<double>::infinity()};
    add("BowTie", "the outline crosses or touches itself at (0.5, 0.5)").domain = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    add("Touching", "the outline crosses or touches itself at (1, 0)").domain = {
        {0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}};
    add("Flat", "crosses or touches").domain = {{0, 0}, {1, 0}, {2, 0}};
    add("RepeatedPoint", "the same").domain = {{0, 0}, {1, 0}, {1, 0}, {1, 1}};
    add("HoleOutside", "hole 0, from (2, 2) on, lies outside").holes = {{{2, 2}, {3, 2}, {3, 3}}};
    add("HoleAcross", "the outline crosses or touches hole 0 at (1, 0.5)").holes = {
        {{0.5, 0.5}, {1.5, 0.5}, {0.5, 1.5}}};
    add("HoleAtHole", "hole 0 crosses or touches hole 1 at (0.5, 0.5)").holes = {{{0.1, 0.1}, {0.5, 0.5}, {0.1, 0.9}},
                                                                                 {{0.5, 0.5}, {0.9, 0.1}, {0.9, 0.9}}};
    add("HoleInHole", "hole 1").holes = {{{0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.1, 0.9}},
                                         {{0.4, 0.4}, {0.6, 0.4}, {0.5, 0.6}}};
    add("SideOutOfRange", "boundaries.top").boundaries = {{"top", {4}}};
    add("SideTwice", "boundaries.b").boundaries = {{"a", {1}}, {"b", {1}}};
    add("ShortTrace", "geometry.fractures.0").fractures = {{{{0, 0}}, 0, ""}};
    add("TraceNotANumber", "geometry.fractures.0 (main)").fractures = {{{{0, 0}, {nan, 1}}, 0, "main"}};
    add("NoSpacing", "spacing").tessellation = Tessellation{};
    add("FarOffset", "offset").tessellation = Tessellation{{.spacing = 0.1, .offset = {2e8, 0}}, 0, {}};
    add("Jitter", "jitter").tessellation = Tessellation{{.spacing = 0.1, .jitter = 0.3}, 0, {}};
    add("MinimumArea", "minimum_area").minimum_area = -0.1;
    add("ReferenceSpacing", "reference_spacing").reference_spacing = nan;
    add("Region", "region").regions = {{{{0, 0}, {1, 1}}, 0}};
    return all;
}

// A length far beyond the body is nothing that is lost in it: the joint became the diagonal of the body.
TEST(BlockCutter, AReferenceBeyondTheBodyMovesNoFracture) {
    GeometrySpec spec = rectangle(1, 2);
    spec.fractures = {{{{-1, 1}, {2, 1}}, 0, "joint"}};
    for (const double reference : {3.0, 100.0, 1e6}) {
        spec.reference_spacing = reference;
        const CutBody body = cut_blocks(spec);
        ASSERT_EQ(body.system.n_blocks(), 2) << reference;
        for (const Block& block : body.system.blocks) {
            EXPECT_DOUBLE_EQ(block.area, 1.0) << reference;
            EXPECT_EQ(block.edges.size(), 4U) << reference;
        }
    }
}

TEST(BlockCutter, NamesWhatIsWrongWithItsInput) {
    for (const BadSpec& bad : bad_specs()) {
        try {
            static_cast<void>(cut_blocks(bad.spec));
            ADD_FAILURE() << bad.name << " was accepted";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(bad.named), std::string::npos) << bad.name << ": " << error.what();
        }
    }
}

TEST(LatticeSpacing, IsTheTessellationsElseTheReferenceElseZero) {
    GeometrySpec spec = rectangle(1, 1);
    EXPECT_EQ(lattice_spacing(spec), 0.0);
    spec.reference_spacing = 0.3;
    EXPECT_EQ(lattice_spacing(spec), 0.3);
    spec.tessellation = Tessellation{{.spacing = 0.1}, 0, {}};
    EXPECT_EQ(lattice_spacing(spec), 0.1);
}

} // namespace
} // namespace kluft

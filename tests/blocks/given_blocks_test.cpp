#include "kluft/blocks/given_blocks.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/blocks/block_check.hpp"
#include "kluft/blocks/block_cutter.hpp"
#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Polygon rectangle_at(double x, double y, double width, double height) {
    return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

GeometrySpec spec_of(std::vector<std::pair<std::string, Polygon>> blocks) {
    GeometrySpec spec;
    for (auto& [name, polygon] : blocks) spec.blocks.push_back({name, std::move(polygon)});
    return spec;
}

double interface_length(const BlockSystem& system, int i) {
    const Interface& joint = system.interfaces[i];
    const Edge& edge = system.blocks[joint.block_a].edges[joint.edge_a];
    return (edge_end(system, edge) - edge_start(system, edge)).norm();
}

std::string refusal(const GeometrySpec& spec) {
    try {
        (void)cut_blocks(spec);
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST(GivenBlocks, KeepTheirOrderTheirNamesAndTheirMaterials) {
    GeometrySpec spec = spec_of({{"upper", rectangle_at(5, 8, 2, 1)}, {"lower", rectangle_at(5, 7, 2, 1)}});
    spec.blocks[0].material = 1;
    spec.blocks[1].fixed = true;
    spec.blocks_interface = 3;
    const BlockSystem system = cut_blocks(spec).system;
    EXPECT_THAT(system.block_names, ElementsAre("upper", "lower"));
    EXPECT_EQ(system.interfaces.at(0).interface_type, 3);
    EXPECT_EQ(system.outline_type, 3) << "surfaces that come to meet are like those that met before";
    EXPECT_EQ(system.blocks[0].material, 1);
    EXPECT_TRUE(system.blocks[1].fixed);
    EXPECT_EQ(system.origin, Vec2(5, 7));
    EXPECT_EQ(system.upper, Vec2(2, 2));
    EXPECT_DOUBLE_EQ(system.spacing, std::sqrt(2.0)) << "of the block that is not fixed";
    ASSERT_EQ(system.n_interfaces(), 1);
    EXPECT_DOUBLE_EQ(interface_length(system, 0), 2.0);
    EXPECT_THAT(check_block_system(system, {.domain_area = 4.0}), IsEmpty());
}

// A brick on two others: its lower edge is split where they meet.
TEST(GivenBlocks, EdgesAreSplitWhereTwoNeighboursMeet) {
    const BlockSystem system = cut_blocks(spec_of({{"left", rectangle_at(0, 0, 2, 1)},
                                                   {"right", rectangle_at(2, 0, 2, 1)},
                                                   {"upper", rectangle_at(1, 1, 2, 1)}}))
                                   .system;
    EXPECT_THAT(check_block_system(system, {.domain_area = 6.0}), IsEmpty());
    ASSERT_EQ(system.n_interfaces(), 3);
    for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(interface_length(system, i), 1.0);
    EXPECT_EQ(system.blocks[2].edges.size(), 5U);
    EXPECT_EQ(system.blocks[0].edges.size(), 5U) << "split at the corner of the upper one";
}

TEST(GivenBlocks, StandOnASteppedBase) {
    GeometrySpec spec = spec_of({{"base", {{0, -1}, {3, -1}, {3, 1}, {2, 1}, {2, 0.5}, {1, 0.5}, {1, 0}, {0, 0}}},
                                 {"a", rectangle_at(0, 0, 1, 2)},
                                 {"b", rectangle_at(1, 0.5, 1, 2)},
                                 {"c", rectangle_at(2, 1, 1, 2)}});
    const BlockSystem system = cut_blocks(spec).system;
    EXPECT_THAT(check_block_system(system), IsEmpty());
    std::map<std::pair<int, int>, double> lengths;
    for (int i = 0; i < system.n_interfaces(); ++i)
        lengths[{system.interfaces[i].block_a, system.interfaces[i].block_b}] += interface_length(system, i);
    EXPECT_THAT(lengths, ElementsAre(testing::Pair(std::pair(0, 1), 1.5), testing::Pair(std::pair(0, 2), 1.5),
                                     testing::Pair(std::pair(0, 3), 1.0), testing::Pair(std::pair(1, 2), 1.5),
                                     testing::Pair(std::pair(2, 3), 1.5)));
}

// On a slope the coordinates are rounded: corners that agree within 1e-9 of the body's size are the same.
TEST(GivenBlocks, ShareSlopingEdgesInSpiteOfRounding) {
    const Vec2 along(std::cos(0.5), std::sin(0.5));
    const Vec2 up(-along.y(), along.x());
    const auto on_slope = [&](double from, double to) {
        return Polygon{from * along, to * along, to * along + up, from * along + up};
    };
    const BlockSystem system = cut_blocks(spec_of({{"base", {{0, 0}, {8 * along.x(), 0}, 8 * along}},
                                                   {"a", on_slope(1.0 / 3.0, 2.1)},
                                                   {"b", on_slope(2.1 + 1e-10, 5.7)}}))
                                   .system;
    EXPECT_THAT(check_block_system(system), IsEmpty());
    ASSERT_EQ(system.n_interfaces(), 3);
    EXPECT_NEAR(interface_length(system, 0), 3.6, 1e-9);
    EXPECT_NEAR(interface_length(system, 1), 2.1 - 1.0 / 3.0, 1e-9);
    EXPECT_NEAR(interface_length(system, 2), 1.0, 1e-9);
}

TEST(GivenBlocks, RingOfVoussoirsClosesWithGapsInside) {
    GeometrySpec spec;
    const int n = 12;
    for (int i = 0; i < n; ++i) {
        const auto at = [&](double radius, int k) {
            const double angle = 2.0 * std::numbers::pi * k / n;
            return Vec2(radius * std::cos(angle), radius * std::sin(angle));
        };
        spec.blocks.push_back({std::to_string(i), {at(1, i), at(2, i), at(2, i + 1), at(1, i + 1)}});
    }
    const BlockSystem system = cut_blocks(spec).system;
    EXPECT_THAT(check_block_system(system), IsEmpty());
    EXPECT_EQ(system.n_interfaces(), n);
}

// Such a corner is found by contact detection as a vertex against an edge.
TEST(GivenBlocks, CornerThatOnlyTouchesASideDoesNotSplitIt) {
    const BlockSystem system =
        cut_blocks(spec_of({{"base", rectangle_at(0, 0, 4, 1)}, {"roof", {{2, 1}, {3, 2}, {2, 3}, {1, 2}}}})).system;
    EXPECT_EQ(system.n_interfaces(), 0);
    EXPECT_EQ(system.blocks[0].edges.size(), 4U);
}

TEST(GivenBlocks, MayHaveGapsBetweenThem) {
    const BlockSystem system =
        cut_blocks(spec_of({{"a", rectangle_at(0, 0, 1, 1)}, {"b", rectangle_at(1.001, 0, 1, 1)}})).system;
    EXPECT_EQ(system.n_interfaces(), 0);
    EXPECT_THAT(check_block_system(system, {.domain_area = 2.0}), IsEmpty());
}

TEST(GivenBlocks, OverlapsAreRefusedWithBothNames) {
    const auto overlap = AllOf(HasSubstr("geometry.blocks"), HasSubstr("'a' and 'b'"), HasSubstr("overlap"));
    EXPECT_THAT(refusal(spec_of({{"a", rectangle_at(0, 0, 2, 2)}, {"b", rectangle_at(1, 1, 2, 2)}})), overlap)
        << "crossing";
    EXPECT_THAT(refusal(spec_of({{"a", rectangle_at(0, 0, 3, 3)}, {"b", rectangle_at(1, 1, 1, 1)}})), overlap)
        << "inside";
    EXPECT_THAT(refusal(spec_of({{"a", rectangle_at(0, 0, 1, 1)}, {"b", rectangle_at(0, 0, 1, 1)}})), overlap)
        << "the same";
    EXPECT_THAT(refusal(spec_of({{"a", rectangle_at(0, 0, 2, 1)}, {"b", rectangle_at(1, 0, 2, 1)}})), overlap)
        << "flush";
    EXPECT_THAT(refusal(spec_of({{"a", rectangle_at(0, 0, 3, 1)}, {"b", rectangle_at(1, 0, 1, 1)}})), overlap)
        << "across";
    EXPECT_THAT(refusal(spec_of({{"a", rectangle_at(0, 0, 1, 1)}, {"b", rectangle_at(1 - 1e-6, 0, 1, 1)}})), overlap)
        << "by a little";
    EXPECT_THAT(refusal(spec_of({{"a", {{0, 0}, {2, 0}, {2, 2}}}, {"b", {{1, 0.5}, {2, 0}, {3, 3}}}})), overlap)
        << "from a common corner";
}

TEST(GivenBlocks, BoundariesHaveTheFreePartsOfTheirSides) {
    GeometrySpec spec = spec_of({{"base", rectangle_at(0, 0, 4, 1)}, {"column", rectangle_at(1, 1, 1, 2)}});
    spec.boundaries = {{"top", {2, 6}}, {"push", {7}, "column"}};
    const BlockSystem system = cut_blocks(spec).system;
    double top = 0.0;
    for (const auto& [b, e] : system.boundaries[0].edges) {
        const Edge& edge = system.blocks[b].edges[e];
        top += (edge_end(system, edge) - edge_start(system, edge)).norm();
    }
    EXPECT_DOUBLE_EQ(top, 3.0 + 1.0);
    ASSERT_EQ(system.boundaries[1].edges.size(), 1U);
    EXPECT_EQ(system.boundaries[1].edges[0].block, 1);
    EXPECT_THAT(check_block_system(system), IsEmpty());
    spec.boundaries = {{"foot", {4}, "column"}};
    EXPECT_THAT(refusal(spec), AllOf(HasSubstr("boundaries.foot"), HasSubstr("'column'")));
}

/// Length of a boundary on a block (m).
double length_on(const BlockSystem& system, int boundary, int block) {
    double sum = 0.0;
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        const Edge& edge = system.blocks[b].edges[e];
        if (b == block) sum += (edge_end(system, edge) - edge_start(system, edge)).norm();
    }
    return sum;
}

// A column of 1 m on a base of 4 m whose coordinates miss it by 1 mm. The column's size is the square root of 2 m2; a twentieth of that
// is left out on each side of it, too.
TEST(GivenBlocks, BoundariesOfAllOfThemLeaveOutOpenJoints) {
    GeometrySpec spec = spec_of({{"base", rectangle_at(0, 0, 4, 1)}, {"column", rectangle_at(1, 1.001, 1, 2)}});
    spec.boundaries = {{"bottom", {0, 4}}, {"top", {2, 6}}};
    const CutBody body = cut_blocks(spec);
    EXPECT_DOUBLE_EQ(length_on(body.system, 0, 0), 4.0);
    EXPECT_EQ(length_on(body.system, 0, 1), 0.0) << "its underside";
    EXPECT_DOUBLE_EQ(length_on(body.system, 1, 0), 3.0 - 0.1 * std::sqrt(2.0)) << "beside the column";
    EXPECT_DOUBLE_EQ(length_on(body.system, 1, 1), 1.0);
    EXPECT_THAT(check_block_system(body.system), IsEmpty());
    ASSERT_EQ(body.report.inner_sides.size(), 2U);
    const InnerSide& below = body.report.inner_sides[0];
    EXPECT_EQ(below.boundary, 1);
    EXPECT_EQ(below.block, 0);
    EXPECT_EQ(below.other, 1);
    EXPECT_NEAR(below.gap, 0.001, 1e-12);
    EXPECT_DOUBLE_EQ(below.length, 1.0 + 0.1 * std::sqrt(2.0));
    EXPECT_NEAR((below.at - Vec2(1.5, 1.0)).norm(), 0.0, 1e-12);
}

TEST(GivenBlocks, BoundariesThatCarryNothingLeaveTheSidesWhole) {
    GeometrySpec spec = spec_of({{"base", rectangle_at(0, 0, 4, 1)}, {"column", rectangle_at(1, 1.001, 1, 2)}});
    spec.boundaries = {{.name = "top", .sides = {2, 6}, .carries = false}};
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(body.system.blocks[0].edges.size(), 4U);
    EXPECT_THAT(body.report.inner_sides, IsEmpty());
}

TEST(GivenBlocks, ABoundaryOfOneOfThemHasItsSidesAsTheyAre) {
    GeometrySpec spec = spec_of({{"base", rectangle_at(0, 0, 4, 1)}, {"column", rectangle_at(1, 1.001, 1, 2)}});
    spec.boundaries = {{"foot", {4}, "column"}, {"bed", {2}, "base"}};
    const CutBody body = cut_blocks(spec);
    EXPECT_DOUBLE_EQ(length_on(body.system, 0, 1), 1.0);
    EXPECT_DOUBLE_EQ(length_on(body.system, 1, 0), 4.0);
    EXPECT_THAT(body.report.inner_sides, IsEmpty());
}

TEST(GivenBlocks, OverhangsOpeningsAndNeighboursOnOneLineBelongToTheOutside) {
    // a lintel of 3 m on two posts, an opening of 0.5 m below it; the posts stand 1 m apart
    GeometrySpec spec = spec_of({{"left", rectangle_at(0, 0, 1, 0.5)},
                                 {"right", rectangle_at(2, 0, 1, 0.5)},
                                 {"lintel", rectangle_at(0, 0.5, 3, 1)},
                                 {"beside", rectangle_at(3, 0.5, 1, 1)}});
    spec.boundaries = {{"bottom", {0, 4, 8, 12}}, {"top", {2, 6, 10, 14}}};
    const CutBody body = cut_blocks(spec);
    EXPECT_DOUBLE_EQ(length_on(body.system, 0, 0), 1.0);
    EXPECT_DOUBLE_EQ(length_on(body.system, 0, 2), 1.0) << "the roof of the opening";
    EXPECT_DOUBLE_EQ(length_on(body.system, 0, 3), 1.0) << "an overhang";
    EXPECT_DOUBLE_EQ(length_on(body.system, 1, 2), 3.0);
    EXPECT_DOUBLE_EQ(length_on(body.system, 1, 3), 1.0);
    EXPECT_THAT(body.report.inner_sides, IsEmpty());
}

// The upper of two blocks that touch is 3 mm wider: its overhang would hold it.
TEST(GivenBlocks, BoundariesLeaveOutStripsBesideASharedEdge) {
    GeometrySpec spec = spec_of({{"lower", rectangle_at(0, 0, 1, 1)}, {"upper", rectangle_at(0, 1, 1.003, 1)}});
    spec.boundaries = {{"bottom", {0, 4}}};
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(body.system.n_interfaces(), 1);
    EXPECT_EQ(length_on(body.system, 0, 1), 0.0);
    ASSERT_EQ(body.report.inner_sides.size(), 1U);
    EXPECT_EQ(body.report.inner_sides[0].gap, 0.0);
    EXPECT_NEAR(body.report.inner_sides[0].length, 0.003, 1e-12);
    EXPECT_THAT(check_block_system(body.system), IsEmpty());
}

TEST(BlockSets, AreFormedByNameAndByPlace) {
    GeometrySpec spec =
        spec_of({{"a", rectangle_at(0, 0, 1, 1)}, {"b", rectangle_at(1, 0, 1, 1)}, {"c", rectangle_at(2, 0, 1, 1)}});
    spec.sets = {{"ends", {}, {2, 0}, true}, {"left half", rectangle_at(-1, -1, 2.7, 3), {}, false}};
    const BlockSystem system = cut_blocks(spec).system;
    EXPECT_THAT(blocks_called(system, "ends"), ElementsAre(0, 2));
    EXPECT_THAT(blocks_called(system, "left half"), ElementsAre(0, 1));
    EXPECT_THAT(blocks_called(system, "b"), ElementsAre(1));
    EXPECT_THAT(blocks_called(system, "d"), IsEmpty());
    EXPECT_EQ(block_called(system, "c", ""), 2);
    EXPECT_THROW((void)block_called(system, "ends", "here"), InputError);
    EXPECT_TRUE(system.blocks[0].fixed && !system.blocks[1].fixed && system.blocks[2].fixed);
    EXPECT_EQ(block_label(system, 1), "'b'");
    spec.sets = {{"far", rectangle_at(10, 10, 1, 1), {}, false}};
    EXPECT_THAT(refusal(spec), HasSubstr("geometry.sets.far"));
}

TEST(BlockSets, HoldBlocksOfABodyThatWasCut) {
    GeometrySpec spec;
    spec.domain = rectangle_at(0, 0, 2, 1);
    spec.fractures.push_back({{{1, -1}, {1, 2}}, 0, "middle"});
    spec.sets = {{"right", rectangle_at(1, 0, 1, 1), {}, true}};
    const BlockSystem system = cut_blocks(spec).system;
    EXPECT_THAT(blocks_called(system, "right"), ElementsAre(1));
    EXPECT_TRUE(system.blocks[1].fixed);
    EXPECT_EQ(block_label(system, 1), "1");
}

TEST(BlockSearch, FindsTheBlockWithAPointInItOrOnItsOutline) {
    const BlockSystem system =
        cut_blocks(spec_of({{"a", rectangle_at(10, 10, 1, 1)},
                            {"l", {{12, 10}, {14, 10}, {14, 11}, {13, 11}, {13, 12}, {12, 12}}}}))
            .system;
    EXPECT_EQ(block_containing(system, {10.5, 10.5}), 0);
    EXPECT_EQ(block_containing(system, {10.0, 11.0}), 0) << "a corner";
    EXPECT_EQ(block_containing(system, {12.5, 12.0}), 1) << "on a side";
    EXPECT_EQ(block_containing(system, {12.5, 11.0}), 1) << "level with a corner";
    EXPECT_EQ(block_containing(system, {13.5, 11.5}), -1) << "in the notch";
    EXPECT_EQ(block_containing(system, {11.5, 10.5}), -1);
}

} // namespace
} // namespace kluft

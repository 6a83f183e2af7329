// A net that is too coarse for what lies in it: openings (tests/scene/scene_model_test.cpp) and rock bridges. Expected numbers of
// cells are lengths over the spacing of the net.
#include "kluft/scene/coarse_places.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<InterfaceType> types{{.name = "joint", .kind = InterfaceKind::fracture},
                                       {.name = "bond", .kind = InterfaceKind::potential_crack}};

/// Everything turned about the origin, for a warning does not depend on axes.
struct BodyInNet {
    double angle = 0.0;

    [[nodiscard]] Vec2 turned(const Vec2& p) const {
        return {std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y()};
    }

    /// A square of 20 m with triangles of 0.5 m.
    [[nodiscard]] GeometrySpec with(const std::vector<FractureTrace>& fractures) const {
        GeometrySpec geometry;
        for (const Vec2& corner : {Vec2(-10, -10), Vec2(10, -10), Vec2(10, 10), Vec2(-10, 10)})
            geometry.domain.push_back(turned(corner));
        geometry.tessellation.emplace();
        geometry.tessellation->triangles.emplace();
        geometry.tessellation->triangles->spacing = 0.5;
        for (FractureTrace trace : fractures) {
            for (Vec2& point : trace.points) point = turned(point);
            geometry.fractures.push_back(std::move(trace));
        }
        return geometry;
    }
};

std::vector<std::string> warnings_beside(const GeometrySpec& geometry) {
    CutReport report;
    report.resolution = 0.025;
    return coarse_places(geometry, report, types);
}

FractureTrace joint(const std::string& name, Vec2 from, Vec2 to) { return {{from, to}, 0, name, "scene.yaml:9:5"}; }

class RockBridges : public ::testing::TestWithParam<double> {
protected:
    BodyInNet body{GetParam() * std::numbers::pi / 180.0};
};

TEST_P(RockBridges, OfFewCellsAreWarnedOf) {
    const auto gap = [this](double length) {
        return warnings_beside(body.with({joint("left", {-6, 0}, {-1, 0}), joint("right", {-1 + length, 0}, {6, 0})}));
    };
    EXPECT_THAT(gap(0.8),
                ElementsAre(AllOf(HasSubstr("scene.yaml:9:5: left ends at "), HasSubstr("0.8 m before right, "),
                                  HasSubstr("with 1.6 cells of the net along this rock bridge: "),
                                  HasSubstr("grading.fractures (or a smaller spacing) makes the net finer there"))));
    EXPECT_THAT(gap(1.9), ElementsAre(HasSubstr("3.8 cells")));
    EXPECT_THAT(gap(2.1), IsEmpty());
}

TEST_P(RockBridges, AreCountedOfTwoLinesEach) {
    const std::vector<FractureTrace> in_a_row{joint("a", {-6, 0}, {-4, 0}), joint("b", {-3, 0}, {0, 0}),
                                              joint("c", {0.9, 0}, {3, 0}), joint("d", {3.8, 0}, {6, 0})};
    EXPECT_THAT(warnings_beside(body.with(in_a_row)),
                ElementsAre(AllOf(HasSubstr("c ends at "), HasSubstr("0.8 m before d"),
                                  HasSubstr("rock bridge (and fewer than four along 2 more): "))));
    GeometrySpec without_b = body.with(in_a_row);
    CutReport report;
    report.lost.push_back({.fracture = 1, .cause = LostFracture::Cause::too_short});
    EXPECT_THAT(coarse_places(without_b, report, types), ElementsAre(HasSubstr("c ends at ")))
        << "what is left out ends nowhere";
}

TEST_P(RockBridges, AreMeasuredToTheSidesOfTheBodyAndOfHoles) {
    EXPECT_THAT(warnings_beside(body.with({joint("main", {-6, 0}, {9, 0})})),
                ElementsAre(AllOf(HasSubstr("1 m before the outline of the body, "), HasSubstr("2 cells"))));
    GeometrySpec with_hole = body.with({joint("main", {-6, 0}, {0.5, 0})});
    with_hole.holes.emplace_back();
    for (const Vec2& corner : {Vec2(2, -3), Vec2(8, -3), Vec2(8, 3), Vec2(2, 3)})
        with_hole.holes.front().push_back(body.turned(corner));
    EXPECT_THAT(warnings_beside(with_hole),
                ElementsAre(AllOf(HasSubstr("1.5 m before hole 0, "), HasSubstr("3 cells"))));
}

TEST_P(RockBridges, AreNotWhereFracturesAreJoined) {
    EXPECT_THAT(warnings_beside(body.with({joint("through", {-11, 0}, {11, 0})})), IsEmpty()) << "from side to side";
    EXPECT_THAT(warnings_beside(body.with({joint("daylighting", {-10, 0}, {-9, 0})})), IsEmpty()) << "of its own side";
    EXPECT_THAT(warnings_beside(body.with({joint("long", {-6, 0}, {6, 0}), joint("tee", {0, 0.01}, {0, 5})})),
                IsEmpty());
    EXPECT_THAT(warnings_beside(body.with({joint("long", {-6, 0}, {6, 0}), joint("cross", {0, -1}, {0, 5})})),
                IsEmpty());
    FractureTrace bridge = joint("bridge", {-1, 0}, {0, 0});
    bridge.interface_type = 1;
    EXPECT_THAT(warnings_beside(body.with({joint("left", {-6, 0}, {-1, 0}), bridge, joint("right", {0, 0}, {6, 0})})),
                IsEmpty())
        << "the bridge is a mapped crack, with a strength of its own";
}

// What a short way along the lines leads round is a wedge or a piece of the same fracture, not a bridge.
TEST_P(RockBridges, AreNotWhereLinesGoRound) {
    EXPECT_THAT(warnings_beside(body.with({joint("a", {-6, 0}, {0, 0}), joint("b", {0, 0}, {1, 0.2}),
                                           joint("c", {1, 0.2}, {1.5, 0.7}), joint("d", {0, 0}, {0.5, 1})})),
                IsEmpty());
    EXPECT_THAT(warnings_beside(body.with({joint("ring", {-1, -1}, {1, -1}), joint("far", {-9, 4}, {-9, 0})})),
                ElementsAre(HasSubstr("far ends at ")));
    FractureTrace closed = joint("closed", {-1, -1}, {1, -1});
    closed.points.insert(closed.points.end(), {Vec2(0, 1), Vec2(-1, -1)});
    EXPECT_THAT(warnings_beside(body.with({closed, joint("near", {-6, -1.5}, {6, -1.5})})), IsEmpty())
        << "it has no end";
    GeometrySpec notch = body.with({joint("notch", {0, 3}, {0, 4})});
    notch.holes.emplace_back();
    for (int k = 0; k < 32; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 32;
        notch.holes.front().push_back(body.turned({3.0 * std::sin(angle), 3.0 * std::cos(angle)}));
    }
    notch.tessellation->triangles->grading.openings = 0.4;
    EXPECT_THAT(warnings_beside(notch), IsEmpty());
}

// Two lines that are joined 8 m away and end 1 m apart.
TEST_P(RockBridges, AreWhereLinesAreJoinedFarAway) {
    EXPECT_THAT(warnings_beside(body.with(
                    {joint("a", {-8, 0}, {0, 0}), joint("b", {-8, 0}, {-8, 1}), joint("c", {-8, 1}, {6, 1})})),
                ElementsAre(AllOf(HasSubstr("a ends at "), HasSubstr("1 m before c, "))));
}

// Sides from 0.2 m on that grow by 0.3 m a metre from both ends: 2 ln(1 + 0.3 x 0.75/0.2)/0.3 = 5.0 along 1.5 m, and from
// one end to a side of the body, up to 0.5 m behind 1 m: ln(1 + 0.3/0.2)/0.3 = 3.05 and 0.5/0.5 = 1, 4.05 in all.
TEST_P(RockBridges, HaveCellsThatGrowFromTheirEnds) {
    const auto cells = [this](double growth, const FractureTrace& a, const FractureTrace& b) {
        GeometrySpec geometry = body.with({a, b});
        geometry.tessellation->triangles->grading.fractures = 0.2;
        geometry.tessellation->triangles->grading.growth = growth;
        return warnings_beside(geometry);
    };
    const FractureTrace left = joint("left", {-6, 0}, {-1, 0});
    EXPECT_THAT(cells(0.3, left, joint("right", {0.5, 0}, {6, 0})), IsEmpty());
    EXPECT_THAT(cells(1.0, left, joint("right", {0.4, 0}, {6, 0})),
                ElementsAre(HasSubstr("3.4 cells"))); // 2 (ln(2.5) + 0.4/0.5)
    EXPECT_THAT(cells(0.3, left, joint("out", {6, 5}, {8.5, 5})), IsEmpty());
    EXPECT_THAT(cells(0.3, left, joint("out", {6, 5}, {8.6, 5})), ElementsAre(HasSubstr("3.9 cells")));
}

TEST_P(RockBridges, AreMeasuredInCellsOfTheNetThere) {
    GeometrySpec geometry = body.with({joint("left", {-6, 0}, {-1, 0}), joint("right", {0, 0}, {6, 0})});
    TriangleGrading& grading = geometry.tessellation->triangles->grading;
    grading.fractures = 0.1;
    EXPECT_THAT(warnings_beside(geometry), IsEmpty());
    grading.fractures = 0.0;
    grading.region = {body.turned({-2, -2}), body.turned({2, -2}), body.turned({2, 2}), body.turned({-2, 2})};
    grading.region_spacing = 0.3;
    EXPECT_THAT(warnings_beside(geometry), ElementsAre(HasSubstr("3.3 cells")));
    geometry.tessellation->region = {body.turned({5, -2}), body.turned({9, -2}), body.turned({9, 2})};
    EXPECT_THAT(warnings_beside(geometry), IsEmpty()) << "outside the net nothing can crack";
    geometry.tessellation->region.reset();
    geometry.tessellation->triangles.reset();
    geometry.tessellation->hexagons.spacing = 0.5;
    EXPECT_THAT(warnings_beside(geometry),
                ElementsAre(AllOf(HasSubstr("2 cells"), HasSubstr("a smaller spacing makes the net finer there"))));
    geometry.tessellation.reset();
    EXPECT_THAT(warnings_beside(geometry), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Turned, RockBridges, ::testing::Values(0.0, 30.0, 77.0));

} // namespace
} // namespace kluft

#include "kluft/blocks/triangle_net.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blocks/cut_scenes.hpp"
#include "kluft/blocks/free_pieces.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/geometry/predicates.hpp"

namespace kluft {
namespace {

using namespace cut_scenes;

GeometrySpec triangulated(double width, double height, const TriangleNet& net) {
    GeometrySpec spec = rectangle(width, height);
    spec.tessellation = Tessellation{};
    spec.tessellation->triangles = net;
    return spec;
}

std::string described(const TriangleNet& net) {
    return "a " + std::to_string(net.spacing) + ", seed " + std::to_string(net.seed) + ", passes " +
           std::to_string(net.relaxation);
}

TEST(TriangleNet, FillsABodyWithTrianglesOfTheMeanAreaAskedForWithoutSmallAngles) {
    for (const double side : {1.0, 0.5, 0.23}) {
        for (const int passes : {0, 1, 5}) {
            for (const std::uint64_t seed : {1U, 2U}) {
                const TriangleNet net{.spacing = side, .relaxation = passes, .seed = seed, .grading = {}};
                const GeometrySpec spec = triangulated(5.0, 10.0, net);
                const CutBody body = cut_blocks(spec);
                SCOPED_TRACE(described(net));
                EXPECT_EQ(faults(spec, body), "");
                for (const Block& block : body.system.blocks) EXPECT_EQ(block.edges.size(), 3U);
                EXPECT_GE(body.report.smallest_angle, smallest_triangle_angle);
                EXPECT_NEAR(body.system.n_blocks(), 50.0 / triangle_area(side),
                            2.0 + 0.01 * 50.0 / triangle_area(side));
            }
        }
    }
}

TEST(TriangleNet, IsAFunctionOfItsSeed) {
    const auto vertices = [](std::uint64_t seed) {
        return cut_blocks(triangulated(3.0, 3.0, {.spacing = 0.4, .relaxation = 1, .seed = seed, .grading = {}}))
            .system.vertices;
    };
    EXPECT_EQ(vertices(7), vertices(7));
    EXPECT_NE(vertices(7), vertices(8));
}

TEST(TriangleNet, PrefersNoDirection) {
    // The mean of cos 4 theta and cos 6 theta over the edges' directions, weighted by length, vanishes for an isotropic
    // net; n independent edges scatter by 1/sqrt(2 n).
    const CutBody body =
        cut_blocks(triangulated(20.0, 20.0, {.spacing = 0.4, .relaxation = 0, .seed = 3, .grading = {}}));
    double total = 0.0;
    Vec2 four = Vec2::Zero();
    Vec2 six = Vec2::Zero();
    for (const Interface& interface : body.system.interfaces) {
        const Edge& edge = body.system.blocks[interface.block_a].edges[interface.edge_a];
        const Vec2 along = edge_end(body.system, edge) - edge_start(body.system, edge);
        const double angle = std::atan2(along.y(), along.x());
        total += along.norm();
        four += along.norm() * Vec2(std::cos(4 * angle), std::sin(4 * angle));
        six += along.norm() * Vec2(std::cos(6 * angle), std::sin(6 * angle));
    }
    const double scatter = 1.0 / std::sqrt(2.0 * body.system.n_interfaces());
    EXPECT_LT(four.norm() / total, 4.0 * scatter);
    EXPECT_LT(six.norm() / total, 4.0 * scatter);
}

TEST(TriangleNet, FollowsFracturesToTheirEnds) {
    GeometrySpec spec = triangulated(5.0, 10.0, {.spacing = 0.7, .relaxation = 0, .seed = 1, .grading = {}});
    add_trace(spec, {{-1.0, 7.0}, {3.0, 9.0}});            // from outside into the body
    add_trace(spec, {{1.0, 2.0}, {2.0, 5.0}, {4.0, 6.0}}); // isolated, with a bend
    add_trace(spec, {{2.0, 5.0}, {3.0, 2.0}});             // abuts on its bend
    add_trace(spec, {{0.5, 6.0}, {4.5, 5.5}});             // crosses it
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    EXPECT_EQ(body.report.pruned.size(), 0);
    EXPECT_GE(body.report.smallest_angle, smallest_triangle_angle);
    EXPECT_NEAR(cut_scenes::interface_length(body.system, EdgeOrigin::fracture, 0), std::hypot(3.0, 1.5), 1e-12);
    EXPECT_NEAR(cut_scenes::interface_length(body.system, EdgeOrigin::fracture, 1),
                std::hypot(1.0, 3.0) + std::hypot(2.0, 1.0), 1e-12);
    EXPECT_NEAR(cut_scenes::interface_length(body.system, EdgeOrigin::fracture, 2), std::hypot(1.0, 3.0), 1e-12);
    EXPECT_NEAR(cut_scenes::interface_length(body.system, EdgeOrigin::fracture, 3), std::hypot(4.0, 0.5), 1e-12);
}

TEST(TriangleNet, FollowsConstructionLinesWithEdgesOfTheNet) {
    GeometrySpec spec = triangulated(5.0, 5.0, {.spacing = 0.6, .relaxation = 2, .seed = 1, .grading = {}});
    spec.construction_lines = {{{1.0, 1.0}, {4.0, 1.0}, {4.0, 3.0}}};
    const CutBody body = cut_blocks(spec);
    double length = 0.0;
    for (const Interface& interface : body.system.interfaces) {
        EXPECT_EQ(interface.origin, EdgeOrigin::tessellation);
        const Edge& edge = body.system.blocks[interface.block_a].edges[interface.edge_a];
        const Vec2& a = edge_start(body.system, edge);
        const Vec2& b = edge_end(body.system, edge);
        const auto on = [&](const Vec2& p) {
            return std::min(distance_to_segment(p, {1, 1}, {4, 1}), distance_to_segment(p, {4, 1}, {4, 3})) < 1e-9;
        };
        if (on(a) && on(b) && on(0.5 * (a + b))) length += (b - a).norm();
    }
    EXPECT_NEAR(length, 5.0, 1e-12);
}

TEST(TriangleNet, IsFinerWhereTheGradingSaysSo) {
    TriangleNet net{.spacing = 1.0, .relaxation = 0, .seed = 1, .grading = {}};
    net.grading.region = {{4, 4}, {6, 4}, {6, 6}, {4, 6}};
    net.grading.region_spacing = 0.2;
    net.grading.openings = 0.25;
    GeometrySpec spec = triangulated(10.0, 10.0, net);
    spec.holes = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}};
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    EXPECT_GE(body.report.smallest_angle, smallest_triangle_angle);
    double inside = 0.0;
    int n_inside = 0;
    for (const Block& block : body.system.blocks) {
        if ((block.centroid - Vec2(5, 5)).cwiseAbs().maxCoeff() > 1.0) continue;
        inside += block.area;
        ++n_inside;
    }
    EXPECT_NEAR(inside / n_inside, triangle_area(0.2), 0.1 * triangle_area(0.2));
    for (const Interface& interface : body.system.interfaces) {
        const Edge& edge = body.system.blocks[interface.block_a].edges[interface.edge_a];
        const Vec2 middle = 0.5 * (edge_start(body.system, edge) + edge_end(body.system, edge));
        if ((middle - Vec2(5, 5)).cwiseAbs().maxCoeff() < 1.0) { // 0.2 lies between two levels
            EXPECT_NEAR(interface.spacing, 0.2, 0.02);
        }
    }
}

Polygon turned(Polygon polygon, double angle, const Vec2& shift) {
    for (Vec2& p : polygon)
        p = Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y()) +
            shift;
    return polygon;
}

/// Points on sides that do not run along an axis lie beside them by the last digits, inside or outside.
TEST(TriangleNet, FillsBodiesThatLieInAnyDirection) {
    for (int i = 0; i < 24; ++i) {
        const double angle = 0.13 + i * std::numbers::pi / 12.0;
        const Vec2 shift(1000.0 * i, -300.0 * i);
        GeometrySpec spec = triangulated(5.0, 10.0, {.spacing = 0.7, .relaxation = i % 2, .seed = 1, .grading = {}});
        spec.domain = turned(spec.domain, angle, shift);
        spec.holes = {turned({{1, 1}, {3, 1}, {3, 2.5}, {1, 2}}, angle, shift),
                      turned({{2, 6}, {4, 6}, {3, 8}}, angle, shift)};
        add_trace(spec, turned({{-1, 4}, {6, 5}}, angle, shift));
        const CutBody body = cut_blocks(spec);
        const double area = 50.0 - 2.5 - 2.0;
        EXPECT_EQ(faults(spec, body), "") << i;
        EXPECT_GE(body.report.smallest_angle, smallest_triangle_angle) << i;
        EXPECT_NEAR(body.system.n_blocks(), area / triangle_area(0.7), 0.05 * area / triangle_area(0.7)) << i;
    }
}

TEST(TriangleNet, StaysInItsRegion) {
    GeometrySpec spec = triangulated(5.0, 5.0, {.spacing = 0.5, .relaxation = 0, .seed = 1, .grading = {}});
    spec.tessellation->region = {{1, 1}, {4, 1}, {4, 4}, {1, 4}};
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    int others = 0;
    for (const Block& block : body.system.blocks) others += block.edges.size() != 3 ? 1 : 0;
    EXPECT_EQ(others, 1);
    EXPECT_NEAR(body.system.n_blocks() - 1, 9.0 / triangle_area(0.5), 3.0);
}

/// Bodies cut by random fractures, near parallels and nearly common points among them: whatever the lines enclose, the
/// body is a subdivision of the domain without loose ends.
TEST(TriangleNet, StandsRandomFractures) {
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        Uniform uniform(seed);
        GeometrySpec spec = triangulated(
            4.0, 6.0, {.spacing = 0.6, .relaxation = static_cast<int>(seed % 3), .seed = seed, .grading = {}});
        add_random_traces(spec, 6, 4.0, 6.0, uniform);
        const Vec2 a(uniform(0.5, 3.5), uniform(0.5, 5.5));
        for (int i = 0; i < 4; ++i)
            add_trace(spec, {a + 1e-3 * Vec2(uniform(), uniform()), a + Vec2(uniform(-1.0, 1.0), uniform(-1.0, 1.0))});
        const CutBody body = cut_blocks(spec);
        EXPECT_EQ(faults(spec, body), "") << "seed " << seed;
    }
}

/// Two fractures 0.014 sides apart: the strip between them is no place for triangles.
TEST(TriangleNet, MergesStripsThatAreNarrowerThanItsResolution) {
    GeometrySpec spec = triangulated(5.0, 10.0, {.spacing = 0.7, .relaxation = 0, .seed = 1, .grading = {}});
    add_trace(spec, {{-1, 3}, {6, 5}});
    add_trace(spec, {{-1, 3.01}, {6, 5.01}});
    const CutBody body = cut_blocks(spec);
    EXPECT_EQ(faults(spec, body), "");
    EXPECT_EQ(body.report.merged.size(), 1U);
    EXPECT_GE(body.report.smallest_angle, smallest_triangle_angle);
    EXPECT_LT(body.system.n_blocks(), 260);
}

double length_of_fractures(const CutBody& body) {
    return cut_scenes::interface_length(body.system, EdgeOrigin::fracture);
}

/// Two traces that end in the body and are nearer to each other than 0.05 sides are one: its length is that of either,
/// but for what the resolution of 0.01 m leaves open at both ends.
TEST(TriangleNet, KeepsOneOfTwoTracesThatEncloseAStripInTheBody) {
    const TriangleNet net{.spacing = 0.2, .relaxation = 0, .seed = 1, .grading = {}};
    for (const double apart : {0.008, 0.005, 0.001, 1e-6, 1e-9, 1e-15}) {
        for (const double rise : {0.0, 0.4, 0.8}) {
            GeometrySpec spec = triangulated(1.0, 2.0, net);
            add_trace(spec, {{0.1, 0.6}, {0.9, 0.6 + rise}});
            add_trace(spec, {{0.1, 0.6 + apart}, {0.9, 0.6 + rise + apart}});
            const CutBody body = cut_blocks(spec);
            EXPECT_EQ(faults(spec, body), "");
            EXPECT_NEAR(length_of_fractures(body), std::hypot(0.8, rise), 0.02) << apart << ' ' << rise;
        }
    }
}

/// Traces in echelon, 5 mm apart, that overlap from 0.3 to 0.7 are one from 0.1 to 0.9; a shorter one beside a long one
/// adds nothing; legs of an L, 8 mm beside another, are those of one.
TEST(TriangleNet, KeepsWhatGoesOnBeyondAMergedStrip) {
    const TriangleNet net{.spacing = 0.2, .relaxation = 0, .seed = 1, .grading = {}};
    GeometrySpec echelon = triangulated(1.0, 2.0, net);
    add_trace(echelon, {{0.1, 1.0}, {0.7, 1.0}});
    add_trace(echelon, {{0.3, 1.005}, {0.9, 1.005}});
    EXPECT_NEAR(length_of_fractures(cut_blocks(echelon)), 0.8, 0.02);
    GeometrySpec beside = triangulated(1.0, 2.0, net);
    add_trace(beside, {{0.1, 1.0}, {0.9, 1.0}});
    add_trace(beside, {{0.3, 1.005}, {0.6, 1.005}});
    EXPECT_NEAR(length_of_fractures(cut_blocks(beside)), 0.8, 0.02);
    GeometrySpec bent = triangulated(1.0, 2.0, net);
    add_trace(bent, {{0.2, 1.5}, {0.2, 0.5}, {0.8, 0.5}});
    add_trace(bent, {{0.208, 1.5}, {0.208, 0.508}, {0.8, 0.508}});
    EXPECT_NEAR(length_of_fractures(cut_blocks(bent)), 1.6, 0.04);
}

/// Copies of a bent trace within 0.008 m of it, less than the resolution of 0.01 m, add nothing to its length and take
/// nothing away, but for some resolutions where they end and cross.
TEST(TriangleNet, NearCopiesOfATraceAreTheTrace) {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Uniform uniform(seed);
        GeometrySpec spec = triangulated(1.0, 2.0, {.spacing = 0.2, .relaxation = 0, .seed = seed, .grading = {}});
        const Vec2 middle(uniform(0.4, 0.6), uniform(0.6, 1.4));
        const double angle = uniform(0.0, 2.0 * std::numbers::pi);
        const double bend = uniform(-1.8, 1.8);
        const auto along = [](double direction) { return Vec2(std::cos(direction), std::sin(direction)); };
        const std::vector<Vec2> trace{middle - 0.3 * along(angle), middle, middle + 0.3 * along(angle + bend)};
        add_trace(spec, trace);
        const int n_copies = 1 + static_cast<int>(seed % 3);
        for (int i = 0; i < n_copies; ++i) {
            std::vector<Vec2> copy = trace;
            for (Vec2& p : copy) p += 0.004 * Vec2(uniform(-1.0, 1.0), uniform(-1.0, 1.0));
            add_trace(spec, copy);
        }
        const CutBody body = cut_blocks(spec);
        EXPECT_EQ(faults(spec, body), "") << seed;
        EXPECT_NEAR(length_of_fractures(body), 0.6, 0.06) << seed;
    }
}

// Two joints that meet at a place of a bed, but for rounding: the whole length of the three is there.
TEST(TriangleNet, FollowsJointsThatMeetOnALine) {
    for (int i = 30; i <= 45; ++i) {
        const double x = 0.1 * i;
        GeometrySpec spec = triangulated(10.0, 10.0, {.spacing = 2.0, .relaxation = 0, .seed = 1, .grading = {}});
        const Vec2 tip(x, 0.6 * x);
        add_trace(spec, {{-1, -0.6}, {11, 6.6}});
        add_trace(spec, {tip, tip + Vec2(-6, 10)});
        add_trace(spec, {tip, tip + Vec2(3, 10)});
        const CutBody body = cut_blocks(spec);
        EXPECT_EQ(faults(spec, body), "") << x;
        const double to_top = 10.0 - tip.y();
        const double to_left = std::min(tip.x() / 0.6, to_top); // steps of (-0.6, 1)
        const double expected =
            10.0 * std::hypot(1.0, 0.6) + to_left * std::hypot(0.6, 1.0) + to_top * std::hypot(0.3, 1.0);
        EXPECT_NEAR(length_of_fractures(body), expected, 0.02 * expected) << x;
    }
}

std::vector<LostFracture> lost_of(GeometrySpec spec, const std::vector<std::vector<Vec2>>& traces) {
    for (const auto& trace : traces) add_trace(spec, trace);
    return cut_blocks(spec).report.lost;
}

/// With a resolution of 0.05 x 0.2 = 0.01 m.
TEST(TriangleNet, SaysWhichFracturesAreNotLeftAndWhy) {
    using Cause = LostFracture::Cause;
    const GeometrySpec spec = triangulated(1.0, 2.0, {.spacing = 0.2, .relaxation = 0, .seed = 1, .grading = {}});
    const std::vector<Vec2> line{{0.1, 1.0}, {0.9, 1.0}};
    EXPECT_TRUE(lost_of(spec, {line, {{5, 5}, {6, 6}}}).empty()); // beyond the domain, of which the reader tells
    const auto twice = lost_of(spec, {line, {{0.9, 1.0}, {0.1, 1.0}}});
    ASSERT_EQ(twice.size(), 1U);
    EXPECT_EQ(twice[0].fracture, 1);
    EXPECT_EQ(twice[0].cause, Cause::coincides);
    EXPECT_EQ(twice[0].other, 0);
    const auto on_outline = lost_of(spec, {{{0, 0.5}, {0, 1.5}}});
    ASSERT_EQ(on_outline.size(), 1U);
    EXPECT_EQ(on_outline[0].cause, Cause::coincides);
    EXPECT_EQ(on_outline[0].other, -1);
    const auto short_one = lost_of(spec, {line, {{0.3, 0.5}, {0.305, 0.5}}});
    ASSERT_EQ(short_one.size(), 1U);
    EXPECT_EQ(short_one[0].fracture, 1);
    EXPECT_EQ(short_one[0].cause, Cause::too_short);
    const auto near = lost_of(spec, {{{0.005, 0.5}, {0.005, 1.5}}, line});
    ASSERT_EQ(near.size(), 1U);
    EXPECT_EQ(near[0].fracture, 0);
    EXPECT_EQ(near[0].cause, Cause::too_near);
    // Legs at 5 degrees to one another are 0.4 sin(5 deg) = 0.035 m apart at their ends: from 0.02/sin(5 deg) = 0.23 m
    // on the second one is missed, which makes 0.17 m.
    const double angle = 5.0 * std::numbers::pi / 180.0;
    const Vec2 end(0.5 + 0.4 * std::cos(angle), 1.0 + 0.4 * std::sin(angle));
    const auto sharp = lost_of(spec, {{{0.92, 1.0}, {0.5, 1.0}}, {end, {0.5, 1.0}, {0.1, 0.6}}});
    ASSERT_EQ(sharp.size(), 1U);
    EXPECT_EQ(sharp[0].fracture, 1);
    EXPECT_EQ(sharp[0].cause, Cause::in_part);
    EXPECT_NEAR(sharp[0].length, 0.17, 0.02);
}

TEST(TriangleNet, SaysWhichPartsOfTheOutlineAreSmallerThanItResolves) {
    GeometrySpec spec = triangulated(1.0, 2.0, {.spacing = 0.2, .relaxation = 0, .seed = 1, .grading = {}});
    EXPECT_TRUE(cut_blocks(spec).report.fine_details.empty());
    spec.domain = {{0, 0}, {0.5, 0}, {0.504, 0}, {1, 0}, {1, 2}, {0, 2}};
    spec.boundaries.clear();
    spec.holes = {{{0.3, 1}, {0.306, 1}, {0.306, 1.008}, {0.3, 1.008}}};
    const auto details = cut_blocks(spec).report.fine_details;
    ASSERT_EQ(details.size(), 2U);
    EXPECT_EQ(details[0].hole, -1);
    EXPECT_NEAR(details[0].size, 0.004, 1e-15);
    EXPECT_NEAR((details[0].at - Vec2(0.502, 0)).norm(), 0.0, 1e-15);
    EXPECT_TRUE(details[1].is_whole_hole);
    EXPECT_NEAR(details[1].size, 0.008, 1e-15);
}

/// What a trace does beyond the body costs nothing and moves nothing in it: y = x + 1/2 cuts 1.5^2/2 off a square of 2.
TEST(TriangleNet, FollowsTracesThatEndFarAway) {
    for (const double far : {1e6, 1e9}) {
        GeometrySpec spec = triangulated(2.0, 2.0, {.spacing = 0.5, .relaxation = 0, .seed = 1, .grading = {}});
        spec.tessellation->triangles->grading.fractures = 0.4;
        add_trace(spec, {{-far, -far + 0.5}, {far, far + 0.5}});
        const CutBody body = cut_blocks(spec);
        EXPECT_EQ(faults(spec, body), "");
        EXPECT_NEAR(length_of_fractures(body), 1.5 * std::numbers::sqrt2, 1e-9);
        double above = 0.0;
        for (const Block& block : body.system.blocks)
            above += block.centroid.y() > block.centroid.x() + 0.5 ? block.area : 0.0;
        EXPECT_NEAR(above, 1.125, 1e-9);
    }
}

TEST(TriangleNet, RefusesARegionWithoutBodyAndMoreTrianglesThanItCanMake) {
    GeometrySpec outside = triangulated(5.0, 5.0, {.spacing = 0.5, .grading = {}});
    outside.tessellation->region = {{10, 10}, {20, 10}, {20, 20}};
    EXPECT_THROW((void)cut_blocks(outside), InputError);
    TriangleNet net{.spacing = 0.5, .grading = {}};
    net.grading.region = {{1, 1}, {2, 1}, {2, 2}};
    net.grading.region_spacing = 1e-6;
    EXPECT_THROW((void)cut_blocks(triangulated(5.0, 5.0, net)), InputError);
}

TEST(TriangleNet, CountsTheTrianglesAtItsLinesBeforeItMakesThem) {
    // A fracture of 3 m across the body, sides h on it that grow by 0.3: 3 m times 1/h + 8/(0.3 sqrt(3)) (1/h - 1/0.5).
    GeometrySpec spec = triangulated(3.0, 3.0, {.spacing = 0.5, .grading = {.fractures = 1e-9}});
    spec.fractures.push_back({.points = {{0, 1.6}, {3, 1.6}}, .name = "f"});
    try {
        (void)cut_blocks(spec);
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("at most 2e+06 triangles, found some that make about 4.9e+10"));
    }
}

TEST(TriangleNet, RefusesWhatIsNoNet) {
    const auto refused = [](const TriangleNet& net, const std::string& key) {
        try {
            (void)cut_blocks(triangulated(1.0, 1.0, net));
        } catch (const InputError& error) {
            return std::string(error.what()).find("geometry.tessellation.triangles." + key + ":") == 0;
        }
        return false;
    };
    EXPECT_TRUE(refused({.spacing = 0.0, .grading = {}}, "spacing"));
    EXPECT_TRUE(refused({.spacing = std::nan(""), .grading = {}}, "spacing"));
    EXPECT_TRUE(refused({.spacing = 0.1, .relaxation = 21, .grading = {}}, "relaxation"));
    EXPECT_TRUE(refused({.spacing = 0.1, .grading = {.fractures = -1.0}}, "grading.fractures"));
    EXPECT_TRUE(refused({.spacing = 0.1, .grading = {.growth = 0.0}}, "grading.growth"));
}

// What the fractures of a map leave: pieces that separate nothing.

TEST(FreePieces, AreJoinedWithTheLinesThatTheyAbutOn) {
    // A square whose right part is cut off by a line, with a piece from this line to the left.
    std::vector<SourceSegment> segments{{{0, 0}, {4, 0}, 0}, {{4, 0}, {4, 4}, 0}, {{4, 4}, {0, 4}, 0},
                                        {{0, 4}, {0, 0}, 0}, {{3, 0}, {3, 4}, 1}, {{3, 2}, {1, 2}, 2}};
    PlanarMap map = arrange(segments);
    for (auto& half_edge : map.half_edges) half_edge.face = half_edge.face == 0 ? PlanarMap::outside : half_edge.face;
    const auto pieces = free_pieces(map);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_EQ(pieces[0].source, 2);
    map.remove_edges_inside_faces();
    const int n_vertices = static_cast<int>(map.positions.size());
    const SourceSegment near_parallel{{3.0, 2.0}, {3.2, 3.5}, 2};
    const SourceSegment on_an_edge{{2.0, 1.0}, {2.98, 1.0}, 3}; // which has no vertex there
    const SourceSegment nearly_there{{2.0, 3.0}, {2.99, 3.97}, 4};
    const SourceSegment short_one{{1.0, 2.0}, {1.0, 2.01}, 2};
    const auto joined = joined_pieces(map, {pieces[0], near_parallel, on_an_edge, nearly_there, short_one}, 0.05);
    ASSERT_EQ(joined.size(), 3U); // no triangle fits between the second and the line, nor beside the last
    EXPECT_EQ(joined[0].source, 2);
    EXPECT_EQ(joined[1].source, 4);
    EXPECT_EQ(joined[1].b, Vec2(3, 4));
    EXPECT_EQ(joined[2].source, 3);
    ASSERT_EQ(static_cast<int>(map.positions.size()), n_vertices + 1);
    EXPECT_EQ(map.positions.back(), Vec2(3, 1));
    EXPECT_EQ(map.degree(n_vertices, 4), 2);
    for (const int f : {1, 2}) { // the split edge belongs to both faces still
        double length = 0.0;
        for (const auto& loop : map.loops(f))
            for (const int h : loop) length += map.length(h);
        EXPECT_NEAR(length, map.area(f) == 12.0 ? 14.0 : 10.0, 1e-12);
    }
}

} // namespace
} // namespace kluft

#include "kluft/contact/detection.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "kluft/contact/broad_phase.hpp"
#include "support/lattice_body.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

constexpr double reach = 0.1;

/// A rectangle cut by traces, whose type is their number; all of them are fractures with the friction of `friction`.
struct CutRectangle {
    CutRectangle(double width, double height, const std::vector<std::vector<Vec2>>& traces) {
        GeometrySpec spec = cut_scenes::rectangle(width, height);
        for (const auto& points : traces) cut_scenes::add_trace(spec, points, static_cast<int>(spec.fractures.size()));
        system = cut_blocks(spec).system;
        for (const Interface& interface : system.interfaces) surfaces.law.push_back(interface.interface_type);
        surfaces.bonded.assign(system.interfaces.size(), 0);
        surfaces.n_points.assign(system.interfaces.size(), 3);
        surfaces.friction.assign(traces.size(), 0.5);
        q = at_rest(system);
    }
    /// Turns block b by an angle about a point of it, then moves it by u.
    void move(int b, const Vec2& u, double angle = 0.0, const Vec2& pivot = Vec2::Zero()) {
        const Mat2 gradient = rotation_by(angle) - Mat2::Identity();
        set_motion(system, b, u + gradient * (system.blocks[b].centroid - pivot), gradient, q);
    }
    [[nodiscard]] std::vector<ContactPoint> points(const std::vector<ContactMemory>& memory = {}) const {
        return detect_contacts(system, surfaces, q, reach, memory).points;
    }
    [[nodiscard]] double gap(const ContactPoint& point) const { return point.normal.dot(relative_position(point, q)); }
    [[nodiscard]] Vec2 place_on_a(const ContactPoint& point) const {
        const Block& block = system.blocks[point.block_a];
        return block.centroid + block.size * point.xi_a + displacement_at(q, point.block_a, point.xi_a);
    }

    BlockSystem system;
    ContactSurfaces surfaces;
    Eigen::VectorXd q;
};

/// Two blocks of 2 m x 1 m, 0 below 1.
CutRectangle two_blocks() { return {2.0, 2.0, {{{-1, 1}, {3, 1}}}}; }

void expect_points(const CutRectangle& body, const std::vector<Vec2>& places, const std::vector<double>& weights,
                   const std::vector<double>& gaps, const Vec2& normal) {
    const auto points = body.points();
    ASSERT_EQ(points.size(), places.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_LT((body.place_on_a(points[i]) - places[i]).norm(), 1e-12) << i;
        EXPECT_NEAR(points[i].weight, weights[i], 1e-12) << i;
        EXPECT_NEAR(body.gap(points[i]), gaps[i], 1e-12) << i;
        EXPECT_LT((points[i].normal - normal).norm(), 1e-12) << i;
        EXPECT_LT((points[i].tangent - Vec2(-normal.y(), normal.x())).norm(), 1e-12) << i;
    }
}

// Gauss-Lobatto (Simpson) on the whole edge of 2 m: weights 1/6, 4/6, 1/6 of it at its ends and its middle.
TEST(ContactDetection, ClosedFractureHasThePointsOfSimpsonsRule) {
    const auto body = two_blocks();
    expect_points(body, {{2, 1}, {1, 1}, {0, 1}}, {2.0 / 6, 8.0 / 6, 2.0 / 6}, {0, 0, 0}, {0, 1});
    for (const ContactPoint& point : body.points()) {
        EXPECT_EQ(point.interface, 0);
        EXPECT_EQ(point.offset, Vec2(0.0, 0.0));
    }
}

// Shifted by 0.5 m along and 0.01 m into the lower block: an overlap of 1.5 m with a gap of -0.01 m.
TEST(ContactDetection, ShiftedBlocksTouchOnTheirOverlap) {
    auto body = two_blocks();
    body.move(1, {0.5, -0.01});
    expect_points(body, {{2, 1}, {1.25, 1}, {0.5, 1}}, {0.25, 1.0, 0.25}, {-0.01, -0.01, -0.01}, {0, 1});
}

// Blocks turned as a whole touch at the turned places; lengths and gaps are the same.
TEST(ContactDetection, PointsTurnWithTheBody) {
    auto body = two_blocks();
    body.move(1, {0.5, -0.01});
    const double angle = 2.0;
    const Mat2 rotation = rotation_by(angle);
    body.q = turned(body.system, body.q, rotation);
    expect_points(body, {rotation * Vec2(2, 1), rotation * Vec2(1.25, 1), rotation * Vec2(0.5, 1)}, {0.25, 1.0, 0.25},
                  {-0.01, -0.01, -0.01}, rotation * Vec2(0, 1));
}

// Tilted by theta about the left end of the joint: along the bisector the overlap is 2 cos(theta/2) long, and the far
// ends are 2 * 2 sin(theta/2) apart across it.
TEST(ContactDetection, TiltedBlocksTouchAlongTheBisectorOfTheirEdges) {
    auto body = two_blocks();
    const double theta = 0.1, half = 0.5 * theta;
    body.move(1, {0, 0}, theta, {0, 1});
    const double length = 2 * std::cos(half), far = 4 * std::sin(half);
    expect_points(body, {{2, 1}, {1, 1}, {0, 1}}, {length / 6, 4 * length / 6, length / 6}, {far, far / 2, 0},
                  {-std::sin(half), std::cos(half)});
}

// A wedge of 60 degrees, 1, rolls on a floor, 0, about its tip, which is a vertex of both as they were cut; a third block lies beyond it.
// At 30 degrees its face still faces the floor. At 60 degrees neither of its faces does, and the tip alone keeps it above the floor, into
// which it has sunk by 0.02 m.
TEST(ContactDetection, ATipThatTheFloorHasTooIsKeptAboveItWhereNoFacesFaceEachOther) {
    CutRectangle body(3.0, 2.0, {{{-1, 1}, {4, 1}}, {{2, 1}, Vec2(2, 1) + 3.0 * Vec2(-0.5, std::sqrt(0.75))}});
    ASSERT_EQ(body.system.n_blocks(), 3);
    ASSERT_LT(body.system.blocks[0].centroid.y(), 1.0);
    ASSERT_LT(body.system.blocks[1].centroid.x(), body.system.blocks[2].centroid.x());
    body.move(2, {5, 5});
    body.move(1, {-0.05, -0.02}, -std::numbers::pi / 6.0, {2, 1});
    EXPECT_EQ(body.points().size(), 3);
    body.move(1, {-0.05, -0.02}, -std::numbers::pi / 3.0, {2, 1});
    expect_points(body, {{1.95, 0.98}}, {0.2 * std::min(2.0, body.system.blocks[1].size)}, {-0.02}, {0, -1});
    body.move(1, {-0.05, 0.2}, -std::numbers::pi / 3.0, {2, 1});
    EXPECT_TRUE(body.points().empty());
}

std::vector<ContactMemory> memory_of(const std::vector<ContactPoint>& points) {
    std::vector<ContactMemory> memory;
    for (const ContactPoint& point : points) memory.push_back({point.key, point.history});
    return memory;
}

// Four blocks meet in a point; of the two that are left a wedge of 60 degrees has slid past it onto the floor of the other one, with which it
// had but that point in common. Where it has turned until its face does not face the floor any more, its tip goes on holding what
// the face held; a tip that held nothing there is none (between five blocks in a point it would catch at their sides).
TEST(ContactDetection, ATipGoesOnHoldingWhatItsFaceHeldWhereTheTwoBlocksHadButThatPointInCommon) {
    const Vec2 along(-0.5, std::sqrt(0.75));
    CutRectangle body(3.0, 2.0, {{{-1, 1}, {4, 1}}, {Vec2(2, 1) - 3.0 * along, Vec2(2, 1) + 3.0 * along}});
    ASSERT_EQ(body.system.n_blocks(), 4);
    int wedge = 0;
    for (int b = 0; b < 4; ++b) {
        const Vec2 from_point = body.system.blocks[b].centroid - Vec2(2, 1);
        const bool above = from_point.y() > 0.0;
        const bool left = cross(along, from_point) > 0.0;
        if (above && left) wedge = b;
        if (above != left) body.move(b, {above ? 100.0 : -100.0, 0.0});
    }
    body.move(wedge, {0.05, -0.02});
    const auto overlap = memory_of(body.points());
    ASSERT_EQ(overlap.size(), 3U);
    body.move(wedge, {0.05, -0.02}, -std::numbers::pi / 3.0, {2, 1});
    EXPECT_TRUE(body.points().empty());
    const auto held = body.points(overlap);
    ASSERT_EQ(held.size(), 1U);
    EXPECT_NEAR(body.gap(held[0]), -0.02, 1e-12);
    EXPECT_NEAR(std::abs(held[0].normal.y()), 1.0, 1e-12);
    EXPECT_EQ(body.points(memory_of(held)).size(), 1U);
}

// The left block reaches into the right one with a tip that is 6 to 0 cm thick; 3 to 6 cm of the right block lie between it and the
// floor. Pressed into the rock above it, the tip's upper face has the lower face of the right block behind it, not before it.
TEST(ContactDetection, TheBackOfAThinPartIsNoFaceThatThePartBesideItTouches) {
    CutRectangle body(3.0, 2.0, {{{-1, 0.94}, {4, 0.94}}, {{1, 3}, {1, 1.03}, {1.8, 1.0}, {1, 0.97}, {1, 0.5}}});
    ASSERT_EQ(body.system.n_blocks(), 3);
    const int left = body.system.blocks[1].centroid.x() < 1.0 ? 1 : 2;
    for (const double pressed : {0.0, 1e-4, -1e-4}) {
        body.move(left, {0.0, pressed});
        const auto points = body.points();
        EXPECT_GE(points.size(), 12U);
        for (const ContactPoint& point : points) EXPECT_GE(body.gap(point), -1.01e-4);
    }
}

TEST(ContactDetection, PointsAreKeptUpToTheReachAndNoFurther) {
    auto body = two_blocks();
    body.move(1, {0, 0.999 * reach});
    EXPECT_EQ(body.points().size(), 3U);
    body.move(1, {0, 1.001 * reach});
    EXPECT_TRUE(body.points().empty());
    body.move(1, {2.0 + 1.001 * reach, -0.01}); // past its end
    EXPECT_TRUE(body.points().empty());
}

/// Block 0 below, a wedge (2) with its tip at (1.5, 1.2) and, between them, a block (1) that is taken away.
CutRectangle wedge_above_floor(const Vec2& u) {
    CutRectangle body(3.0, 2.0, {{{-1, 1}, {4, 1}}, {{0.9, 2.1}, {1.5, 1.2}, {2.1, 2.1}}});
    body.move(1, {100.0, 0.0});
    body.move(2, u);
    return body;
}

// The tip at (1.7, 0.99) against the floor at y = 1, with the normal from the wedge into the floor. Its sides rise by 56
// degrees, so they do not face the floor.
TEST(ContactDetection, TipOfAWedgeTouchesTheFloorAsOneVertex) {
    const auto body = wedge_above_floor({0.2, -0.21});
    ASSERT_EQ(body.system.n_blocks(), 3);
    const auto points = body.points();
    ASSERT_EQ(points.size(), 1U);
    const ContactPoint& tip = points.front();
    EXPECT_EQ(tip.block_a, 2);
    EXPECT_EQ(tip.block_b, 0);
    EXPECT_EQ(tip.key.point, -1);
    EXPECT_LT((body.place_on_a(tip) - Vec2(1.7, 0.99)).norm(), 1e-12);
    EXPECT_NEAR(body.gap(tip), -0.01, 1e-12);
    EXPECT_LT((tip.normal - Vec2(0, -1)).norm(), 1e-12);
    EXPECT_LT((tip.tangent - Vec2(1, 0)).norm(), 1e-12);
    EXPECT_NEAR(tip.weight, 0.2 * body.system.blocks[2].size, 1e-12); // theory, section 4; the floor's edge is longer
    EXPECT_EQ(tip.interface, -1);
}

TEST(ContactDetection, TipOfAWedgeIsSeenWithinTheReachAndAboveTheFloorOnly) {
    EXPECT_EQ(wedge_above_floor({0.2, -0.2 + 0.999 * reach}).points().size(), 1U);
    EXPECT_TRUE(wedge_above_floor({0.2, -0.2 + 1.001 * reach}).points().empty());
    EXPECT_TRUE(wedge_above_floor({1.8, -0.21}).points().empty()); // beside the floor, which ends at x = 3
}

// Two blocks on a floor with a joint between them slide along it: one comes to rest on the part of the floor that the
// other has left. All of the overlap carries: 1 m of the left block, 0.7 m of the right one.
TEST(ContactDetection, BlockThatSlidesPastAJointOfTheFloorRestsOnAllOfIt) {
    CutRectangle body(2.0, 2.0, {{{-1, 1}, {3, 1}}, {{1, 1}, {1, 3}}});
    ASSERT_EQ(body.system.n_blocks(), 3);
    body.move(1, {0.3, -0.001});
    body.move(2, {0.3, -0.001});
    double left = 0.0, right = 0.0;
    for (const ContactPoint& point : body.points()) {
        if (point.block_a == 0 && point.block_b == 1) left += point.weight;
        if (point.block_a == 0 && point.block_b == 2) right += point.weight;
    }
    EXPECT_NEAR(left, 1.0, 1e-9);
    EXPECT_NEAR(right, 0.7, 1e-9);
}

// A floor that rises by 10 degrees beyond its joint: the block that slides 0.1 m past it meets the rise. Along the
// bisector the overlap there is 0.1 cos(5) long, and the block's corner lies 0.1 sin(10) behind the rise.
TEST(ContactDetection, BlockThatSlidesAgainstARisingFloorMeetsIt) {
    const double rise = std::tan(10 * std::numbers::pi / 180);
    CutRectangle body(2.0, 2.0, {{{-1, 1}, {1, 1}, {3, 1 + 2 * rise}}, {{1, 1}, {1, 3}}});
    ASSERT_EQ(body.system.n_blocks(), 3);
    body.move(2, {0.0, 100.0});
    body.move(1, {0.1, 0.0});
    double deepest = 0.0, length = 0.0;
    for (const ContactPoint& point : body.points()) {
        deepest = std::min(deepest, body.gap(point));
        length += point.weight;
    }
    const double half = 5 * std::numbers::pi / 180;
    EXPECT_NEAR(deepest, -0.1 * std::sin(2 * half), 1e-12);
    EXPECT_NEAR(length, 0.9 + 0.1 * std::cos(half), 1e-12);
}

// Where hexagons meet at rest, only the two sides of each interface touch: three points each, no corners.
TEST(ContactDetection, NetAtRestHasThePointsOfItsInterfacesOnly) {
    const BlockSystem system = cut_blocks(hexagon_spec(0.7, 0.6, 0.1, {0.03, 0.04})).system;
    const std::vector<InterfaceLaw> laws(1);
    const auto points =
        detect_contacts(system, surfaces_of(system, {0}, laws), at_rest(system), 0.1 * system.spacing, {}).points;
    EXPECT_EQ(points.size(), 3 * system.interfaces.size());
    for (const ContactPoint& point : points) {
        EXPECT_GE(point.interface, 0);
        EXPECT_EQ(point.offset, Vec2(0.0, 0.0));
    }
}

// The top of one and the bottom of the next but one face away from each other, 1 to 2 cm apart.
TEST(ContactDetection, ThinSlabsTouchTheirNeighboursOnly) {
    std::vector<std::vector<Vec2>> traces;
    for (int i = 1; i < 5; ++i) traces.push_back({{-1.0, 0.01 * i}, {2.0, 0.01 * i}});
    CutRectangle slabs(1.0, 0.05, traces);
    for (const Vec2& u : {Vec2(0.0, 0.0), Vec2(0.0, -1e-5), Vec2(0.02, -2e-3)}) {
        slabs.q = at_rest(slabs.system);
        for (int b = 0; b < 5; ++b) slabs.move(b, b * u); // bottom to top
        for (const ContactPoint& point : slabs.points()) {
            if (slabs.gap(point) > 0.0) continue; // across a slab, within the reach
            EXPECT_EQ(point.block_b - point.block_a, 1) << u.transpose();
            EXPECT_NEAR(slabs.gap(point), u.y(), 1e-12);
        }
    }
}

// ---- bonds ---------------------------------------------------------------------------------------------------------

TEST(ContactDetection, BondedPairsAreNotSearched) {
    auto body = two_blocks();
    body.surfaces.bonded = {1};
    body.move(1, {0.5, -0.01});
    const auto detected = detect_contacts(body.system, body.surfaces, body.q, reach, {});
    EXPECT_TRUE(detected.points.empty());
    EXPECT_TRUE(detected.near_pairs.empty());
}

// Of three interfaces between the same two blocks one is still bonded: the others touch each with its own other side, not
// with that of its neighbour, over whose corner it has come.
TEST(ContactDetection, BondedPairTouchesOnItsOwnBrokenInterfacesOnly) {
    CutRectangle body(3.0, 2.0, {{{-1, 1}, {1, 1.1}, {2, 1.1}, {4, 0.9}}});
    ASSERT_EQ(body.system.n_interfaces(), 3);
    body.move(1, {0.3, -0.02});
    const auto others = [&] {
        const auto points = body.points();
        return std::ranges::count(points, -1, &ContactPoint::interface);
    };
    EXPECT_GT(others(), 0);
    body.surfaces.bonded = {0, 0, 1};
    EXPECT_EQ(others(), 0);
    EXPECT_EQ(body.points().size(), 6U);
}

// ---- histories -----------------------------------------------------------------------------------------------------

TEST(ContactDetection, PointsThatPersistKeepTheirHistoryAndOthersStartAnew) {
    auto body = two_blocks();
    std::vector<ContactMemory> memory;
    for (const ContactPoint& point : body.points()) {
        memory.push_back({point.key, {1e5 * (1 + point.key.point), 1e-3 * point.key.point}});
    }
    memory.erase(memory.begin() + 1);
    body.move(1, {0.4, -0.01}, 0.01, {0, 1});
    const auto points = body.points(memory);
    ASSERT_EQ(points.size(), 3U);
    EXPECT_EQ(points[0].history.shear_trial, 1e5);
    EXPECT_EQ(points[1].history.shear_trial, 0.0);
    EXPECT_EQ(points[1].history.dilation, 0.0);
    EXPECT_EQ(points[2].history.shear_trial, 3e5);
    EXPECT_EQ(points[2].history.dilation, 2e-3);
}

// Slip counts from where the history was kept: it is zero at detection, however far the blocks have moved.
TEST(ContactDetection, SlipStartsFromTheStateOfDetection) {
    auto body = two_blocks();
    body.move(1, {0.4, -0.01}, 0.02, {0, 1});
    for (const ContactPoint& point : body.points()) {
        EXPECT_EQ(point.tangent.dot(relative_position(point, body.q)) - point.slip_start, 0.0);
    }
}

TEST(ContactDetection, PointsAndPairsAreSorted) {
    GeometrySpec spec = hexagon_spec(0.7, 0.6, 0.1);
    const BlockSystem system = cut_blocks(spec).system;
    const std::vector<InterfaceLaw> laws(1);
    Uniform uniform(8);
    const auto q = random_motion(system, 0.01, uniform);
    const auto detected = detect_contacts(system, surfaces_of(system, {0}, laws), q, 0.01, {});
    EXPECT_TRUE(std::ranges::is_sorted(detected.points, {}, &ContactPoint::key));
    EXPECT_EQ(std::ranges::adjacent_find(detected.points, {}, &ContactPoint::key), detected.points.end());
    EXPECT_TRUE(std::ranges::is_sorted(detected.near_pairs));
    for (const ContactPoint& point : detected.points) {
        const std::pair pair(std::min(point.block_a, point.block_b), std::max(point.block_a, point.block_b));
        EXPECT_TRUE(std::ranges::binary_search(detected.near_pairs, pair));
    }
}

// ---- laws ----------------------------------------------------------------------------------------------------------

// Left, middle and right block with a joint of type 0 and one of type 1; the middle is taken away and the right one put
// in its place or on the other side.
TEST(ContactDetection, SurfacesThatWereNoNeighboursTakeTheLawWithTheSmallerFriction) {
    CutRectangle body(3.0, 1.0, {{{1, -1}, {1, 2}}, {{2, -1}, {2, 2}}});
    body.surfaces.default_law = 7;
    body.move(1, {0.0, 100.0});
    body.move(2, {-1.0, 0.0});
    const auto law = [&] {
        const auto points = body.points();
        EXPECT_EQ(points.size(), 3U);
        EXPECT_EQ(points.front().interface, -1);
        return points.front().law;
    };
    body.surfaces.friction = {0.3, 0.7};
    EXPECT_EQ(law(), 0);
    body.surfaces.friction = {0.7, 0.3};
    EXPECT_EQ(law(), 1);
    body.move(2, {-3.0, 0.0}); // the right outline against the left one
    EXPECT_EQ(law(), 7);
}

// ---- brute force ---------------------------------------------------------------------------------------------------

// All pairs, without a grid.
TEST(BroadPhase, FindsThePairsThatAllPairsOfRandomBoxesHave) {
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
        Uniform uniform(seed);
        std::vector<BlockBox> boxes;
        for (int i = 0; i < 120; ++i) {
            const Vec2 lower(uniform(-5, 5), uniform(-2, 2));
            const double largest = i % 10 == 0 ? 3.0 : 0.4; // a few that span many cells
            boxes.push_back({2 * i + 1, lower, lower + Vec2(uniform(0, largest), uniform(0, largest))});
        }
        const double grown = 0.05;
        std::vector<std::pair<int, int>> expected;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            for (std::size_t j = i + 1; j < boxes.size(); ++j) {
                bool apart = false;
                for (int k = 0; k < 2; ++k) {
                    apart = apart || boxes[i].lower[k] - grown > boxes[j].upper[k] + grown ||
                            boxes[j].lower[k] - grown > boxes[i].upper[k] + grown;
                }
                if (!apart) expected.emplace_back(boxes[i].block, boxes[j].block);
            }
        }
        EXPECT_GT(expected.size(), 100U);
        EXPECT_EQ(meeting_boxes(boxes, grown), expected) << seed;
    }
}

TEST(BroadPhase, OfNoBoxesHasNoPairs) { EXPECT_TRUE(meeting_boxes({}, 0.1).empty()); }

using EdgePair = std::tuple<int, int, int, int>;

/// How often the outline of a block turns around x, by the angles under which its edges are seen.
double turns_around(const BlockSystem& system, const Eigen::VectorXd& q, int block, const Vec2& x) {
    double angle = 0.0;
    for (const Edge& edge : system.blocks[block].edges) {
        const Vec2 from = current_position(system, q, block, edge.start) - x;
        const Vec2 to = current_position(system, q, block, edge.end) - x;
        angle += std::atan2(cross(from, to), from.dot(to));
    }
    return angle / (2.0 * std::numbers::pi);
}

/// Overlap of each pair of facing edges of different blocks, along the bisector; from positions, without a broad phase.
std::map<EdgePair, double> overlaps_of_all_pairs(const BlockSystem& system, const Eigen::VectorXd& q,
                                                 double largest_gap) {
    std::map<EdgePair, double> overlaps;
    for (int a = 0; a < system.n_blocks(); ++a) {
        for (int b = a + 1; b < system.n_blocks(); ++b) {
            for (std::size_t e = 0; e < system.blocks[a].edges.size(); ++e) {
                for (std::size_t f = 0; f < system.blocks[b].edges.size(); ++f) {
                    const Edge& edge_a = system.blocks[a].edges[e];
                    const Edge& edge_b = system.blocks[b].edges[f];
                    const Vec2 p = current_position(system, q, a, edge_a.start);
                    const Vec2 r = current_position(system, q, a, edge_a.end);
                    const Vec2 s = current_position(system, q, b, edge_b.end); // along a's direction
                    const Vec2 t = current_position(system, q, b, edge_b.start);
                    const Vec2 u = (r - p).normalized(), v = (t - s).normalized();
                    if (std::atan2(std::abs(cross(u, v)), u.dot(v)) > std::numbers::pi / 4) continue;
                    const bool wedge_between = edge_a.start == edge_b.end || edge_a.end == edge_b.start;
                    if (wedge_between && edge_a.interface != edge_b.interface) continue;
                    const Vec2 along = (u + v).normalized();
                    const double low = std::max(along.dot(p), along.dot(s));
                    const double high = std::min(along.dot(r), along.dot(t));
                    if (high <= low) continue;
                    const auto across = [&](double at, const Vec2& from, const Vec2& direction) {
                        const Vec2 on = from + direction * (at - along.dot(from)) / along.dot(direction);
                        return on.dot(right_normal(along));
                    };
                    const double gap =
                        std::min(across(low, s, v) - across(low, p, u), across(high, s, v) - across(high, p, u));
                    const bool own = edge_a.interface >= 0 && edge_a.interface == edge_b.interface;
                    const double smaller = std::min(system.blocks[a].size, system.blocks[b].size);
                    const double smaller_area = std::min(system.blocks[a].area, system.blocks[b].area);
                    const bool fragment = smaller_area < 0.25 * std::sqrt(0.75) * system.spacing * system.spacing;
                    if (gap > largest_gap || gap < -(own && !fragment ? 1.0 : 0.25) * smaller) continue;
                    if (!own && -gap > high - low) continue; // deeper than it is long: a corner beside a face
                    const bool deeper_at_low =
                        across(low, s, v) - across(low, p, u) < across(high, s, v) - across(high, p, u);
                    const double at = low + (deeper_at_low ? 0.25 : 0.75) * (high - low);
                    const Vec2 on_a = p + u * (at - along.dot(p)) / along.dot(u);
                    const Vec2 on_b = s + v * (at - along.dot(s)) / along.dot(v);
                    const bool deep = across(at, s, v) - across(at, p, u) < (own ? -0.01 : -1e-9) * smaller;
                    const auto is_in = [&](int block, const Vec2& x) {
                        return turns_around(system, q, block, x) > 0.5;
                    };
                    const auto is_in_both = [&](double share) {
                        const Vec2 x = on_a + share * (on_b - on_a);
                        return is_in(a, x) && is_in(b, x);
                    };
                    const bool overlap = own ? is_in(a, on_b) || is_in(b, on_a) : is_in_both(0.25) && is_in_both(0.75);
                    if (deep && !overlap) continue;
                    overlaps[{a, static_cast<int>(e), b, static_cast<int>(f)}] = high - low;
                }
            }
        }
    }
    return overlaps;
}

// Blocks 0 | 1 below 2 | 3. Both upper ones slide to the right by 1 mm; the right one of the lower two stands 0.03 mm higher, as
// joints give way by different amounts. What slides onto it is carried by its top, and does not catch at its side.
TEST(ContactDetection, ABlockThatSlidesOntoAHigherOneDoesNotCatchAtItsSide) {
    CutRectangle body(2.0, 2.0, {{{-1, 1}, {3, 1}}, {{1, -1}, {1, 3}}});
    const auto at = [&](double x, double y) {
        for (int b = 0; b < body.system.n_blocks(); ++b)
            if ((body.system.blocks[b].centroid - Vec2(x, y)).norm() < 0.1) return b;
        return -1;
    };
    const int lower_right = at(1.5, 0.5);
    const int upper_left = at(0.5, 1.5);
    body.move(lower_right, {0.0, 3e-5});
    body.move(upper_left, {1e-3, 0.0});
    body.move(at(1.5, 1.5), {1e-3, 0.0});
    double length = 0.0;
    for (const ContactPoint& point : body.points()) {
        if (std::minmax(point.block_a, point.block_b) != std::minmax(lower_right, upper_left)) continue;
        EXPECT_GT(std::abs(point.normal.y()), 0.99) << point.key.point;
        length += point.weight;
    }
    EXPECT_NEAR(length, 1e-3, 1e-9);
}

TEST(ContactDetection, FindsTheOverlapsThatAllPairsOfRandomlyMovedHexagonsHave) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        GeometrySpec spec = hexagon_spec(0.7, 0.6, 0.1, {0.03, 0.04});
        spec.tessellation->hexagons.jitter = 0.1;
        spec.tessellation->hexagons.seed = seed;
        cut_scenes::add_trace(spec, {{-0.1, 0.1}, {0.8, 0.45}});
        const BlockSystem system = cut_blocks(spec).system;
        Uniform uniform(seed);
        const auto q = random_motion(system, 0.02, uniform);
        const std::vector<InterfaceLaw> laws(1);
        std::map<EdgePair, double> found;
        for (const ContactPoint& point : detect_contacts(system, surfaces_of(system, {0}, laws), q, 0.01, {}).points) {
            const ContactKey& key = point.key;
            if (key.point >= 0) found[{key.block_a, key.edge_a, key.block_b, key.edge_b}] += point.weight;
        }
        const auto expected = overlaps_of_all_pairs(system, q, 0.01);
        EXPECT_GT(expected.size(), system.interfaces.size() / 2);
        ASSERT_EQ(found.size(), expected.size());
        for (const auto& [pair, length] : expected) {
            ASSERT_TRUE(found.contains(pair));
            EXPECT_NEAR(found[pair], length, 1e-12);
        }
    }
}

} // namespace
} // namespace kluft

// Given blocks that do not lie on each other flush: corners touch faces along the face, a tip in a notch is held by both of its sides, and
// what begins at one point beside a void meets there.
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/blocks/block_search.hpp"

#include "support/scene_run.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

/// Blocks under gravity that is turned by `dip` (degrees); `stages` after the weight.
std::string blocks_on_a_slope(double dip, double friction_angle, const std::string& blocks, const std::string& stages) {
    const double angle = dip * std::numbers::pi / 180.0;
    return fmt::format(R"(kluft: 1
analysis: {{gravity: [{:.15g}, {:.15g}]}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: {}}}
geometry:
  blocks:
{}
stages: [{}]
)",
                       10.0 * std::sin(angle), -10.0 * std::cos(angle), friction_angle, blocks, stages);
}

const std::string floor_of_rock =
    "    - {name: floor, polygon: [[-6, -2], [9, -2], [9, 0], [-6, 0]], support: fixed}\n";

double factor_of_safety(double dip, double friction_angle, const std::string& blocks) {
    const SceneRun run = run_scene(blocks_on_a_slope(
        dip, friction_angle, blocks, "{name: weight}, {strength_reduction: {from: 1, to: 8}, steps: 20}"));
    EXPECT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
    return run.report.results.factor_of_safety.value_or(0.0);
}

/// A table on two feet whose tips have this angle (degrees), a tenth of a millimetre above the floor.
std::string table_on_tips(double tip) {
    const double h = 1e-4 + 0.25 / std::tan(0.5 * tip * std::numbers::pi / 180.0);
    return fmt::format("    - {{name: table, polygon: [[0, {0:.12g}], [0.25, 1e-4], [0.5, {0:.12g}], [3.5, {0:.12g}], "
                       "[3.75, 1e-4], [4, "
                       "{0:.12g}], [4, {1:.12g}], [0, {1:.12g}]]}}\n",
                       h, h + 0.5);
}

/// A flat block whose lower corners are cut off at an angle (degrees), at a height above the floor.
std::string chamfered_block(double chamfer, double height) {
    const double top = height + 0.3 * std::tan(chamfer * std::numbers::pi / 180.0);
    return fmt::format("    - {{name: block, polygon: [[0, {0:.12g}], [2, {0:.12g}], [2.3, {1:.12g}], [2.3, 1], [-0.3, "
                       "1], [-0.3, {1:.12g}]]}}\n",
                       height, top);
}

// tan(phi)/tan(dip), whatever the shape of what stands on the floor: along the bisectors of its edges and the floor's it was up to
// above 8.
TEST(CornersOnFaces, SlideAlongTheFace) {
    const double expected = std::tan(30 * degree) / std::tan(20 * degree);
    for (const double tip : {160.0, 120.0, 100.0, 80.0})
        EXPECT_NEAR(factor_of_safety(20, 30, floor_of_rock + table_on_tips(tip)), expected, 2e-3 * expected) << tip;
    for (const auto& [chamfer, height] : {std::pair{20.0, 2e-8}, {20.0, 1e-4}, {10.0, 1e-4}, {30.0, 1e-4}, {3.0, 1e-4}})
        EXPECT_NEAR(factor_of_safety(20, 30, floor_of_rock + chamfered_block(chamfer, height)), expected,
                    2e-3 * expected)
            << chamfer << " " << height;
}

// The floor is pressed up to near the block, which is pressed from above: F = tan(phi) (W cos + p b)/(W sin), b = 2.6 m.
TEST(CornersOnFaces, SlideAlongAFaceThatIsPressedBesideThem) {
    for (const double chamfer : {20.0, 30.0}) {
        const double rise = 0.3 * std::tan(chamfer * degree);
        const double weight = 2600.0 * 10.0 * (2.6 * (1.0 - 1e-4) - 0.3 * rise);
        const double expected =
            std::tan(30 * degree) * (weight * std::cos(20 * degree) + 10e3 * 2.6) / (weight * std::sin(20 * degree));
        const SceneRun run = run_scene(blocks_on_a_slope(
            20, 30, floor_of_rock + chamfered_block(chamfer, 1e-4),
            "{name: weight, pressure: {top: 10 kPa}}, {strength_reduction: {from: 1, to: 8}, steps: 20}"));
        EXPECT_NEAR(run.report.results.factor_of_safety.value_or(0.0), expected, 2e-3 * expected) << chamfer;
    }
}

TEST(CornersOnFaces, PolygonsSlideOnTheirSides) {
    const double expected = std::tan(30 * degree) / std::tan(9 * degree);
    for (const int sides : {6, 8, 12}) {
        std::string corners;
        const double radius = 1.0 / std::cos(std::numbers::pi / sides);
        for (int i = 0; i < sides; ++i) {
            const double at = -0.5 * std::numbers::pi + (2 * i + 1) * std::numbers::pi / sides;
            corners += fmt::format("{}[{:.12g}, {:.12g}]", i == 0 ? "" : ", ", radius * std::cos(at),
                                   1.001 + radius * std::sin(at));
        }
        const std::string blocks = fmt::format("{}    - {{name: block, polygon: [{}]}}\n", floor_of_rock, corners);
        EXPECT_NEAR(factor_of_safety(9, 30, blocks), expected, 2e-3 * expected) << sides;
    }
}

// A slab leans on a wall: friction m at both ends, its weight in the middle; it slides where tan(angle) = (1 - m^2)/(2 m) for a thin
// one. This one is 0.2 m thick and 4 m long: forces and moments of its own corners.
TEST(CornersOnFaces, SlabLeansOnAWall) {
    for (const double angle : {60.0, 70.0}) {
        const double c = std::cos(angle * degree), s = std::sin(angle * degree);
        // Foot at (4 c, 0), the back's upper corner at (0, 4 s); the middle is off the line of these by half of the thickness.
        const double foot = 4.0 * c, top = 4.0 * s, middle = 2.0 * c + 0.1 * s;
        // N_w = T_f = m N_f, T_w = m N_w, N_f + T_w = W; moments about the foot: W (foot - middle) = N_w top + T_w foot.
        const auto unbalanced = [&](double m) { return (foot - middle) * (1.0 + m * m) - m * (top + m * foot); };
        double low = 0.0, high = 1.0;
        for (int i = 0; i < 60; ++i) (unbalanced(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
        const double expected = std::tan(30 * degree) / low;
        const std::string blocks =
            "    - {name: base, polygon: [[-1, -1], [6, -1], [6, 0], [0, 0], [0, 6], [-1, 6]], support: fixed}\n" +
            fmt::format("    - {{name: slab, polygon: [[{:.12g}, {:.12g}], [{:.12g}, {:.12g}], [1e-6, {:.12g}], "
                        "[{:.12g}, 1e-6]]}}\n",
                        foot + 0.2 * s, 0.2 * c, 0.2 * s, top + 0.2 * c, top, foot);
        EXPECT_NEAR(factor_of_safety(0, 30, blocks), expected, 5e-3 * expected) << angle;
    }
}

/// How far the block with this name has moved (m).
double motion_of(const SceneRun& run, const std::string& name) {
    const BlockSystem& system = run.model.system;
    for (int b = 0; b < system.n_blocks(); ++b)
        if (block_label(system, b) == "'" + name + "'")
            return run.state.body.displacement.segment<2>(n_block_unknowns * b).norm();
    ADD_FAILURE() << name;
    return 0.0;
}

// Two tips in valleys: below the vertex of a valley lies a place that is beyond the ends of both of its sides, into which a foot sank by half a
// metre, in balance.
TEST(TipsInNotches, AreHeldByBothSides) {
    const std::string valleys = "    - {name: base, polygon: [[-1, -2], [5, -2], [5, 0], [4, 0], [3.25, -0.132245], "
                                "[2.5, 0], [1, 0], [0.25, -0.132245], "
                                "[-0.5, 0], [-1, 0]], support: fixed}\n"
                                "    - {name: table, polygon: [[0, 0.554724], [0.25, -0.132145], [0.5, 0.554724], [3, "
                                "0.554724], [3.25, -0.132145], [3.5, "
                                "0.554724], [3.5, 1.054724], [0, 1.054724]]}\n";
    for (const int steps : {1, 2, 5, 20}) {
        const SceneRun run = run_scene(blocks_on_a_slope(0, 30, valleys, fmt::format("{{steps: {}}}", steps)));
        EXPECT_TRUE(stands(run)) << run.report.diagnosis;
        EXPECT_LT(motion_of(run, "table"), 2e-4) << steps; // what it stood above the valleys, and the joints' closure
    }
}

// An acute front against a riser that stands on the floor, a few micrometres below its foot once it is pressed there.
TEST(TipsInNotches, DoNotSlideThroughARiser) {
    const std::string blocks =
        "    - {name: base, polygon: [[-4, -3], [12, -3], [12, 1], [2.001, 1], [2.001, 0], [-4, 0]], support: fixed}\n"
        "    - {name: slider, polygon: [[0, 0], [2, 0], [0.614359, 0.8], [0, 0.8]]}\n";
    const SceneRun run = run_scene(blocks_on_a_slope(40, 20, blocks, "{steps: 5}"));
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_NEAR(motion_of(run, "slider"), 1e-3, 1e-4);
}

const std::string corner_of_one_block =
    "    - {name: base, polygon: [[-8, -3], [12, -3], [12, 6], [4, 6], [4, 0], [-8, 0]], support: fixed}\n";
const std::string corner_of_two_blocks =
    "    - {name: base, polygon: [[-8, -3], [12, -3], [12, 0], [-8, 0]], support: fixed}\n"
    "    - {name: riser, polygon: [[4, 0], [12, 0], [12, 6], [4, 6]], support: fixed}\n";

// A dam whose toe ends at the foot of a riser, its downstream face at an angle to it. Between the two is a void that begins at one point, and
// nothing was found there: the dam slid into the riser.
TEST(BesideVoids, AToeIsHeldByTheRiserBehindIt) {
    for (const double lean : {5.0, 20.0, 39.0, 51.0, 60.0}) {
        const std::string dam =
            fmt::format("    - {{name: dam, polygon: [[0, 0], [4, 0], [{:.12g}, 1.2], [0, 1.2]]}}\n",
                        4.0 - 1.2 * std::tan(lean * degree));
        const SceneRun one = run_scene(blocks_on_a_slope(40, 20, corner_of_one_block + dam, "{steps: 5}"));
        const SceneRun two = run_scene(blocks_on_a_slope(40, 20, corner_of_two_blocks + dam, "{steps: 5}"));
        EXPECT_TRUE(stands(one)) << lean << one.report.diagnosis;
        EXPECT_TRUE(stands(two)) << lean << two.report.diagnosis;
        EXPECT_LT(motion_of(one, "dam"), 4e-5) << lean; // the joints' closure
        EXPECT_LT(motion_of(two, "dam"), 4e-5) << lean;
        if (lean < 45.0) {
            EXPECT_NEAR(motion_of(two, "dam"), motion_of(one, "dam"), 1e-3 * motion_of(one, "dam")) << lean;
        }
    }
}

// A cube is held by a riser over whose face it leans, touching it or a millimetre before it: with a friction of 10 degrees alone it would slide down the plane of 20 degrees.
TEST(BesideVoids, ARiserHoldsWhatLeansOverIt) {
    for (const double gap : {0.0, 1e-3}) {
        for (const double riser : {61.0, 75.0, 90.0}) {
            const std::string blocks = fmt::format(
                "    - {{name: base, polygon: [[-8, -3], [12, -3], [12, 2], [{0:.12g}, 2], [{1:.12g}, 0], [-8, 0]], "
                "support: fixed}}\n    - {{name: dam, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}}\n",
                4.0 + gap + 2.0 / std::tan(riser * degree), 4.0 + gap);
            const SceneRun run = run_scene(blocks_on_a_slope(20, 10, blocks, "{steps: 5}"));
            EXPECT_TRUE(stands(run)) << riser << " " << gap << run.report.diagnosis;
            EXPECT_LT(motion_of(run, "dam"), gap + 1e-3) << riser;
        }
    }
}

// Two rafters whose feet, with no face on anything, begin in the vertices of notches: rigid ones stand at any friction of limit analysis up to 8.
TEST(BesideVoids, AFootInANotchIsHeld) {
    const std::string blocks = "    - {name: base, support: fixed, polygon: [[-8, -2], [8, -2], [8, 0.25], [5.433013, "
                               "0.25], [5, 0], [4.566987, 0.25], "
                               "[-4.566987, 0.25], [-5, 0], [-5.433013, 0.25], [-8, 0.25]]}\n"
                               "    - {name: left, polygon: [[-5, 0], [0, 4.5], [0, 5.5]]}\n"
                               "    - {name: right, polygon: [[5, 0], [0, 5.5], [0, 4.5]]}\n";
    const SceneRun run =
        run_scene(blocks_on_a_slope(0, 30, blocks, "{name: weight}, {strength_reduction: {from: 1, to: 5}, steps: 5}"));
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_FALSE(run.report.results.factor_of_safety) << "above 5";
}

// A block is pushed up a ramp that begins where it ends: W tan(20 + slope) over its 4 m. Where the ramp did not hold its tip, it went
// through the rock at the friction of the floor alone, 36 kPa.
TEST(BesideVoids, ABlockThatIsPushedGoesUpARampAndNotThroughIt) {
    for (const double slope : {30.0, 44.0, 46.0}) {
        const SceneRun run = run_scene(fmt::format(R"(kluft: 1
analysis: {{gravity: 10}}
materials: {{rock: {{density: 2500, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 20, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}}}
geometry:
  domain: {{polygon: [[-3, -3], [9, -3], [9, {:.12g}], [4, 0], [4, 4], [0, 4], [0, 0], [-3, 0]]}}
  fractures: [{{trace: [[0, 0], [4, 0]], interface: joint}}]
boundaries: {{bottom: {{sides: [0], support: fixed}}, push: {{sides: [5]}}, right: {{sides: [1], support: fixed}}}}
stages: [{{steps: 3}}, {{displacement: {{boundary: push, value: 0.5}}, steps: 5}}]
)",
                                                   5.0 * std::tan(slope * degree)));
        ASSERT_TRUE(stands(run)) << run.report.diagnosis;
        const double expected = 2500.0 * 10.0 * 16.0 * std::tan((20.0 + slope) * degree) / 4.0;
        EXPECT_NEAR(run.history.back().axial_stress, expected, 5e-3 * expected) << slope;
    }
}

// A brick whose corner lies at the foot of a flat slope is held under its weight, and told of; what it has without that corner, tan 30 over
// tan 20 on the plane of 20 degrees, is its factor of safety.
TEST(BesideVoids, ABrickAtTheFootOfASlopeStandsAndHasNoStrengthOfIt) {
    for (const double slope : {25.0, 44.0}) {
        const std::string blocks =
            fmt::format("    - {{name: base, support: fixed, polygon: [[-8, -3], [{0:.12g}, -3], [{0:.12g}, {1:.12g}], "
                        "[4, 0], [-8, "
                        "0]]}}\n    - {{name: brick, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}}\n",
                        4.0 + 6.0 * std::cos(slope * degree), 6.0 * std::sin(slope * degree));
        EXPECT_TRUE(stands(run_scene(blocks_on_a_slope(20, 15, blocks, "{steps: 5}")))) << slope;
        const SceneRun reduced = run_scene(
            blocks_on_a_slope(20, 30, blocks, "{steps: 5}, {strength_reduction: {from: 1, to: 5}, steps: 20}"));
        ASSERT_TRUE(reduced.report.results.factor_of_safety) << reduced.report.diagnosis;
        const double expected = std::tan(30.0 * degree) / std::tan(20.0 * degree);
        EXPECT_NEAR(*reduced.report.results.factor_of_safety, expected, 2e-3 * expected);
        EXPECT_THAT(reduced.report.warnings, testing::Contains(testing::HasSubstr("the tip of block 'brick' at")));
    }
}

// A block on its tip in the corner of floor and wall, and on a post. Its sides are more than 45 degrees from both.
TEST(BesideVoids, ATipIsHeldInTheCornerWhereItBegins) {
    const std::string blocks = "    - {name: spike, polygon: [[4, 0], [3, 1.73205], [2.26795, 1]]}\n"
                               "    - {name: post, polygon: [[2, 0.01], [2.78756, 0.01], [2.78756, 0.69999], [2, "
                               "0.69999]], support: fixed}\n";
    for (const double friction_angle : {5.0, 20.0, 35.0}) {
        for (const std::string& corner : {corner_of_one_block, corner_of_two_blocks}) {
            const SceneRun run = run_scene(blocks_on_a_slope(0, friction_angle, corner + blocks, "{steps: 4}"));
            EXPECT_TRUE(stands(run)) << friction_angle << run.report.diagnosis;
            EXPECT_LT(motion_of(run, "spike"), 1e-4) << friction_angle;
        }
    }
}

// Two halves of a beam between abutments touch along 2 cm at their feet; above lies a slot, a wedge or a gap, that closes as they sag.
TEST(BesideVoids, ASlotAboveAHingeCloses) {
    for (const double half_width : {2e-4, 1e-3, 5e-3}) {
        for (const int steps : {1, 2, 3, 4, 10}) {
            const std::string blocks =
                fmt::format("    - {{name: left, polygon: [[0, 0], [2, 0], [2, 0.02], [{:.12g}, 1], [0, 1]]}}\n"
                            "    - {{name: right, polygon: [[2, 0], [4, 0], [4, 1], [{:.12g}, 1], [2, 0.02]]}}\n",
                            2.0 - half_width, 2.0 + half_width) +
                "    - {name: abutment, polygon: [[-1, -1], [0, -1], [0, 1], [-1, 1]], support: fixed}\n"
                "    - {name: other_abutment, polygon: [[4, -1], [5, -1], [5, 1], [4, 1]], support: fixed}\n";
            const SceneRun run = run_scene(blocks_on_a_slope(0, 60, blocks, fmt::format("{{steps: {}}}", steps)));
            EXPECT_TRUE(stands(run)) << half_width << " " << steps << run.report.diagnosis;
        }
    }
}

// A dam on a joint that a net of triangles meets in vertices: where one of them had slid off its own face, its edge was an overlap a tenth of a
// millimetre long, or a corner, by turns, 2 um apart. The dam stands: friction alone, tan 45, holds as much as its weight of 94 MN/m, and the water
// pushes with 49, a third of the way up.
TEST(SlowDamOnTriangles, StandsWhereVerticesOfTheNetHaveSlidOffTheirFaces) {
    const SceneRun run = run_scene(R"(kluft: 1
analysis: {gravity: 9.81}
materials:
  concrete: {density: 2400 kg/m3, youngs_modulus: 25 GPa, poissons_ratio: 0.2, cohesion: 3 MPa, friction_angle: 50 deg, tensile_strength: 2 MPa}
  rock: {density: 2700 kg/m3, youngs_modulus: 15 GPa, poissons_ratio: 0.25, cohesion: 5 MPa, friction_angle: 45 deg, tensile_strength: 3 MPa}
interfaces:
  contact: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 45 deg, cohesion: 0.5 MPa}
  bond: {kind: potential_crack, fails_to: crack}
  crack: {kind: fracture, friction_angle: 35 deg}
geometry:
  domain: {polygon: [[-100, -100], [200, -100], [200, 0], [80, 0], [0, 100], [0, 0], [-100, 0]]}
  material: rock
  regions:
    - {polygon: [[0, 0], [80, 0], [0, 100]], material: concrete}
  fractures:
    - {name: contact, trace: [[0, 0], [80, 0]], interface: contact}
  tessellation: {triangles: {spacing: 12}, interface: bond}
boundaries:
  bottom: {sides: [0], support: fixed}
  right: {sides: [1], support: smooth}
  left: {sides: [6], support: smooth}
stages:
  - {name: weight}
  - {name: water, forces: {water: {point: [0.5, 33.333333333333336], force: [49050000.0, 0]}}, steps: 10}
)");
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
}

} // namespace
} // namespace kluft

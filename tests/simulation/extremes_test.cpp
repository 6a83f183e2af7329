// What must not go wrong in silence at the ends of the ranges: blocks that would pass through each other, platens against
// supports, given blocks with gaps, slender and small blocks, tiny strains. Expected values are closed forms.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/constitutive/block_elasticity.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/contact/detection.hpp"
#include "kluft/core/diagnostics.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using testing::HasSubstr;

constexpr const char* materials_and_joint = R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0}}
interfaces: {joint: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 30,
                     contact_rounding: 0, friction_rounding: 0}}
solver: {tolerance: 1e-10, balance: 1e-9}
)";

/// Three blocks on top of each other, 0.5, `slab` and 0.5 m high, pressed to a strain between platens.
std::string column(double width, double slab, double strain, int steps = 1) {
    const double top = 1.0 + slab;
    const auto block = [&](double low, double high) {
        return fmt::format("    - {{polygon: [[0, {1}], [{0}, {1}], [{0}, {2}], [0, {2}]]}}\n", width, low, high);
    };
    return std::string(materials_and_joint) + "geometry:\n  blocks:\n" + block(0.0, 0.5) + block(0.5, 0.5 + slab) +
           block(0.5 + slab, top) + "boundaries: {bottom: {support: pinned}}\n" +
           fmt::format("stages: [{{displacement: {{boundary: top, value: {}}}, steps: {}}}]\n", strain * top, steps);
}

/// 1/E_m = 1/E + 2/(k_n H): two joints in series with the blocks.
double column_modulus(double height) { return 1.0 / (1.0 / 10e9 + 2.0 / (10e9 * height)); }

double last_modulus(const SceneRun& run) { return run.history.back().axial_stress / run.history.back().axial_strain; }

// Linear in the strain, since nu = 0 keeps the width: P = E (F - 1), and closures do not turn.
TEST(Extremes, ColumnKeepsItsModulusUntilTheFacesOfItsJointsHaveAlmostLeftABlock) {
    for (const double strain : {1e-9, 1e-3, 0.3}) {
        const SceneRun run = run_scene(column(1.0, 1.0, strain, 4));
        ASSERT_EQ(run.report.status, RunStatus::done) << strain;
        EXPECT_NEAR(last_modulus(run), column_modulus(2.0), 1e-6 * column_modulus(2.0)) << strain;
    }
    // A joint closes by E_m H strain/(k_n H) = 0.5 strain m, 0.75 of the 0.5 (1 - 0.5 strain) m of the outer blocks: 6/11.
    for (const double strain : {0.7, 1.0, 2.0}) {
        const SceneRun run = run_scene(column(1.0, 1.0, strain, 10));
        EXPECT_EQ(run.report.status, RunStatus::no_equilibrium) << strain;
        EXPECT_LE(run.history.back().axial_strain, 6.0 / 11.0 + 1e-9) << strain;
        EXPECT_NEAR(last_modulus(run), column_modulus(2.0), 1e-6 * column_modulus(2.0)) << strain;
        EXPECT_THAT(run.report.diagnosis, testing::AnyOf(HasSubstr("overlap"), HasSubstr("inside out"))) << strain;
    }
}

TEST(Extremes, JointsOfANarrowColumnAreNoContactsOfItsSides) {
    for (const double width : {1e-2, 1e-4, 1e-5, 1e-6}) {
        const SceneRun run = run_scene(column(width, 1.0, 1e-6));
        ASSERT_EQ(run.report.status, RunStatus::done) << width;
        EXPECT_NEAR(last_modulus(run), column_modulus(2.0), 1e-6 * column_modulus(2.0)) << width;
        EXPECT_EQ(run.history.back().locked, 2) << width;
    }
}

TEST(Extremes, ThinSlabIsAsStiffAsItsThickness) {
    for (const double slab : {1e-1, 1e-3, 1e-5}) {
        const SceneRun run = run_scene(column(1.0, slab, 1e-6 * slab));
        ASSERT_EQ(run.report.status, RunStatus::done) << slab;
        EXPECT_NEAR(last_modulus(run), column_modulus(1.0 + slab), 1e-6 * column_modulus(1.0 + slab)) << slab;
    }
}

TEST(Extremes, ThicknessIsTheSmallerSideOfARectangleInAnyPosition) {
    for (const double angle : {0.0, 0.4, 1.2}) {
        Block block;
        block.area = 0.02 * 3.0;
        Mat2 turn;
        turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
        const Eigen::Vector2d moments(3.0 * 3.0 / 12.0, 0.02 * 0.02 / 12.0); // per area
        block.second_moment = block.area * turn * moments.asDiagonal() * turn.transpose();
        EXPECT_NEAR(thickness(block), 0.02, 1e-12) << angle;
    }
}

/// A block above a fixed one.
std::string hovering(double gap, const std::string& more = {}) {
    return std::string(materials_and_joint) + fmt::format(R"(
geometry:
  blocks:
    - {{name: base, polygon: [[0, -1], [1, -1], [1, 0], [0, 0]], support: fixed}}
    - {{name: free, polygon: [[0, {0}], [1, {0}], [1, {1}], [0, {1}]]}}
stages: [{{name: fall, gravity: 10}}]
{2})",
                                                          gap, 1.0 + gap, more);
}

// The middle of the block sinks by the gap, the closure W/(k_n L) and half of its shortening W H/(2 E L).
TEST(Extremes, BlockFallsThroughAGapOntoTheBlockBelow) {
    const double weight = 2500.0 * 10.0;
    for (const double gap : {1e-6, 1e-3}) {
        const SceneRun run = run_scene(hovering(gap));
        ASSERT_EQ(run.report.status, RunStatus::done) << gap;
        EXPECT_TRUE(run.history.back().balanced) << gap;
        const double sunk = -run.state.body.displacement[n_block_unknowns + 1];
        EXPECT_NEAR(sunk, gap + weight / 10e9 + 0.25 * weight / 10e9, 1e-6 * (gap + 1.25 * weight / 10e9)) << gap;
    }
}

// A net on a smooth bottom under pressures from the sides, which nothing else holds along the bottom: it stands with weights that are
// little beside the pressures as it does without.
TEST(Extremes, BodyWithWeightThatIsFreeToDriftStands) {
    const auto run_with = [](double gravity) {
        return run_scene(fmt::format(R"(
kluft: 1
analysis: {{gravity: {}}}
materials: {{rock: {{density: 2300, youngs_modulus: 5 GPa, poissons_ratio: 0.25, cohesion: 5 MPa, friction_angle: 40 deg,
             tensile_strength: 2 MPa}}}}
interfaces:
  bond: {{kind: potential_crack, fails_to: crack}}
  crack: {{kind: fracture, friction_angle: 35 deg}}
geometry:
  domain: {{rectangle: {{width: 20 cm, height: 40 cm}}}}
  tessellation: {{triangles: {{spacing: 6 cm}}, interface: bond}}
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{pressure: {{left: 1 MPa, right: 1 MPa, top: 1 MPa}}, steps: 2}}
  - {{strain: {{boundary: top, value: 0.1 %}}, platens: smooth, steps: 5}}
)",
                                     gravity));
    };
    const double expected = run_with(0.0).history.back().axial_stress;
    for (const double gravity : {9.81, 0.1, 1e-9}) {
        const SceneRun run = run_with(gravity);
        EXPECT_EQ(run.report.status, RunStatus::done) << gravity;
        for (const StepRecord& row : run.history) EXPECT_TRUE(row.balanced) << gravity << ": " << row.step;
        EXPECT_NEAR(run.history.back().axial_stress, expected, 1e-3 * expected) << gravity; // 9 kPa of weight on 5 MPa
    }
}

// rho g s^2 of a block of size s, on one of size 1.
TEST(Extremes, SmallBlockOnALargeOneSettlesUnderItsWeight) {
    for (const double size : {1.0, 1e-2, 1e-3}) {
        const double x = 0.5 - 0.5 * size;
        const std::string scene = std::string(materials_and_joint) + fmt::format(R"(
geometry:
  blocks:
    - {{name: base, polygon: [[-1, -1], [2, -1], [2, 0], [-1, 0]], support: fixed}}
    - {{name: large, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}}
    - {{name: small, polygon: [[{0}, 1], [{1}, 1], [{1}, {2}], [{0}, {2}]]}}
stages: [{{name: weight, gravity: 10}}]
output: {{histories: {{upper: {{interface: [large, small]}}}}}}
)",
                                                                                 x, x + size, 1.0 + size);
        const SceneRun run = run_scene(scene);
        ASSERT_EQ(run.report.status, RunStatus::done) << size;
        const double weight = 2500.0 * 10.0 * size * size;
        EXPECT_NEAR(run.history.back().histories.front(), weight, 1e-6 * weight) << size;
    }
}

std::string held_block(const std::string& sides) {
    return std::string(materials_and_joint) + fmt::format(R"(
geometry: {{domain: {{rectangle: {{width: 1, height: 1}}}}}}
boundaries: {{left: {{support: {0}}}, right: {{support: {0}}}, bottom: {{support: {0}}}}}
stages: [{{name: press, strain: {{boundary: top, value: 1e-6}}}}]
)",
                                                          sides);
}

TEST(Extremes, PlatenAgainstASupportIsRefusedAndAlongItIsNot) {
    const SceneRun run = run_scene(held_block("smooth"));
    EXPECT_NEAR(last_modulus(run), 10e9, 1e-6 * 10e9); // nu = 0: the sides carry nothing
    for (const char* support : {"pinned", "fixed"}) {
        try {
            (void)run_scene(held_block(support));
            FAIL() << support;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("support: expected one that leaves the block 0 at (0.5, 0.5) free"));
        }
    }
}

std::string refusal(const std::string& scene) {
    try {
        (void)build_scene_model(read_scene_text(scene, {}, "scene.yaml"));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// The block at a corner of a square on its tip is on an upper and on a lower side: no support of the scene holds it.
TEST(Extremes, BlockOnTwoPlatensThatCannotFollowBothIsRefused) {
    const std::string square = std::string(materials_and_joint) + R"(
geometry: {domain: {polygon: [[0, -1], [1, 0], [0, 1], [-1, 0]]}, tessellation: {hexagons: {spacing: 0.15}, interface: joint}}
stages:
  - strain: {boundary: top, value: 0.5 %}
    platens: rough
)";
    EXPECT_THAT(refusal(square), testing::AllOf(testing::StartsWith("scene.yaml:11:24: stages.0.strain.boundary: "
                                                                    "expected a boundary that shares no block with "
                                                                    "'bottom', which rests on the fixed platen"),
                                                HasSubstr("found 'top' in stage 0, and the block ")));
    const std::string rigid = std::string(materials_and_joint) + R"(
geometry:
  blocks: [{name: a, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}, {name: b, polygon: [[0, 1], [1, 1], [1, 2], [0, 2]]}]
stages: [{strain: {boundary: right, value: 0.1 %}}]
)";
    EXPECT_EQ(refusal(rigid), ""); // affine blocks shorten
    std::string stiff = rigid;
    stiff.replace(stiff.find("plane: stress"), 13, "plane: stress, kinematics: rigid");
    EXPECT_THAT(refusal(stiff), testing::AllOf(HasSubstr("shares no block with 'left'"), HasSubstr("the block 'a'")));
}

// sigma = E strain/(1 + strain) of a bar with nu = 0 that keeps its width: P = E strain, divided by the width.
TEST(Extremes, StressOfATinyStrainHasAllItsDigits) {
    const ElasticModuli moduli{0.0, 0.5e10};
    for (const double strain : {1e-3, 1e-9, 1e-14, 1e-30}) {
        Mat2 h = Mat2::Zero();
        h(1, 1) = strain;
        EXPECT_NEAR(cauchy_stress_of_gradient(h, moduli)(1, 1), 1e10 * strain, 1e-14 * 1e10 * strain) << strain;
    }
}

// The stress of the bonded bar is E_m strain with 1/E_m = 1/E + 1/(k_n H).
TEST(Extremes, TinyDisplacementsOfAPlatenAreMet) {
    const std::string scene = std::string(materials_and_joint) + R"(
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  fractures: [{trace: [[-0.1, 1], [1.1, 1]]}]
boundaries: {bottom: {support: pinned}}
stages: [{strain: {boundary: top, value: 1e-13}, steps: 5}]
)";
    const SceneRun run = run_scene(scene);
    const double modulus = 1.0 / (1.0 / 10e9 + 1.0 / (10e9 * 2.0));
    for (std::size_t step = 1; step < run.history.size(); ++step) {
        EXPECT_NEAR(run.history[step].axial_strain, 2e-14 * static_cast<double>(step), 1e-9 * 1e-13) << step;
        EXPECT_NEAR(run.history[step].axial_stress, modulus * run.history[step].axial_strain, 1e-9 * modulus * 1e-13)
            << step;
    }
}

// Hexagons whose edges resist shear 500 times as much as closing have moduli in the plane that no isotropic material has in plane strain:
// G is more than 3 K, and E is below zero. Under a pressure p on two sides the body is as stiff as 4 K G/(K + G), (20); one that turns and that nothing holds has no
// equilibrium, and says so. (With a scale of forces below zero its load step never ended.)
TEST(Extremes, NetLikeNoIsotropicMaterial) {
    const auto scene = [](const char* loads) {
        return fmt::format(R"(
kluft: 1
analysis: {{plane: strain}}
materials: {{rock: {{youngs_modulus: 5 GPa, poissons_ratio: 0.25, cohesion: 1 MPa, friction_angle: 40, tensile_strength: 0.3 MPa}}}}
interfaces:
  crack: {{kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 20}}
  bond: {{kind: potential_crack, fails_to: crack, normal_stiffness: 0.1 GPa/m, shear_stiffness: 50 GPa/m}}
geometry: {{domain: {{rectangle: {{width: 10, height: 10}}}}, tessellation: {{hexagons: {{spacing: 1}}, interface: bond}}}}
{}
)",
                           loads);
    };
    const SceneRun pressed =
        run_scene(scene("boundaries: {bottom: {support: smooth}}\nstages: [{pressure: {top: 10 kPa}}]"));
    ASSERT_TRUE(stands(pressed)) << pressed.report.diagnosis;
    EXPECT_GT(pressed.model.effective_modulus, 0.0);
    const ElasticModuli rock = plane_moduli(5e9, 0.25, Plane::strain);
    const double bulk = 0.5 / (0.5 / (rock.lambda + rock.mu) + 1.0 / 0.1e9);
    const double shear = 0.5 / (0.5 / rock.mu + 2.0 / (0.1e9 + 50e9));
    const double strain = 10e3 * (bulk + shear) / (4.0 * bulk * shear);
    EXPECT_NEAR(pressed.history.back().axial_strain, strain, 0.03 * strain); // cells at the outline are halves

    const SceneRun pushed = run_scene(scene("stages: [{pressure: {left: 0.1 MPa}}]"));
    EXPECT_EQ(pushed.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(pushed.report.diagnosis, HasSubstr("nothing holds the body"));
}

// On a plane of 26.6 degrees without friction nothing holds the block, whatever is lost of its weight beside its stiffness: 64 units of round-off of that
// are more than the weight.
TEST(Extremes, StiffnessInWhichTheWeightIsLostHoldsNoBlock) {
    const std::string text = R"(kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 0}}
geometry:
  reference_spacing: 1
  blocks:
    - {name: base, polygon: [[0, -1], [4, -1], [4, 2], [0, 0]], support: fixed}
    - {name: top, polygon: [[1, 0.5], [3, 1.5], [3, 3], [1, 2]]}
stages: [{name: weight}]
)";
    using Overrides = std::vector<std::string>;
    for (const Overrides& overrides : {Overrides{}, Overrides{"materials.rock.poissons_ratio=0.49999999999"},
                                       Overrides{"interfaces.joint.normal_stiffness=1e18",
                                                 "interfaces.joint.shear_stiffness=1e18", "analysis.gravity=1e-3"}})
        EXPECT_NE(run_scene(text, overrides).report.status, RunStatus::done) << overrides.size();
}

} // namespace
} // namespace kluft

// Bodies of triangles: their moduli are those of docs/theory.md, (20a) and (20b).
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using std::numbers::sqrt3;

/// Bonded equilateral triangles with a side of 1 m, eight rows between a smooth platen and a smooth support: lines at 0 and 60
/// degrees, and the sides cut triangles in halves.
std::string equilateral_rows(double shear_stiffness) {
    constexpr int n_rows = 8;
    constexpr double width = 5.0;
    const double height = n_rows * 0.5 * sqrt3;
    std::string traces;
    for (int row = 1; row < n_rows; ++row)
        traces += fmt::format("    - {{trace: [[-1, {0:.17g}], [6, {0:.17g}]], interface: bond}}\n", row * 0.5 * sqrt3);
    for (int i = -5; i <= 9; ++i) {
        const double x = i;
        traces += fmt::format("    - {{trace: [[{:.17g}, {:.17g}], [{:.17g}, {:.17g}]], interface: bond}}\n", x - 1.0,
                              -sqrt3, x + 5.0, 5.0 * sqrt3);
        traces += fmt::format("    - {{trace: [[{:.17g}, {:.17g}], [{:.17g}, {:.17g}]], interface: bond}}\n", x + 1.0,
                              -sqrt3, x - 5.0, 5.0 * sqrt3);
    }
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{density: 0, youngs_modulus: 1e10, poissons_ratio: 0.2}}}}
interfaces:
  bond: {{kind: potential_crack, normal_stiffness: 4e10, shear_stiffness: {:.17g}, cohesion: 1e12, friction_angle: 40,
         tensile_strength: 1e12, fails_to: joint}}
  joint: {{kind: fracture, normal_stiffness: 4e10, shear_stiffness: 2e10, friction_angle: 30}}
geometry:
  domain: {{rectangle: {{width: {:.17g}, height: {:.17g}}}}}
  reference_spacing: 1
  fractures:
{}
boundaries: {{bottom: {{support: smooth}}}}
stages: [{{pressure: {{top: 1e5}}, steps: 1}}]
solver: {{tolerance: 1e-11, balance: 1e-9}}
)",
                       shear_stiffness, width, height, traces);
}

/// The whole upright triangle with its centroid nearest to a place.
int triangle_at(const BlockSystem& system, const Vec2& place) {
    for (int b = 0; b < system.n_blocks(); ++b)
        if ((system.blocks[b].centroid - place).norm() < 1e-6) return b;
    return -1;
}

// In the lattice without end uniform tractions are compatible, so that this body has the same state: triangles of one kind
// keep distances that the strain of (20a) gives.
TEST(TriangleNetRun, EquilateralTrianglesHaveTheClosedFormsModuli) {
    for (const double shear_stiffness : {4e10, 2e10, 2e9}) {
        const auto run = run_scene(equilateral_rows(shear_stiffness));
        ASSERT_TRUE(stands(run)) << run.report.diagnosis;
        const auto moduli =
            lattice_moduli(plane_moduli(1e10, 0.2, Plane::stress), {.normal = 4e10, .shear = shear_stiffness},
                           equilateral_net(1.0), Plane::stress);
        const double above_base = 0.5 * sqrt3 / 3.0;
        const int low = triangle_at(run.model.system, {1.5, above_base});
        const int right = triangle_at(run.model.system, {3.5, above_base});
        const int high = triangle_at(run.model.system, {1.5, 3.0 * sqrt3 + above_base});
        ASSERT_GE(low, 0);
        ASSERT_GE(right, 0);
        ASSERT_GE(high, 0);
        const auto moved = [&](int block) -> Vec2 { return run.state.body.displacement.segment<2>(6 * block); };
        const double strain = 1e5 / moduli.youngs_modulus;
        EXPECT_NEAR((moved(high) - moved(low)).y() / (3.0 * sqrt3), -strain, 1e-5 * strain);
        EXPECT_NEAR((moved(right) - moved(low)).x() / 2.0, moduli.poissons_ratio * strain, 1e-5 * strain);
    }
}

std::string pressed_net(const std::string& net, const std::string& kinematics) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, kinematics: {}}}
materials: {{rock: {{density: 0, youngs_modulus: 1e10, poissons_ratio: 0.25, cohesion: 1e12, friction_angle: 40, tensile_strength: 1e12}}}}
interfaces:
  bond: {{kind: potential_crack, stiffness_ratio: 10, fails_to: joint}}
  joint: {{kind: fracture, stiffness_ratio: 10, friction_angle: 30}}
geometry:
  domain: {{rectangle: {{width: 5, height: 10}}}}
  tessellation: {{triangles: {}, interface: bond}}
boundaries: {{bottom: {{support: smooth}}}}
stages: [{{strain: {{boundary: top, value: 1e-5}}, steps: 1}}]
)",
                       kinematics, net);
}

// `stiffness_ratio` means the rock's moduli: (20a) with the edges that the net has, which is an approximation for triangles
// that are not equilateral, better the more there are (docs/theory.md gives what was measured).
TEST(SlowTriangleNetRun, NetsHaveTheRocksYoungsModulus) {
    const auto modulus = [](const std::string& net, const std::string& kinematics) {
        const auto run = run_scene(pressed_net(net, kinematics));
        EXPECT_TRUE(stands(run)) << run.report.diagnosis;
        return run.history.back().axial_stress / run.history.back().axial_strain;
    };
    for (const int seed : {1, 2}) {
        const auto net = [seed](double side, int passes) {
            return fmt::format("{{spacing: {}, seed: {}, relaxation: {}}}", side, seed, passes);
        };
        EXPECT_NEAR(modulus(net(0.5, 0), "affine"), 1e10, 0.012e10);
        EXPECT_NEAR(modulus(net(0.25, 0), "affine"), 1e10, 0.006e10);
        EXPECT_NEAR(modulus(net(0.25, 2), "affine"), 1e10, 0.005e10);
        EXPECT_NEAR(modulus(net(0.25, 2), "rigid"), 1e10, 0.02e10);
    }
    const std::string graded =
        "{spacing: 1, grading: {region: [[0, 0], [5, 0], [5, 4], [0, 4]], region_spacing: 0.25}}";
    EXPECT_NEAR(modulus(graded, "affine"), 1e10, 0.012e10);
}

/// A bonded body that nothing holds sideways, graded 1:100 in its middle, pressed by a platen in one step.
std::string graded_body_pressed_once(double viscosity, const std::string& stage_before = "") {
    return fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2, cohesion: 8 MPa, friction_angle: 40,
           tensile_strength: 2.5 MPa}}}}
interfaces:
  bond: {{kind: potential_crack, fails_to: crack}}
  crack: {{kind: fracture, friction_angle: 30}}
geometry:
  domain: {{rectangle: {{width: 1, height: 2}}}}
  tessellation:
    interface: bond
    triangles:
      spacing: 0.2
      grading: {{region: [[0.45, 0.95], [0.5, 0.95], [0.5, 1.05], [0.45, 1.05]], region_spacing: 0.002, growth: 0.3}}
boundaries: {{bottom: {{support: smooth}}}}
stages: [{}{{strain: {{boundary: top, value: 0.001 %}}, steps: 1}}]
solver: {{viscosity: {}}}
)",
                       stage_before, viscosity);
}

double axial_modulus_of(const SceneRun& run) {
    return run.history.back().axial_stress / run.history.back().axial_strain;
}

// The mass-like term leaves no trace in an elastic body, however many small blocks there are to add up what is left over on
// each. It had made this body 2 % too stiff, all steps balanced. Without the term the body is held by round-off alone.
TEST(SlowTriangleNetRun, MassLikeTermDoesNotStiffenABodyThatNothingHoldsSideways) {
    const auto run = run_scene(graded_body_pressed_once(5e-3));
    const auto without = run_scene(graded_body_pressed_once(0.0));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    ASSERT_TRUE(stands(without)) << without.report.diagnosis;
    EXPECT_NEAR(axial_modulus_of(run), axial_modulus_of(without), 2e-4 * axial_modulus_of(without));
}

// Ten times the stress of the platen's step is there before: what may be left over of the whole, a thousandth, is a hundredth of
// the step. In plane strain the body's modulus is E/(1 - nu^2).
TEST(TriangleNetRun, MassLikeTermDoesNotLagBehindASmallStepUnderPressure) {
    const auto run =
        run_scene(graded_body_pressed_once(5e-3, "{pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}, steps: 1}, "));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const auto& rows = run.history;
    const double growth = rows.back().axial_stress - rows[rows.size() - 2].axial_stress;
    EXPECT_NEAR(growth / rows.back().axial_strain, 10e9 / (1.0 - 0.2 * 0.2), 0.003 * 10e9);
}

// A fine net hangs together: the platen moves by a sixth of a triangle's side, and no two neighbours part. Newton's method
// needs two or three iterations for an elastic body however fine its net is.
TEST(TriangleNetRun, ElasticStepOfAFineNetTakesFewIterations) {
    for (const double spacing : {0.2, 0.05}) {
        const auto run = run_scene(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2, cohesion: 800 MPa, friction_angle: 40,
           tensile_strength: 250 MPa}}}}
interfaces:
  bond: {{kind: potential_crack, fails_to: crack}}
  crack: {{kind: fracture, friction_angle: 30}}
geometry:
  domain: {{rectangle: {{width: 1, height: 2}}}}
  tessellation: {{triangles: {{spacing: {}}}, interface: bond}}
boundaries: {{bottom: {{support: pinned}}}}
stages: [{{strain: {{boundary: top, value: 0.4 %}}, steps: 1}}]
)",
                                               spacing));
        ASSERT_TRUE(stands(run)) << run.report.diagnosis;
        EXPECT_LE(run.report.costs.open_close_iterations, 4) << spacing;
    }
}

// The second stage holds other blocks than the first. With the factor of the first each of them takes a vector or two of every solution:
// 62 in this run. Nothing can change its state, so that a solve is as exact as the iteration asks for, and two do in each step.
TEST(TriangleNetRun, ElasticStepsTakeFewVectorsAfterAChangeOfStage) {
    const auto run = run_scene(R"(
kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2, cohesion: 800 MPa, friction_angle: 40,
           tensile_strength: 250 MPa}}
interfaces:
  bond: {kind: potential_crack, fails_to: crack}
  crack: {kind: fracture, friction_angle: 30}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  tessellation: {triangles: {spacing: 0.05}, interface: bond}
boundaries: {bottom: {support: smooth}}
stages:
  - {pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}, steps: 1}
  - {strain: {boundary: top, value: 0.03 %}, steps: 3}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_LE(run.report.costs.open_close_iterations, 8);
    EXPECT_LE(run.report.costs.refinements, 15);
}

} // namespace
} // namespace kluft

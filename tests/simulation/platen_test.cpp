// Platens as surfaces: what touches them, leaves them and slides along them.
#include "kluft/loading/platen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// A bonded specimen of 1 m by 2 m and 10 GPa, Poisson's ratio 0.25, in plane stress between platens.
SceneRun press(const std::string& stages) {
    return run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, friction_angle: 30}}
  bond: {{kind: potential_crack, stiffness_ratio: 10, shear_ratio: 0.5, cohesion: 1 GPa, friction_angle: 30,
         tensile_strength: 1 GPa, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: 1, height: 2}}}}
  tessellation: {{hexagons: {{spacing: 0.25}}, interface: bond}}
stages: {}
)",
                                 stages));
}

// A platen that goes away, or does not push, takes nothing of the body along.
TEST(Platens, DoNotPullTheBody) {
    for (const char* platens : {"smooth", "rough", "{friction_angle: 20}"}) {
        for (const char* control : {"strain: {boundary: top, value: -0.1 %}", "stress: {boundary: top, value: 0}"}) {
            const SceneRun run = press(fmt::format("[{{{}, platens: {}, steps: 2}}]", control, platens));
            EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
            EXPECT_NEAR(run.history.back().axial_stress, 0.0, 1e-3) << platens;
            EXPECT_LT(run.state.body.displacement.lpNorm<Eigen::Infinity>(), 1e-12) << platens;
        }
    }
}

// A body without loads is at rest where it was, whatever the platen has stretched before it let go.
TEST(Platens, LeaveLooseBlocksAtRest) {
    for (const double strain : {1e-9, 1e-6, 1e-3, 0.1}) {
        const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle: 30}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 4}}}}
  fractures: [{{trace: [[-0.1, 1], [1.1, 1]]}}, {{trace: [[-0.1, 3], [1.1, 3]]}}]
boundaries: {{bottom: {{support: pinned}}}}
stages: [{{strain: {{boundary: top, value: -{}}}, steps: 4}}]
)",
                                                   strain));
        EXPECT_EQ(run.report.status, RunStatus::done) << strain << ": " << run.report.diagnosis;
        EXPECT_NEAR(run.history.back().axial_stress, 0.0, 1e-3);
        EXPECT_LT(run.state.body.displacement.lpNorm<Eigen::Infinity>(), 1e-12);
    }
}

// E = 10 GPa in tension as in compression.
TEST(Platens, PullWhatIsGluedToThem) {
    const SceneRun run = press("[{strain: {boundary: top, value: -0.1 %, glued: true}}]");
    EXPECT_NEAR(run.history.back().axial_stress, -1e-3 * 10e9, 0.01 * 1e7);
    EXPECT_NEAR(run.history.back().axial_strain, -1e-3, 1e-15);
}

// Coulomb: between smooth (0 degrees) and rough the lateral expansion nu eps is hindered more and more.
TEST(Platens, HinderTheBodyByTheirFriction) {
    const auto expansion = [](const std::string& platens) {
        const SceneRun run =
            press(fmt::format("[{{strain: {{boundary: top, value: 0.1 %}}, platens: {}, steps: 4}}]", platens));
        EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        return -run.history.back().lateral_strain;
    };
    EXPECT_NEAR(expansion("smooth"), 0.25 * 1e-3, 0.01 * 2.5e-4);
    double last = expansion("smooth");
    EXPECT_NEAR(expansion("{friction_angle: 0}"), last, 1e-9);
    for (const char* platens : {"{friction_angle: 2}", "{friction_angle: 5}", "{friction_angle: 10}", "rough"}) {
        const double now = expansion(platens);
        EXPECT_LT(now, 0.99 * last) << platens;
        last = now;
    }
}

/// A specimen of 1 m by 2 m with a joint at 1.7 m, and above it four pairs of joints that meet `beyond` above the platen: between each
/// pair stands a wedge with a face of two thirds of that.
std::string wedges_under_a_platen(double beyond, const std::string& platens, const std::string& more = {}) {
    std::string traces;
    for (const double x : {0.2, 0.4, 0.6, 0.8}) {
        for (const double side : {-0.1, 0.1})
            traces += fmt::format("    - {{trace: [[{:.17g}, 1.7], [{:.17g}, {:.17g}]], interface: joint}}\n", x + side,
                                  x - 0.2 * side, 1.7 + 1.2 * (0.3 + beyond));
    }
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, friction_angle: 30}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 2}}}}
{}
  fractures:
{}    - {{trace: [[-0.1, 1.7], [1.1, 1.7]], interface: joint}}
boundaries: {{bottom: {{support: pinned}}}}
stages: [{{strain: {{boundary: top, value: 0.1 %}}, platens: {}, steps: 4}}]
)",
                       more, traces, platens);
}

// The two vertices of a face that is hardly there would carry a couple, one of them in tension, beside whose forces friction and opening
// elsewhere were lost.
TEST(Platens, StandOnOnePointOfATinyFace) {
    const auto stress = [](double beyond) {
        const SceneRun run = run_scene(wedges_under_a_platen(beyond, "{friction_angle: 10}"));
        EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        return run.history.back().axial_stress;
    };
    const double expected = stress(1e-3);
    for (const double beyond : {1e-7, 1e-6, 1e-5, 1e-4})
        EXPECT_NEAR(stress(beyond), expected, 1e-4 * expected) << beyond;
}

// A spacing far below that of the blocks allows motions so small that a platen cannot be followed: then there is no result, not one
// of a body that stays behind.
TEST(Platens, AreFollowedOrThereIsNoEquilibrium) {
    for (const char* platens : {"smooth", "{friction_angle: 10}"}) {
        const auto press_with = [&](const char* spacing) {
            return run_scene(wedges_under_a_platen(3e-3, platens, fmt::format("  reference_spacing: {}", spacing)));
        };
        const double expected = press_with("1e-2").history.back().axial_stress;
        EXPECT_GT(expected, 9.5e6);
        for (const char* spacing : {"1e-3", "1e-4", "1e-5"}) {
            const SceneRun run = press_with(spacing);
            if (run.report.status == RunStatus::no_equilibrium) {
                EXPECT_THAT(run.report.diagnosis, testing::HasSubstr("cannot follow its supports and platens"));
                continue;
            }
            EXPECT_EQ(run.report.status, RunStatus::done) << spacing;
            EXPECT_NEAR(run.history.back().axial_stress, expected, 0.01 * expected) << spacing;
        }
    }
}

/// Two blocks, one on the other, under 1 MPa between platens with friction; the upper one is pushed sideways (N/m).
SceneRun push(double force) {
    const char* const platen = "stress: {boundary: top, value: 1 MPa}, platens: {friction_angle: 20}";
    return run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 100 GPa, poissons_ratio: 0}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, friction_angle: 10}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 1}}}}
  fractures: [{{trace: [[-1, 0.5], [2, 0.5]]}}]
  reference_spacing: 1
stages:
  - {{{}}}
  - {{{}, steps: 4, forces: {{aside: {{point: [0.5, 0.99], force: [{}, 0]}}}}}}
)",
                                 platen, platen, force));
}

// The platen carries N tan(20), the joint N tan(10): beyond both the block goes.
TEST(Platens, HoldABlockUpToTheLimitOfFriction) {
    const double limit = 1e6 * (std::tan(20 * radians_per_degree) + std::tan(10 * radians_per_degree));
    const SceneRun below = push(0.97 * limit);
    EXPECT_EQ(below.report.status, RunStatus::done) << below.report.diagnosis;
    EXPECT_NE(push(1.03 * limit).report.status, RunStatus::done);
}

/// Highest and lowest place of a vertex (m).
std::pair<double, double> extent_of(const SceneRun& run) {
    const BlockSystem& system = run.model.system;
    std::pair extent(1e300, -1e300);
    for (int b = 0; b < system.n_blocks(); ++b) {
        for (const Edge& edge : system.blocks[b].edges) {
            const double y = current_position(system, run.state.body.displacement, b, edge.start).y();
            extent = {std::min(extent.first, y), std::max(extent.second, y)};
        }
    }
    return extent;
}

// A leaning column stands on the corners (1, 0) and (2, 2) only, and turns by travel over their distance of 1 m: no vertex is
// held from above or enters a platen, in either integrator.
TEST(Platens, AreNotEnteredByWhatTurns) {
    for (const char* integrator : {"implicit", "explicit"}) {
        const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress, integrator: {}}}
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, density: 2500}}}}
geometry:
  domain: {{polygon: [[0, 0], [1, 0], [3, 2], [2, 2]]}}
  reference_spacing: 1
boundaries: {{bottom: {{sides: [0]}}, top: {{sides: [2]}}}}
stages: [{{displacement: {{boundary: top, value: 20 mm}}, steps: 10}}]
)",
                                                   integrator));
        const auto [lowest, highest] = extent_of(run);
        const double travel = 20e-3 * run.history.back().load_factor;
        EXPECT_GT(run.history.back().load_factor, 0.0);
        EXPECT_LT(highest, 2.0 - travel + 1e-4) << integrator;
        EXPECT_GT(lowest, -1e-4) << integrator;
        const double turn = -run.state.body.displacement[3] / run.model.system.blocks[0].size; // clockwise
        EXPECT_NEAR(turn, travel, 0.05 * travel) << integrator;
    }
}

/// A wedge whose tip lies between two blocks in the plane of a platen, and which they slide down under 0.1 MPa; upright or on its head.
SceneRun press_a_tip(bool upright, bool glued, const char* integrator, const char* spacing = "0.5") {
    const double tip = upright ? 1.0 : 0.0;
    return run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress, integrator: {}}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.2, density: 2500}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 10}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 1}}}}
  fractures:
    - {{trace: [[-0.1, 0.5], [1.1, 0.5]]}}
    - {{trace: [[0.5, {}], [0, 0.5]]}}
    - {{trace: [[0.5, {}], [1, 0.5]]}}
  reference_spacing: {}
boundaries: {{bottom: {{support: pinned}}}}
stages:
  - {{pressure: {{top: 0.1 MPa, left: 0.1 MPa, right: 0.1 MPa}}}}
  - {{displacement: {{boundary: top, value: 10 mm, glued: {}}}, platens: smooth, steps: 20}}
)",
                                 integrator, tip, tip, spacing, glued));
}

/// Both integrators stop the tip, each with iterations of its own, and no farther out of the plane than 0.5 % of the wedge,
/// whose spacing is less than 0.6 m.
void expect_a_stop(bool upright, bool glued) {
    std::vector<double> stresses;
    for (const char* integrator : {"implicit", "explicit"}) {
        const SceneRun run = press_a_tip(upright, glued, integrator);
        ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        const auto [lowest, highest] = extent_of(run);
        EXPECT_LT(highest, 1.0 - 10e-3 + 3.1e-3) << integrator;
        EXPECT_GT(lowest, -3.1e-3) << integrator;
        EXPECT_GT(std::max(highest - 0.99, -lowest), 1e-3) << "a rounded tip";
        stresses.push_back(run.history.back().axial_stress);
    }
    EXPECT_GT(stresses[0], 40e6);
    EXPECT_NEAR(stresses[0], stresses[1], 1e-3 * stresses[1]);
}

// A corner that has no face on the platen went through it: the body carried 0.14 MPa for ever.
TEST(Platens, StopATipBetweenTheFacesThatTheyAreLaidOn) {
    expect_a_stop(true, false);
    expect_a_stop(false, false);
}

TEST(Platens, StopATipWhateverTheSpacing) {
    for (const bool upright : {true, false}) {
        const double expected = press_a_tip(upright, false, "implicit").history.back().axial_stress;
        for (const char* spacing : {"0.05", "20"})
            EXPECT_NEAR(press_a_tip(upright, false, "implicit", spacing).history.back().axial_stress, expected,
                        1e-3 * expected);
    }
}

// The tip lies in the lower step of its boundary, and touches as the faces beside it do: as they were laid.
TEST(Platens, StopATipBetweenLowerFaces) {
    const SceneRun run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.2, density: 2500}}
interfaces: {joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 10}}
geometry:
  domain: {polygon: [[0, 0], [1, 0], [1, 1], [0.2, 1], [0.2, 1.02], [0, 1.02]]}
  fractures:
    - {trace: [[-0.1, 0.5], [1.1, 0.5]]}
    - {trace: [[0.5, 1], [0, 0.5]]}
    - {trace: [[0.5, 1], [1, 0.5]]}
  reference_spacing: 0.5
boundaries:
  bottom: {sides: [0], support: pinned}
  right: {sides: [1]}
  top: {sides: [2, 4]}
  left: {sides: [5]}
stages:
  - {pressure: {top: 0.1 MPa, left: 0.1 MPa, right: 0.1 MPa}}
  - {displacement: {boundary: top, value: 10 mm}, platens: smooth, steps: 20}
)");
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_GT(run.history.back().axial_stress, 40e6);
}

TEST(Platens, StopWhatComesToThemWhereTheyAreGlued) {
    expect_a_stop(true, true);
    expect_a_stop(false, true);
}

/// Columns of 1 m beside and under a platen on both outer ones, without friction between them: E = 10 GPa, nu = 0, 1 mm.
SceneRun press_columns(const char* polygon, const char* laid_sides, const char* traces) {
    return run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, friction_angle: 0}}}}
geometry:
  domain: {{polygon: {}}}
  fractures: [{}]
  reference_spacing: 1
boundaries:
  bottom: {{sides: [0], support: pinned}}
  laid: {{sides: {}}}
stages: [{{displacement: {{boundary: laid, value: 1 mm}}, steps: 4}}]
)",
                                 polygon, traces, laid_sides));
}

// A platen presses what it is laid on: two columns of three. A stem that stands out between its two parts, or a face there that is another
// boundary's, is none of it.
TEST(Platens, PressNothingBetweenTheirParts) {
    const char* const joints = "{trace: [[1, -1], [1, 3]]}, {trace: [[2, -1], [2, 3]]}";
    const SceneRun stem =
        press_columns("[[0, 0], [3, 0], [3, 1], [2, 1], [2, 2], [1, 2], [1, 1], [0, 1]]", "[2, 6]", joints);
    const SceneRun face = press_columns("[[0, 0], [3, 0], [3, 1], [2, 1], [1, 1], [0, 1]]", "[2, 4]", joints);
    for (const SceneRun* run : {&stem, &face}) {
        ASSERT_EQ(run->report.status, RunStatus::done) << run->report.diagnosis;
        EXPECT_NEAR(run->history.back().axial_stress, 10e6, 1e-4 * 10e6); // over the 2 m
    }
}

/// A triangle between two columns of 0.1 m x 0.2 m, E = 10 GPa, under a strain of 0.1 %: its tip stands before the plane of the
/// platen that is moved, or of the one that rests.
SceneRun press_a_triangle(double before, bool upright, const char* of_stage) {
    return run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25, density: 2500}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 30, normal_stiffness: 1e11, shear_stiffness: 5e10}}}}
geometry:
  blocks:
    - {{name: a, polygon: [[0, 0], [0.1, 0], [0.1, 0.2], [0, 0.2]]}}
    - {{name: b, polygon: [[0.3, 0], [0.4, 0], [0.4, 0.2], [0.3, 0.2]]}}
    - {{name: c, polygon: {}}}
  blocks_interface: joint
  reference_spacing: 0.1
stages: [{{strain: {{boundary: top, value: 0.1 %}}, steps: 4, {}}}]
)",
                                 upright ? fmt::format("[[0.12, 0], [0.28, 0], [0.2, {:.17g}]]", 0.2 + before)
                                         : fmt::format("[[0.12, 0.2], [0.2, {:.17g}], [0.28, 0.2]]", -before),
                                 of_stage));
}

double force_of_platen(const SceneRun& run, double width) {
    const StepRecord& last = run.history.back();
    return last.axial_stress * width * (1.0 - last.lateral_strain);
}

// A tip that a rounding of its coordinates puts before the plane of the platen touches it as it lies. E times the strain is 10 MPa, on 0.2 m of
// columns and on 0.08 m of the triangle, its mean width: 2.8 MN/m. It went through the platen, without a word: 2.0 MN/m.
TEST(Platens, StopATipThatStandsBeforeThemByARounding) {
    for (const bool upright : {true, false}) {
        const double width = upright ? 0.28 : 0.36; // the mean one, or the faces under the moved platen
        for (const char* platens : {"platens: smooth", "platens: rough", "platens: {friction_angle: 20}"}) {
            const double in_plane = force_of_platen(press_a_triangle(0.0, upright, platens), width);
            for (const double before : {1e-9, 1e-7, 1e-5}) {
                const SceneRun run = press_a_triangle(before, upright, platens);
                ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
                EXPECT_NEAR(force_of_platen(run, width), in_plane, 1e-3 * in_plane) << platens << before;
            }
        }
        const SceneRun smooth = press_a_triangle(1e-9, upright, "platens: smooth");
        EXPECT_NEAR(force_of_platen(smooth, width), 2.8e6, 1e-3 * 2.8e6);
    }
}

// Direct shear: the body goes on in the plane of the fixed platen beyond its end, and passes there.
TEST(Platens, EndWhereTheBodyGoesOnInTheirPlane) {
    const SceneRun run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 100 GPa, poissons_ratio: 0}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 20}}
geometry:
  domain: {polygon: [[0, 0], [1, 0], [1, 0.5], [1, 1], [0, 1], [0, 0.5]]}
  fractures: [{trace: [[-1, 0.5], [2, 0.5]]}]
  reference_spacing: 1
boundaries:
  bottom: {sides: [0], support: fixed}
  lower_right: {sides: [1]}
  top: {sides: [3]}
  upper_left: {sides: [4]}
stages:
  - {pressure: {top: 1 MPa}}
  - {displacement: {boundary: upper_left, value: 2 mm}, steps: 4}
)");
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    double force = 0.0; // of the platen: what the joint carries, whatever the place of its resultant
    for (const auto& joint : run.fields.back().interfaces) force += std::abs(joint.shear_traction) * (1.0 - 2e-3);
    EXPECT_NEAR(force, 1e6 * std::tan(20 * radians_per_degree), 1e-3 * 1e6);
}

// The same with a bonded joint in the upper block, near the end of the lower one: after 10 mm its vertices come past the end of the platen
// below, which had them, too (253 MPa for 0.96).
TEST(Platens, EndForAllThatLiesBeyondTheirEnd) {
    for (const char* bond : {"[[0.99, 0.3], [0.99, 0.7]]", "[[0.01, -0.1], [0.01, 0.3]]"}) {
        const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 50 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 50 GPa/m, shear_stiffness: 25 GPa/m, friction_angle: 30}}
  bond: {{kind: potential_crack, normal_stiffness: 5e12, shear_stiffness: 2.5e12, cohesion: 1 GPa, friction_angle: 30,
         tensile_strength: 1 GPa, fails_to: joint}}
geometry:
  domain: {{polygon: [[0, 0], [1, 0], [1, 0.3], [1, 0.6], [0, 0.6], [0, 0.3]]}}
  fractures: [{{trace: [[-0.1, 0.3], [1.1, 0.3]], interface: joint}}, {{trace: {}, interface: bond}}]
boundaries:
  bottom: {{sides: [0], support: fixed}}
  lower_right: {{sides: [1], support: smooth}}
  top: {{sides: [3]}}
  slider: {{sides: [4]}}
stages:
  - {{pressure: {{top: 1 MPa}}}}
  - {{displacement: {{boundary: slider, value: 20 mm}}, steps: 20}}
)",
                                                   bond));
        ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        double largest = 0.0;
        for (const StepRecord& row : run.history) largest = std::max(largest, row.axial_stress);
        const double expected =
            1e6 * std::tan(30 * radians_per_degree) / 0.6; // over the body's width across the motion
        EXPECT_NEAR(largest, expected, 2e-3 * expected) << bond;
    }
}

// Pressed from the right on a smooth floor, which holds the body as it is: E = 10 GPa and nu = 0.25, no force on the floor. Where a vertex of
// the fixed platen was held along it as well it was 8 GPa.
TEST(Platens, DoNotHoldAlongTheirFaceWhatASupportHolds) {
    for (const char* support : {"smooth", "none"}) {
        const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
geometry: {{domain: {{polygon: [[0, 0], [1, 0], [1, 1], [1, 2], [0, 2], [0, 1]]}}}}
boundaries: {{bottom: {{sides: [0], support: {}}}, right: {{sides: [1, 2]}}, top: {{sides: [3]}}, left: {{sides: [4, 5]}}}}
stages: [{{strain: {{boundary: right, value: 1e-4}}, steps: 4}}]
)",
                                                   support));
        ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        EXPECT_NEAR(run.history.back().axial_stress, 1e-4 * 10e9, 1e-3 * 1e6) << support;
        EXPECT_NEAR(run.history.back().lateral_strain, -0.25e-4, 1e-3 * 1e-4) << support;
    }
}

// The strain of a stage is that of the platens, also where nothing touches them any more and in the stages after.
TEST(Platens, MeasureTheStrain) {
    const SceneRun run = press("[{strain: {boundary: top, value: 0.1 %}, steps: 2}, {strain: {boundary: top, value: "
                               "-0.3 %}, steps: 3}, {strain: {boundary: top, value: 0.25 %}, steps: 5}]");
    ASSERT_EQ(run.history.size(), 11U);
    const double stress = run.history[2].axial_stress;
    EXPECT_NEAR(run.history[2].axial_strain, 1e-3, 1e-14);
    EXPECT_NEAR(run.history[5].axial_strain, -2e-3, 1e-14);
    EXPECT_NEAR(run.history[5].axial_stress, 0.0, 1e-4 * stress);
    EXPECT_NEAR(run.history[9].axial_stress, 0.0, 1e-4 * stress); // back where it was laid
    EXPECT_NEAR(run.history[10].axial_strain, 5e-4, 1e-14);
    EXPECT_NEAR(run.history[10].axial_stress, 0.5 * stress, 0.002 * stress);
}

/// One elastic block of 1 m by 2 m, E 10 GPa, Poisson's ratio 0.25, plane strain; axial stress at the end (Pa).
double pressed_twice(const std::string& first, const std::string& second) {
    const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: strain}}
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
geometry: {{domain: {{rectangle: {{width: 1, height: 2}}}}}}
stages:
  - {{strain: {{boundary: top, value: 0.01 %}}, platens: {}, steps: 5}}
  - {{strain: {{boundary: top, value: 0.01 %}}, platens: {}, steps: 5}}
)",
                                               first, second));
    EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    return run.history.back().axial_stress;
}

// Each half adds 0.01 % of E/(1-nu2) between smooth and of (1-nu)E/((1+nu)(1-2nu)) between rough platens; what rough ones have
// held back goes when they become smooth.
TEST(Platens, TakeTheFrictionOfTheirStage) {
    const double smooth = 1e-4 * 10e9 / (1 - 0.25 * 0.25);
    const double rough = 1e-4 * 10e9 * 0.75 / (1.25 * 0.5);
    const double tolerance = 1e-3 * smooth; // strains of 2e-4 are finite
    EXPECT_NEAR(pressed_twice("smooth", "smooth"), 2 * smooth, tolerance);
    EXPECT_NEAR(pressed_twice("rough", "rough"), 2 * rough, tolerance);
    EXPECT_NEAR(pressed_twice("rough", "smooth"), 2 * smooth, tolerance);
    EXPECT_NEAR(pressed_twice("{friction_angle: 10}", "smooth"), 2 * smooth, tolerance);
    EXPECT_NEAR(pressed_twice("smooth", "rough"), smooth + rough, tolerance);
    const double once = pressed_twice("{friction_angle: 10}", "{friction_angle: 10}") / 2;
    EXPECT_NEAR(pressed_twice("{friction_angle: 10}", "rough"), once + rough, tolerance);
}

/// Weightless blocks of 10 GPa with smooth joints under a platen of 1 MPa; vertical stress of a block (Pa).
std::vector<double> stresses_under_platen(const std::string& blocks) {
    const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e13, shear_stiffness: 1e13, friction_angle: 30}}}}
geometry: {{blocks: [{}]}}
stages: [{{stress: {{boundary: top, value: 1 MPa}}, steps: 2}}]
)",
                                               blocks));
    EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_NEAR(run.history.back().axial_stress, 1e6, 2e3);
    std::vector<double> stresses;
    for (const Mat2& stress : block_stresses(run.model.system, run.model.moduli, run.state.body.displacement))
        stresses.push_back(-stress(1, 1));
    return stresses;
}

// Force over area: columns carry what the platen presses on them, pillars of two thirds of the width half as much again.
TEST(Platens, PressOnTheOutsideOfTheBodyOverItsOwnWidth) {
    const char* const columns =
        "{polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}, {polygon: [[2, 0], [3, 0], [3, 2], [2, 2]]}, "
        "{polygon: [[4, 0], [5, 0], [5, 2], [4, 2]]}";
    for (const double stress : stresses_under_platen(columns)) EXPECT_NEAR(stress, 1e6, 2e3);
    const auto room = stresses_under_platen(
        "{polygon: [[0, -1], [3, -1], [3, 0], [0, 0]]}, {polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}, "
        "{polygon: [[2, 0], [3, 0], [3, 2], [2, 2]]}, {polygon: [[0, 2], [3, 2], [3, 3], [0, 3]]}");
    EXPECT_NEAR(room[0], 1e6, 3e3);
    EXPECT_NEAR(room[1], 1.5e6, 3e3);
    EXPECT_NEAR(room[2], 1.5e6, 3e3);
    EXPECT_NEAR(room[3], 1e6, 3e3);
}

// Past the edge nothing but the platen behind it touches the block, and that does not carry it, however rough it is.
TEST(SlowPlatens, DoNotHoldABlockInTheAir) {
    for (const char* platens : {"smooth", "rough", "{friction_angle: 80}"}) {
        const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{gravity: 10}}
materials: {{rock: {{density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[0, 0], [3, 0], [3, 1], [0, 1]], support: fixed}}
    - {{name: pushed, polygon: [[1, 1], [2, 1], [2, 2], [1, 2]]}}
boundaries:
  left: {{block: pushed, facing: left}}
  right: {{block: base, facing: right}}
stages:
  - {{}}
  - {{displacement: {{boundary: left, value: 3}}, platens: {}, steps: 30}}
)",
                                                   platens));
        EXPECT_NE(run.report.status, RunStatus::done) << platens;
    }
}

// Force over area; without weight and stress the platen has left the body before.
TEST(Platens, UnderAForceComeBackToTheBody) {
    const SceneRun run = run_scene(R"(
kluft: 1
analysis: {gravity: 10}
materials: {rock: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  fractures: [{trace: [[-0.1, 1], [1.1, 1]]}]
boundaries: {bottom: {support: fixed}}
stages:
  - {}
  - {strain: {boundary: top, value: -0.1 %}}
  - {stress: {boundary: top, value: 0.1 MPa}, steps: 2}
)");
    EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_NEAR(run.history.back().axial_stress, 0.1e6, 1e2);
}

/// A trapezoid, 1 m wide below and half as wide on top, where its platen is: 0.75 m on average.
SceneRun pressed_trapezoid(const std::string& stages) {
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 5 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 30, normal_stiffness: 1e11, shear_stiffness: 5e10}}}}
geometry: {{domain: {{polygon: [[0, 0], [1, 0], [0.75, 1], [0.25, 1]]}}}}
boundaries: {{bottom: {{sides: [0], support: smooth}}, right: {{sides: [1]}}, top: {{sides: [2]}}, left: {{sides: [3]}}}}
stages: [{}]
)",
                                 stages));
}

// A stage starts from the force that the one before has ended with, whatever presses the boundary and whatever its width.
TEST(PlatenOfTheNextStage, StartsFromTheForceOfTheLast) {
    const std::string platen = "{stress: {boundary: top, value: 1 MPa}, steps: 2}";
    for (const char* next : {"{stress: {boundary: top, value: 1 MPa}, steps: 4}", "{pressure: {left: 0}, steps: 4}"}) {
        const SceneRun run = pressed_trapezoid(platen + ", " + next);
        ASSERT_TRUE(stands(run)) << next << run.report.diagnosis;
        for (std::size_t i = 2; i < run.history.size(); ++i)
            EXPECT_NEAR(run.history[i].axial_stress, 1e6, 200.0) << next << " step " << i;
    }
    // 1 MPa on 0.5 m are 0.667 MPa on 0.75 m, from which a platen's stress goes on to 1 MPa in four steps
    const SceneRun run =
        pressed_trapezoid("{pressure: {top: 1 MPa}}, {stress: {boundary: top, value: 1 MPa}, steps: 4}");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    for (int i = 0; i <= 4; ++i) EXPECT_NEAR(run.history[1 + i].axial_stress, (2.0 + 0.25 * i) / 3.0 * 1e6, 200.0) << i;
}

// Coulomb's law: 1 MPa on 1 m and 30 degrees hold 577 kN/m, which are 0.962 MPa on the height of 0.6 m.
TEST(PlatenOfTheNextStage, PushesOnWhatADirectShearTestHolds) {
    const auto pushed = [](const std::string& stages) {
        return run_scene(fmt::format(R"(kluft: 1
analysis: {{plane: strain}}
materials: {{rock: {{youngs_modulus: 20 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 30, normal_stiffness: 1e11, shear_stiffness: 5e10}}}}
geometry:
  domain: {{polygon: [[0, 0], [1, 0], [1, 0.3], [1, 0.6], [0, 0.6], [0, 0.3]]}}
  fractures: [{{trace: [[-0.1, 0.3], [1.1, 0.3]], interface: joint}}]
boundaries: {{bottom: {{sides: [0], support: fixed}}, top: {{sides: [3]}}, push: {{sides: [4]}}}}
stages: [{{pressure: {{top: 1 MPa}}, steps: 1}}, {}]
)",
                                     stages));
    };
    const std::string first = "{stress: {boundary: push, value: 0.58 MPa}, steps: 5}, ";
    const SceneRun further = pushed(first + "{stress: {boundary: push, value: 0.87 MPa}, steps: 5}");
    EXPECT_TRUE(stands(further)) << further.report.diagnosis;
    EXPECT_NEAR(further.history.back().axial_stress, 0.87e6, 1e3);
    EXPECT_FALSE(stands(pushed(first + "{stress: {boundary: push, value: 1.0 MPa}, steps: 5}")));
    const SceneRun kept = pushed(first + "{pressure: {top: 1 MPa}, steps: 3}");
    EXPECT_TRUE(stands(kept)) << kept.report.diagnosis;
    EXPECT_NEAR(kept.history.back().axial_stress, 0.58e6, 1e3);
}

} // namespace
} // namespace kluft

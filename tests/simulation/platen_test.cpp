// Platens as surfaces: what touches them, leaves them and slides along them.
#include "kluft/loading/platen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/kinematics/affine.hpp"
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

} // namespace
} // namespace kluft

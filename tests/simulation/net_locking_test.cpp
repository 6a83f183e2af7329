// Loose hexagons carry load as masonry does: what a run says where they do, and where they do not.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/output/summary.hpp"
#include "kluft/simulation/measurements.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

// Intact rock of 5 m by 10 m between smooth platens under a lateral pressure of 1 MPa, every edge a potential crack.
const std::string intact_rock = R"(
kluft: 1
materials:
  rock: {youngs_modulus: 15 GPa, poissons_ratio: 0.25, cohesion: 8 MPa, friction_angle: 40, tensile_strength: 2.5 MPa}
interfaces:
  joint: {kind: fracture, friction_angle: 38, normal_stiffness: 300 GPa/m, shear_stiffness: 150 GPa/m}
  bond: {kind: potential_crack, fails_to: joint, normal_stiffness: 300 GPa/m, shear_stiffness: 150 GPa/m}
geometry:
  domain: {rectangle: {width: 5, height: 10}}
  tessellation: {hexagons: {spacing: 1, rotation: 10}, interface: bond}
stages:
  - {pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa, bottom: 1 MPa}}
  - {strain: {boundary: top, value: 0.5 %}, steps: 20}
cracks: {strength_noise: 0.05}
)";

/// sigma_1 of Mohr-Coulomb for the rock: (2 c cos(phi) + sigma_3 (1 + sin(phi)))/(1 - sin(phi)), 38.9 MPa at 1 MPa.
double strength_of_the_rock(double sigma_3 = 1e6) {
    const double phi = 40.0 * std::numbers::pi / 180.0;
    return (2.0 * 8e6 * std::cos(phi) + sigma_3 * (1.0 + std::sin(phi))) / (1.0 - std::sin(phi));
}

double largest_stress(const SceneRun& run) {
    return std::ranges::max_element(run.equilibria, {}, &StepRecord::axial_stress)->axial_stress;
}

TEST(SlowNetLocking, RoughJointsLockHexagonsAndThePeakIsThatOfTheRockBefore) {
    const SceneRun run = run_scene(intact_rock);
    ASSERT_EQ(run.report.status, RunStatus::done);
    EXPECT_GT(largest_stress(run), 1.5 * strength_of_the_rock());
    EXPECT_EQ(run.history.back().net_broken, 1.0);
    const CurveNumbers numbers = curve_numbers(run.equilibria, run.history, 1, Plane::strain);
    EXPECT_TRUE(numbers.net_locked);
    EXPECT_FALSE(numbers.peak_reached);
    EXPECT_FALSE(numbers.residual_stress);
    EXPECT_NEAR(*numbers.peak_stress, strength_of_the_rock(), 0.05 * strength_of_the_rock()); // with 5 % noise
}

// Their stress rises from the first broken bonds on, and without a break: most bonds have failed where it is largest.
TEST(SlowNetLocking, TrianglesUnderHighPressureLockAndThePeakIsThatOfTheRockBefore) {
    const SceneRun run =
        run_scene(intact_rock, {"geometry.tessellation.hexagons=null", "geometry.tessellation.triangles.spacing=1",
                                "cracks.strength_noise=0", "stages.1.strain.value=2 %", "stages.1.steps=40",
                                "stages.0.pressure={left: 20 MPa, right: 20 MPa, top: 20 MPa, bottom: 20 MPa}"});
    ASSERT_EQ(run.report.status, RunStatus::done);
    EXPECT_GT(largest_stress(run), 1.1 * strength_of_the_rock(20e6));
    const CurveNumbers numbers = curve_numbers(run.equilibria, run.history, 1, Plane::strain);
    EXPECT_TRUE(numbers.net_locked);
    EXPECT_FALSE(numbers.peak_reached);
    EXPECT_NEAR(*numbers.peak_stress, strength_of_the_rock(20e6), 0.03 * strength_of_the_rock(20e6));
}

TEST(SlowNetLocking, SmoothJointsLeaveAPeak) {
    const SceneRun run =
        run_scene(intact_rock, {"interfaces.joint.friction_angle=15", "stages.1.stop_after_drop=20 %"});
    ASSERT_EQ(run.report.status, RunStatus::done);
    const CurveNumbers numbers = curve_numbers(run.equilibria, run.history, 1, Plane::strain);
    EXPECT_FALSE(numbers.net_locked);
    EXPECT_TRUE(numbers.peak_reached);
    EXPECT_EQ(*numbers.peak_stress, largest_stress(run));
    EXPECT_NEAR(*numbers.peak_stress, strength_of_the_rock(), 0.1 * strength_of_the_rock());
}

// Counted anew over the cracks that were told, whose places are the middles of their edges: 2.5 to 7.5 m of 10 m, or along
// the width 1.25 to 3.75 m of 5 m.
TEST(SlowNetLocking, BrokenShareIsThatOfTheMiddleHalfAlongTheLoad) {
    for (const bool upright : {true, false}) {
        const std::string boundary = upright ? "stages.1.strain.boundary=top" : "stages.1.strain.boundary=right";
        const SceneRun run = run_scene(intact_rock, {boundary, "stages.1.strain.value=0.25 %", "stages.1.steps=5"});
        const Gauges gauges = make_gauges(run.model);
        const double low = upright ? 2.5 : 1.25;
        const auto in_the_middle = [&](const CrackRecord& crack) {
            const double along = upright ? crack.y : crack.x;
            return along >= low && along <= 3.0 * low;
        };
        const auto broken = static_cast<double>(std::ranges::count_if(run.cracks, in_the_middle));
        ASSERT_GT(broken, 0.0);
        EXPECT_LT(broken, static_cast<double>(run.cracks.size()));
        EXPECT_NEAR(run.history.back().net_broken * static_cast<double>(gauges.middle_bonds.size()), broken, 1e-9);
        EXPECT_NEAR(static_cast<double>(gauges.middle_bonds.size()), 0.5 * run.model.system.n_interfaces(),
                    0.1 * run.model.system.n_interfaces());
    }
}

TEST(NetLocking, OnlyPotentialCracksOfTheNetCount) {
    const auto bonds = [](const std::vector<std::string>& changes) {
        const Model model = build_scene_model(read_scene_text(intact_rock, changes)).model;
        return make_gauges(model).middle_bonds.size();
    };
    EXPECT_GT(bonds({}), 0U);
    EXPECT_GT(bonds({"geometry.tessellation.region=[[0, 2], [5, 2], [5, 8], [0, 8]]"}), 0U);
    EXPECT_EQ(bonds({"geometry.tessellation.region=[[1, 3], [4, 3], [4, 7], [1, 7]]"}), 0U); // in solid rock
    EXPECT_EQ(bonds({"geometry.tessellation.interface=joint"}), 0U);
    EXPECT_EQ(bonds({"geometry.tessellation=null", "geometry.fractures=[{trace: [[0, 5], [5, 5]], interface: bond}]"}),
              0U);
}

} // namespace
} // namespace kluft

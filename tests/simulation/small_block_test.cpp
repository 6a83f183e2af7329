// A small block on a steep plane beside large ones that stand: verdict and factor of safety are its own, whatever stands
// beside it.
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

constexpr double small = 0.3; // m
constexpr double dip = 45.0 * std::numbers::pi / 180.0;

std::string polygon(double width, double height, double x, double y, double angle) {
    const auto corner = [&](double u, double v) {
        return fmt::format("[{:.15g}, {:.15g}]", x + u * std::cos(angle) - v * std::sin(angle),
                           y + u * std::sin(angle) + v * std::cos(angle));
    };
    return fmt::format("[{}, {}, {}, {}]", corner(0, 0), corner(width, 0), corner(width, height), corner(0, height));
}

/// Settings are the program's defaults. `size`: of each of the large blocks, which stand in a row on the ground (m).
std::string scene_beside(double size, int n, double friction_angle, const std::string& more_stages) {
    std::string blocks = fmt::format("    - {{name: plane, polygon: {}, support: fixed}}\n",
                                     polygon(4 * small, small, 0, -small * std::sqrt(2.0), dip));
    blocks += fmt::format("    - {{name: small, polygon: {}}}\n", polygon(1.5 * small, small / 1.5, 0, 0, dip));
    const double x = 10.0 * small;
    blocks += fmt::format("    - {{name: ground, polygon: {}, support: fixed}}\n",
                          polygon(1.2 * n * size, size, x, -size, 0));
    for (int i = 0; i < n; ++i)
        blocks += fmt::format("    - {{polygon: {}}}\n", polygon(size, size, x + (0.1 + 1.2 * i) * size, 0, 0));
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: [0, -9.81]}}
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: {}}}}}
geometry:
  blocks:
{}stages: [{{name: weight, steps: 5}}{}]
)",
                       friction_angle, blocks, more_stages);
}

class SmallBlock : public ::testing::TestWithParam<double> {};

TEST_P(SmallBlock, FallsBesideLargeOnesAboveItsFrictionAngle) {
    const SceneRun run = run_scene(scene_beside(GetParam(), 10, 30, ""));
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium) << run.report.diagnosis;
    ASSERT_EQ(run.report.falling.size(), 1U);
    EXPECT_EQ(run.report.falling.front().block, "small");
    EXPECT_NEAR(run.report.falling.front().direction.x(), -std::cos(dip), 0.02);
    EXPECT_NEAR(run.report.falling.front().direction.y(), -std::sin(dip), 0.02);
}

TEST_P(SmallBlock, StandsBelowIt) {
    const SceneRun run = run_scene(scene_beside(GetParam(), 10, 50, ""));
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_LE(run.history.back().balance_error, 1e-3);
}

// Limit equilibrium: F = tan phi/tan dip.
TEST_P(SmallBlock, HasItsOwnFactorOfSafety) {
    const SceneRun run = run_scene(scene_beside(
        GetParam(), 10, 50, ", {name: reduce, strength_reduction: {from: 1, to: 2, tolerance: 0.001}, steps: 10}"));
    ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
    const double expected = std::tan(50.0 * std::numbers::pi / 180.0) / std::tan(dip);
    EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 1e-3 * expected);
}

INSTANTIATE_TEST_SUITE_P(BesideBlocksOf, SmallBlock,
                         ::testing::Values(small, 10.0 * small, 100.0 * small, 1000.0 * small),
                         [](const auto& info) { return fmt::format("{:.0f}_times_its_size", info.param / small); });

/// A block on a plane of 30 degrees, whose ends are pressed along the plane. The plane is level and the weight leans.
SceneRun squeezed(double pressure, double friction_angle, const std::string& more_stages = "") {
    return run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: strain, gravity: [5, -8.660254037844386]}}
materials: {{rock: {{density: 2500, youngs_modulus: 50 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 2e10, shear_stiffness: 1e10, friction_angle: {}}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[-5, -10], [15, -10], [15, 0], [-5, 0]]}}
    - {{name: squeezed, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}}
boundaries:
  below: {{block: base, facing: bottom, support: fixed}}
  left: {{block: squeezed, facing: left}}
  right: {{block: squeezed, facing: right}}
stages: [{{pressure: {{left: {}, right: {}}}, steps: 1}}{}]
)",
                                 friction_angle, pressure, pressure, more_stages));
}

// Pressures that balance each other hide no fall: F = tan phi/tan dip.
TEST(SqueezedBlock, SlidesAsWithoutThePressuresThatBalanceEachOther) {
    for (const double pressure : {0.0, 1e6, 1e7, 1e8}) {
        EXPECT_EQ(squeezed(pressure, 5).report.status, RunStatus::no_equilibrium) << pressure;
        EXPECT_EQ(squeezed(pressure, 29).report.status, RunStatus::no_equilibrium) << pressure;
        EXPECT_TRUE(stands(squeezed(pressure, 31))) << pressure;
        const SceneRun run = squeezed(
            pressure, 40, ", {name: reduce, strength_reduction: {from: 1, to: 2, tolerance: 0.001}, steps: 10}");
        ASSERT_TRUE(run.report.results.factor_of_safety) << pressure;
        const double expected = std::tan(40.0 * std::numbers::pi / 180.0) * std::sqrt(3.0);
        EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 1e-3 * expected) << pressure;
    }
}

} // namespace
} // namespace kluft

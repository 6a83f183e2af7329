// Blocks that rock on a joint which is open over a part of its length, as on an elastic foundation without tension.
#include "kluft/simulation/rocking_joint.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double column_height = 4.0;
constexpr double half_of_column = 0.5;

/// A column 1 m wide and 4 m high on a fixed block, under a force (N/m) on its top at an eccentricity (m) from its axis.
SceneRun pressed_column(double normal_stiffness, const std::string& points, double force, double eccentricity) {
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: 1e14, poissons_ratio: 0}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: {:.17g}, shear_stiffness: 1e9, friction_angle: 60, contact_rounding: 0{}}}}}
geometry:
  reference_spacing: 1
  blocks:
    - {{name: base, polygon: [[-2, -1], [2, -1], [2, 0], [-2, 0]], support: fixed}}
    - {{name: column, polygon: [[-0.5, 0], [0.5, 0], [0.5, 4], [-0.5, 4]]}}
stages: [{{forces: {{P: {{block: column, point: [{:.17g}, 4], force: [0, {:.17g}]}}}}, steps: 20}}]
solver: {{balance: 1e-6}}
)",
                                 normal_stiffness, points, eccentricity, -force));
}

/// A strip of the length c = 3 (b/2 - e) carries the force at the eccentricity e, by statics; the rotation is 2 N/(k_n c^2).
double rotation_at(double normal_stiffness, double force, double eccentricity) {
    const double closed = 3.0 * (half_of_column - eccentricity);
    return 2.0 * force / (normal_stiffness * closed * closed);
}

/// The largest force for which e = e_0 + h rotation(e) has a solution.
double largest_force(double normal_stiffness, double eccentricity) {
    double largest = 0.0;
    for (double e = std::max(eccentricity, half_of_column / 3.0); e < half_of_column; e += 1e-5)
        largest = std::max(largest, (e - eccentricity) / (column_height * rotation_at(normal_stiffness, 1.0, e)));
    return largest;
}

double turn_of_column(const SceneRun& run) {
    const Eigen::VectorXd& q = run.state.body.displacement;
    const Mat2 gradient = deformation_gradient(q, 1, run.model.system.blocks[1].size);
    return std::abs(std::atan2(gradient(1, 0) - gradient(0, 1), gradient(0, 0) + gradient(1, 1)));
}

TEST(RockingJoint, TurnsAsOnAnElasticFoundationWithFifteenPoints) {
    const double normal_stiffness = 1e12, force = 1e6;
    for (const double eccentricity : {0.2, 0.25, 0.3, 0.35}) {
        const SceneRun run = pressed_column(normal_stiffness, ", overlap_points: 15", force, eccentricity);
        ASSERT_TRUE(stands(run)) << eccentricity << run.report.diagnosis;
        const double expected = rotation_at(normal_stiffness, force, eccentricity);
        EXPECT_NEAR(turn_of_column(run), expected, 0.02 * expected) << eccentricity;
    }
}

TEST(SlowRockingJoint, OfItsOwnStiffnessLosesTheColumn) {
    for (const double eccentricity : {0.2, 0.3}) {
        const double largest = largest_force(1e9, eccentricity);
        EXPECT_TRUE(stands(pressed_column(1e9, ", overlap_points: 15", 0.97 * largest, eccentricity))) << eccentricity;
        EXPECT_FALSE(stands(pressed_column(1e9, ", overlap_points: 15", 1.05 * largest, eccentricity))) << eccentricity;
    }
}

// With the hinge of three points the same column bears three times as much, and the program says so.
TEST(RockingJoint, HingeOnASoftJointIsWarnedOf) {
    const double eccentricity = 0.3;
    const double largest = largest_force(1e9, eccentricity);
    const SceneRun hinge = pressed_column(1e9, "", 1.5 * largest, eccentricity);
    ASSERT_TRUE(stands(hinge)) << hinge.report.diagnosis;
    EXPECT_THAT(rocking_joint_warning(hinge.model, hinge.state),
                AllOf(HasSubstr("'base' and 'column'"), HasSubstr("overlap_points: 15")));
    const SceneRun foundation = pressed_column(1e9, ", overlap_points: 15", 0.9 * largest, eccentricity);
    EXPECT_THAT(rocking_joint_warning(foundation.model, foundation.state), IsEmpty());
    const SceneRun stiff = pressed_column(1e13, "", largest, eccentricity);
    EXPECT_THAT(rocking_joint_warning(stiff.model, stiff.state), IsEmpty());
}

// What a load has of lever is 1 - shortfall of the half width where the column turns over: closed form of the same strip.
TEST(RockingJoint, ShortfallIsThatOfTheElasticFoundation) {
    const double eccentricity = 0.3;
    const SceneRun run = pressed_column(1e9, "", largest_force(1e9, eccentricity), eccentricity);
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    // The load is at the top and not in the centroid: rotation^(3/2) goes with 1/height, the shortfall with height^(1/3).
    const double of_the_load = softest_rocking_joint(run.model, run.state).shortfall * std::cbrt(2.0);
    EXPECT_NEAR(of_the_load, 1.0 - eccentricity / half_of_column, 0.02);
}

// Pushed to and fro between a floor and a ceiling, a block has dilated by more than its joints are pressed together:
// every point of them is closed, though further apart than as drawn.
TEST(RockingJoint, DilatedOneIsNotOpen) {
    const SceneRun run = run_scene(R"(kluft: 1
analysis: {plane: strain}
materials: {rock: {youngs_modulus: 1e14, poissons_ratio: 0}}
interfaces: {joint: {kind: fracture, friction_angle: 30, dilation_angle: 10, normal_stiffness: 1e9, shear_stiffness: 5e8}}
geometry:
  blocks:
    - {name: floor, polygon: [[-3, -1], [4, -1], [4, 0], [-3, 0]], support: fixed}
    - {name: block, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}
    - {name: ceiling, polygon: [[-3, 1], [4, 1], [4, 2], [-3, 2]], support: fixed}
stages:
  - {forces: {push: {block: block, point: [0, 0.5], force: [1e6, 0]}}, steps: 20}
  - {forces: {push: {force: [-1e6, 0]}}, steps: 40}
  - {forces: {push: {force: [1e6, 0]}}, steps: 40}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_THAT(rocking_joint_warning(run.model, run.state), IsEmpty());
}

} // namespace
} // namespace kluft

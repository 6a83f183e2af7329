#include "kluft/simulation/corner_contact.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A block of 1 m on a plane of 30 degrees, on which it would slide with a friction angle of 20, above a step in it.
SceneRun block_above_a_step(double height) {
    const std::string text = fmt::format(R"(kluft: 1
analysis: {{gravity: [-5, -8.660254]}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 40, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m}}}}
geometry:
  blocks:
    - {{name: plane, polygon: [[-2, -1], [3, -1], [3, 0], [0, 0], [0, {0}], [-2, {0}]], support: fixed}}
    - {{name: slab, polygon: [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]}}
stages: [{{steps: 1}}, {{strength_reduction: {{from: 1, to: {1}}}, steps: 1}}]
)",
                                         height, 2.305); // tan 40 over tan 20
    return run_scene(read_scene_text(text, {}, "step.yaml"));
}

// What the step carries beside friction: W (sin 30 - cos 30 tan 20) = 0.185 W.
TEST(CornerContact, ThatHoldsABlockIsWarnedOf) {
    const SceneRun corner = block_above_a_step(0.005);
    ASSERT_TRUE(stands(corner));
    const auto found = corner_contacts(corner.model, corner.state);
    ASSERT_EQ(found.size(), 1U);
    const double weight = 2600.0 * 0.5 * 10.0;
    EXPECT_NEAR(found[0].force, weight * (0.5 - std::cos(std::numbers::pi / 6.0) * std::tan(std::numbers::pi / 9.0)),
                0.01 * weight);
    EXPECT_NEAR(found[0].length, 0.005, 1e-6);
    EXPECT_EQ(found[0].held, 1);
    EXPECT_THAT(corner.report.warnings, Contains(AllOf(HasSubstr("a corner holds block 'slab'"),
                                                       HasSubstr("1 is the factor of the last load step before"))));
    const SceneRun ledge = block_above_a_step(0.05);
    ASSERT_TRUE(stands(ledge));
    EXPECT_THAT(corner_contacts(ledge.model, ledge.state), IsEmpty());
    EXPECT_THAT(ledge.report.warnings, Not(Contains(HasSubstr("corner"))));
}

// A tip of 50 degrees at the foot of a riser of 80: a point has no length, whatever part of the edge it stands for.
TEST(CornerContact, APointThatHoldsABlockIsWarnedOf) {
    const std::string text = R"(kluft: 1
analysis: {gravity: [-5, -8.660254]}
materials: {rock: {density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, friction_angle: 20, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m}}
geometry:
  blocks:
    - {name: plane, polygon: [[-2, -1], [3, -1], [3, 0], [0, 0], [-0.0353, 0.2], [-2, 0.2]], support: fixed}
    - {name: slab, polygon: [[0, 0], [1, 0], [1, 0.5], [0.41955, 0.5]]}
stages: [{steps: 1}]
)";
    const SceneRun run = run_scene(read_scene_text(text, {}, "tip.yaml"));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const auto found = corner_contacts(run.model, run.state);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].length, 0.0);
    EXPECT_THAT(corner_contact_warning(run.model, run.state),
                AllOf(HasSubstr("a corner holds block 'slab': its contact with block 'plane', a point at"),
                      HasSubstr("as at the toe of a block that turns over or where joints cross"))); // none cross here
}

/// A specimen of 1 m by 2.5 m with two joints through its middle, of 50 degrees one way and so many the other.
SceneRun crossing_joints(double angle) {
    const double slope = std::tan(angle * std::numbers::pi / 180.0);
    const std::string text = fmt::format(R"(kluft: 1
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 30, cohesion: 0.5 MPa}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 2.5}}}}
  fractures:
    - {{name: up, trace: [[-0.5, {}], [1.5, {}]]}}
    - {{name: down, trace: [[-0.5, {}], [1.5, {}]]}}
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{pressure: {{left: 1 MPa, right: 1 MPa, top: 1 MPa}}}}
  - {{strain: {{boundary: top, value: 0.2 %}}, steps: 10}}
)",
                                         1.25 - 1.191753593, 1.25 + 1.191753593, 1.25 + slope, 1.25 - slope);
    return run_scene(read_scene_text(text, {}, "crossing.yaml"));
}

// Where the joints cross exactly the tips of two wedges meet, and bear more than the joints do: Jaeger's plane of weakness has
// 1 MPa + 2 (0.5 MPa + 1 MPa tan 30)/((1 - tan 30/tan 50) sin 100) = 5.24 MPa.
TEST(CornerContact, OfWedgesThatMeetWithTheirTipsIsWarnedOf) {
    const SceneRun tips = crossing_joints(50.0);
    ASSERT_TRUE(stands(tips));
    EXPECT_GT(tips.history.back().axial_stress, 6e6);
    EXPECT_THAT(corner_contact_warning(tips.model, tips.state), HasSubstr("carry what rock would not"));
    const SceneRun beside = crossing_joints(49.9);
    ASSERT_TRUE(stands(beside));
    EXPECT_NEAR(beside.history.back().axial_stress, 5.24e6, 0.03e6);
    EXPECT_THAT(corner_contact_warning(beside.model, beside.state), IsEmpty());
}

} // namespace
} // namespace kluft

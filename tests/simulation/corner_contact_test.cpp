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

} // namespace
} // namespace kluft

// Supports that hold blocks back in tension.
#include "kluft/simulation/pulling_support.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A block on a plane that rises to the right at 20 degrees, between the sides of its body.
SceneRun block_on_plane(double friction_angle, const std::string& boundaries,
                        const std::vector<std::string>& overrides = {}) {
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{gravity: 10}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle: {}}}}}
geometry:
  domain: {{rectangle: {{width: 10, height: 10}}}}
  reference_spacing: 2
  fractures: [{{trace: [[-1, 3.636], [11, 8.003]], interface: joint}}]
boundaries: {{bottom: {{support: fixed}}, {}}}
stages: [{{steps: 2}}]
)",
                                 friction_angle, boundaries),
                     overrides);
}

// Without friction the support alone holds the block: P = W tan 20.
TEST(PullingSupport, OfABlockThatWouldSlideIsNamedWithItsForce) {
    const SceneRun run = block_on_plane(0.0, "right: {support: smooth}");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const double weight = 2600.0 * 10.0 * run.model.system.blocks[1].area;
    const PullingSupport found = strongest_pulling_support(run.model, run.state);
    EXPECT_EQ(found.block, 1);
    EXPECT_NEAR(found.force, weight * (8.003 - 3.636) / 12.0, 1e-3 * found.force);
    EXPECT_THAT(pulling_support_warning(run.model, run.state),
                AllOf(HasSubstr("'right' pulls block 1"), HasSubstr("in tension")));
}

// 300 m of rock below it weigh 70 times as much as the block, of 42 m2.
TEST(PullingSupport, IsToldWhateverLiesBelowTheJoint) {
    const SceneRun run = block_on_plane(
        0.0, "right: {support: smooth}",
        {"geometry.domain.rectangle.height=310", "geometry.fractures.0.trace=[[-1, 303.636], [11, 308.003]]"});
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_THAT(pulling_support_warning(run.model, run.state), HasSubstr("'right' pulls block 1"));
}

TEST(PullingSupport, MayBeAFixedOneOfABlockOnAJoint) {
    const SceneRun run = block_on_plane(0.0, "right: {support: fixed}");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_THAT(pulling_support_warning(run.model, run.state), HasSubstr("'right' pulls block 1"));
}

// A joint that is soft in shear leaves to the support what its friction could hold as well: tan 45 is more than twice tan 20.
TEST(PullingSupport, IsNoneWhereFrictionCouldHoldTheBlock) {
    const std::vector<std::string> soft{"interfaces.joint.shear_stiffness=1e8"};
    const SceneRun rough = block_on_plane(45.0, "right: {support: smooth}", soft);
    ASSERT_TRUE(stands(rough)) << rough.report.diagnosis;
    EXPECT_THAT(pulling_support_warning(rough.model, rough.state), IsEmpty());
    const SceneRun slippery = block_on_plane(10.0, "right: {support: smooth}", soft);
    ASSERT_TRUE(stands(slippery)) << slippery.report.diagnosis;
    EXPECT_THAT(pulling_support_warning(slippery.model, slippery.state), HasSubstr("'right' pulls block 1"));
}

/// Two cubes of 1 m on each other, with a gravity of (gravity_x, -10).
SceneRun two_cubes(double gravity_x, const std::string& support) {
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{gravity: [{}, -10]}}
materials: {{rock: {{density: 2500, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 60}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 2}}}}
  reference_spacing: 1
  fractures: [{{trace: [[-1, 1], [2, 1]], interface: joint}}]
boundaries: {{bottom: {{support: {}}}}}
stages: [{{steps: 2}}]
)",
                                 gravity_x, support));
}

// The weight of 50 kN/m acts at 1 m, and a push of g_x/10 of it: the resultant meets the base at 0.5 + g_x/10 m. At 9.5 that is
// 0.45 m beyond its right end, and the left one pulls with 50 x 0.45 kN/m. The upper cube alone turns over from 10 on.
TEST(PullingSupport, OfAStackThatWouldTurnOverIsNamed) {
    for (const char* support : {"fixed", "pinned"}) {
        const SceneRun run = two_cubes(9.5, support);
        ASSERT_TRUE(stands(run)) << run.report.diagnosis;
        const TurningPart found = strongest_turning_part(run.model, run.state);
        EXPECT_EQ(found.boundary, 0) << support;
        EXPECT_EQ(found.block, 0);
        EXPECT_EQ(found.n_blocks, 2);
        EXPECT_NEAR(found.beyond, 0.45, 1e-3);
        EXPECT_NEAR(found.force, 22.5e3, 50.0);
        EXPECT_THAT(pulling_support_warning(run.model, run.state),
                    AllOf(HasSubstr("'bottom' keeps block 0"), HasSubstr("from turning over"), HasSubstr("22.5 kN/m")));
    }
}

// At 4.5 the resultant is 0.05 m from the end of the base: the stack stands, though the left corner of its elastic foot, outside of the
// middle third, pulls.
TEST(PullingSupport, OfAStackThatStandsMayPullAtACorner) {
    const SceneRun run = two_cubes(4.5, "fixed");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_EQ(strongest_turning_part(run.model, run.state).boundary, -1);
    EXPECT_THAT(pulling_support_warning(run.model, run.state), IsEmpty());
    const SceneRun turning = two_cubes(5.5, "fixed"); // 0.05 m beyond it
    EXPECT_NEAR(strongest_turning_part(turning.model, turning.state).beyond, 0.05, 1e-3);
}

TEST(PullingSupport, IsNoneOfOneThatPresses) {
    const SceneRun pressed = block_on_plane(15.0, "left: {support: smooth}");
    ASSERT_TRUE(stands(pressed)) << pressed.report.diagnosis;
    EXPECT_THAT(pulling_support_warning(pressed.model, pressed.state), IsEmpty());
}

} // namespace
} // namespace kluft

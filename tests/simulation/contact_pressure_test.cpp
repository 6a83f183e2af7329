#include "kluft/simulation/contact_pressure.hpp"

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

/// A block 4 m wide at its top that stands on a foot in its middle, under a pressure on its top.
SceneRun block_on_a_foot(double foot, double pressure) {
    const std::string text = fmt::format(R"(kluft: 1
analysis: {{plane: stress}}
materials: {{steel: {{youngs_modulus: 2e13, poissons_ratio: 0}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e14, shear_stiffness: 1e14, friction_angle: 30}}}}
geometry:
  reference_spacing: 1
  blocks_interface: joint
  blocks:
    - {{name: floor, polygon: [[-3, -1], [3, -1], [3, 0], [-3, 0]], support: fixed}}
    - {{name: stool, polygon: [[{0}, 0], [{1}, 0], [2, 1], [-2, 1]]}}
boundaries: {{seat: {{block: stool, facing: top}}}}
stages: [{{pressure: {{seat: {2}}}, steps: 2}}]
)",
                                         -0.5 * foot, 0.5 * foot, pressure);
    return run_scene(read_scene_text(text, {}, "stool.yaml"));
}

TEST(ContactPressure, IsTheForceOverWhatTheBlocksShare) {
    const SceneRun run = block_on_a_foot(0.5, 1e6);
    ASSERT_TRUE(stands(run));
    const PressedContact found = largest_contact_pressure(run.model, run.state);
    EXPECT_NEAR(found.value, 4.0 / 0.5 * 1e6, 1e-3 * found.value); // statics
    EXPECT_EQ(found.block_a, 0);
    EXPECT_EQ(found.block_b, 1);
    EXPECT_LT((found.place - Vec2(0, 0)).norm(), 1e-3);
    EXPECT_EQ(largest_applied_stress(run.model, run.state), 1e6);
}

TEST(ContactPressure, IsWarnedOfAboveAHundredTimesTheLoad) {
    const SceneRun wide = block_on_a_foot(0.05, 1e6); // 80 times
    ASSERT_TRUE(stands(wide));
    EXPECT_THAT(contact_pressure_warning(wide.model, wide.state, 0.0), IsEmpty());
    const SceneRun narrow = block_on_a_foot(0.025, 1e6); // 160 times
    ASSERT_TRUE(stands(narrow));
    EXPECT_THAT(contact_pressure_warning(narrow.model, narrow.state, 0.0),
                AllOf(HasSubstr("blocks 'floor' and 'stool'"), HasSubstr("160 MPa, 160 times"), HasSubstr("(1 MPa)")));
    EXPECT_THAT(contact_pressure_warning(narrow.model, narrow.state, 2e6), IsEmpty()); // a platen presses that much
}

// Behind its peak, within one load step, a specimen carries nothing: what pressed it before is what its pieces are measured by.
TEST(ContactPressure, OfABodyThatHasShedItsLoadIsMeasuredByWhatItCarried) {
    SceneRun narrow = block_on_a_foot(0.025, 1e6); // 160 MPa
    for (const double carried : {1.5e6, 1.7e6}) {  // 107 and 94 times
        narrow.state.stresses.largest_axial = carried;
        EXPECT_EQ(contact_pressure_warning(narrow.model, narrow.state, 5e-3).empty(), 160e6 < 100.0 * carried);
    }
}

} // namespace
} // namespace kluft

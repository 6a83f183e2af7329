#include "kluft/simulation/cohesion_share.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// A slab, 4 m x 0.5 m, under 11.8 kPa of its own weight, on a joint of so much cohesion.
std::string warning_of_slab(const std::string& cohesion) {
    const SceneRun run = run_scene(fmt::format(R"(kluft: 1
analysis: {{gravity: 9.81}}
materials: {{concrete: {{density: 2400, youngs_modulus: 30 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 40, {}}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[-2, -1], [6, -1], [6, 0], [4, 0], [0, 0], [-2, 0]], support: fixed}}
    - {{name: slab, polygon: [[0, 0], [4, 0], [4, 0.5], [0, 0.5]]}}
stages: [{{name: weight}}]
)",
                                               cohesion));
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    return cohesion_share_warning(run.model, run.state);
}

// The onset is 20 kPa by default, of which 11.8 are 59 %; a cohesion of 1 MPa has its own at 10 kPa, and is there.
TEST(CohesionShare, OfAJointThatIsHardlyPressedIsWarnedOf) {
    EXPECT_THAT(warning_of_slab("cohesion: 2 MPa"),
                testing::HasSubstr("of the cohesion of 2 MPa (interfaces.<name>.cohesion) 59 % counts"));
    EXPECT_THAT(warning_of_slab("cohesion: 2 MPa, cohesion_onset: 1"), testing::IsEmpty());
    EXPECT_THAT(warning_of_slab("cohesion: 1 MPa"), testing::IsEmpty());
    EXPECT_THAT(warning_of_slab("cohesion: 0"), testing::IsEmpty());
}

} // namespace
} // namespace kluft

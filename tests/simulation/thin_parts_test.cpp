// Blocks with thin parts beside each other, and feet beside the end of a face: what lies behind a face is not touched by it.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/simulation/contact_following.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// 10 m by 10 m of rock under 5 MPa from above and 2 MPa from the sides, cut in two by the fractures.
SceneRun pressed_body(const std::string& fractures) {
    return run_scene(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 50 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 35, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m}}}}
geometry:
  domain: {{rectangle: {{width: 10, height: 10}}}}
  fractures: [{}]
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{steps: 10, pressure: {{left: 2 MPa, right: 2 MPa, top: 5 MPa}}}}]
)",
                                                 fractures)));
}

double largest_block_stress(const SceneRun& run) {
    double largest = 0.0;
    for (const Mat2& stress : run.fields.back().stress) largest = std::max(largest, stress.cwiseAbs().maxCoeff());
    return largest;
}

// The steps of the joint are small beside the body: its two blocks have the pressure of the loads.
TEST(ThinParts, OfALappedJointCarryThePressureOfTheLoads) {
    for (const double half : {0.003, 0.03, 0.3}) {
        const SceneRun run = pressed_body(
            fmt::format("{{trace: [[-1, {0}], [6, {0}], [6, 5], [4, 5], [4, {1}], [11, {1}]], interface: joint}}",
                        5.0 - half, 5.0 + half));
        ASSERT_TRUE(stands(run)) << half;
        EXPECT_EQ(contacts_anew_warning(run.model, run.state),
                  ""); // pressed into the notch, a corner had the back of the other part on it
        EXPECT_NEAR(largest_block_stress(run), 5e6, 0.01 * 5e6) << half;
    }
}

TEST(ThinParts, OfTwoJointsLinkedInTheirOverlapCarryThePressureOfTheLoads) {
    for (const double apart : {0.006, 0.06, 0.2}) {
        const SceneRun run = pressed_body(fmt::format("{{trace: [[-1, 5], [6, 5]], interface: joint}}, "
                                                      "{{trace: [[6, 5], [4, {0}]], interface: joint}}, "
                                                      "{{trace: [[4, {0}], [11, {0}]], interface: joint}}",
                                                      5.0 + apart));
        ASSERT_TRUE(stands(run)) << apart;
        EXPECT_NEAR(largest_block_stress(run), 5e6, 0.01 * 5e6) << apart;
    }
}

/// How far a table moves that is pressed down by 50 kN/m and has a pointed foot at x = 0.95 m on a block of so much width.
double motion_of_table(double width_of_base) {
    const SceneRun run = run_scene(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 45, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m}}}}
geometry:
  blocks_interface: joint
  blocks:
    - {{polygon: [[0, 0], [{0}, 0], [{0}, 1], [0, 1]], support: fixed}}
    - {{polygon: [[2, 0], [3, 0], [3, 1], [2, 1]], support: fixed}}
    - {{name: table, polygon: [[0.95, 1], [1.789, 2], [2.4, 2], [2.4, 1], [2.6, 1], [2.6, 3], [1.0375, 3], [1.0375, 2]]}}
stages: [{{steps: 10, forces: {{f: {{block: table, point: [1.7, 2.5], force: [0, -50000]}}}}}}]
)",
                                                               width_of_base)));
    EXPECT_TRUE(stands(run)) << width_of_base;
    return run.state.body.displacement.segment<2>(12).norm();
}

// The closure of a corner counts with the length of the face that it stands on, 4 % here.
TEST(ThinParts, AFootBesideTheEndOfAFaceStandsAsOneInItsMiddle) {
    const double in_the_middle = motion_of_table(1.9);
    EXPECT_LT(in_the_middle, 1e-5);
    for (const double width : {1.0, 0.96, 0.952})
        EXPECT_NEAR(motion_of_table(width), in_the_middle, 0.1 * in_the_middle);
}

} // namespace
} // namespace kluft

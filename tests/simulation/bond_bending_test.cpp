#include "kluft/simulation/bond_bending.hpp"

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

/// A row of bonded blocks of 1 m, 2600 kg/m3, that hangs from a wall. The bonds have a tensile strength of 1 MPa.
SceneRun row_of_blocks(int n) {
    std::string blocks;
    for (int i = 0; i < n; ++i)
        blocks += fmt::format("    - {{name: b{0}, polygon: [[{0}, 0], [{1}, 0], [{1}, 1], [{0}, 1]]}}\n", i, i + 1);
    const std::string text = fmt::format(R"(kluft: 1
analysis: {{gravity: [0, -10], kinematics: rigid}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25, cohesion: 3 MPa, friction_angle: 40, tensile_strength: 1 MPa}}}}
interfaces:
  bond: {{kind: potential_crack, fails_to: crack, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}}
  crack: {{kind: fracture, friction_angle: 30, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}}
geometry:
  blocks_interface: bond
  blocks:
    - {{name: wall, polygon: [[-2, -1], [0, -1], [0, 2], [-2, 2]], support: fixed}}
{}stages: [{{steps: 2}}]
cracks: {{criterion: interface_traction}}
)",
                                         blocks);
    return run_scene(read_scene_text(text, {}, "row.yaml"));
}

// The fibre stress of a cantilever, 3 rho g L^2/h: 7.8 MPa at 10 m, 1.95 MPa at 5 m.
TEST(BondBending, OfGivenBlocksIsWarnedOf) {
    const SceneRun longer = row_of_blocks(10);
    ASSERT_TRUE(stands(longer));
    EXPECT_THAT(bond_bending_warning(longer.model, longer.state),
                AllOf(HasSubstr("'wall'"), HasSubstr("'b0'"), HasSubstr("7.8 MPa, 7.8 times its tensile strength")));
    const SceneRun shorter = row_of_blocks(5);
    ASSERT_TRUE(stands(shorter));
    EXPECT_THAT(bond_bending_warning(shorter.model, shorter.state), IsEmpty());
}

} // namespace
} // namespace kluft

#include "kluft/simulation/bond_bending.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/simulation/simulation.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A row of bonded blocks of 1 m, 2600 kg/m3, that hangs from a wall. The bonds have a tensile strength of 1 MPa, that of the rock
/// 'weak' of 1 kPa.
SceneRun row_of_blocks(int n, const std::string& others = "") {
    std::string blocks = others;
    for (int i = 0; i < n; ++i)
        blocks += fmt::format("    - {{name: b{0}, polygon: [[{0}, 0], [{1}, 0], [{1}, 1], [{0}, 1]]}}\n", i, i + 1);
    const std::string text = fmt::format(R"(kluft: 1
analysis: {{gravity: [0, -10], kinematics: rigid}}
materials:
  rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25, cohesion: 3 MPa, friction_angle: 40, tensile_strength: 1 MPa}}
  weak: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25, cohesion: 3 MPa, friction_angle: 40, tensile_strength: 1 kPa}}
interfaces:
  bond: {{kind: potential_crack, fails_to: crack, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}}
  crack: {{kind: fracture, friction_angle: 30, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}}
geometry:
  material: rock
  blocks_interface: bond
  blocks:
    - {{name: wall, polygon: [[-2, -1], [0, -1], [0, 2], [-2, 2]], support: fixed}}
{}stages: [{{steps: 2}}]
cracks: {{criterion: interface_traction}}
)",
                                         blocks);
    return run_scene(read_scene_text(text, {}, "row.yaml"));
}

/// Of a run whose load steps are followed.
std::string bending_warning(const SceneRun& run) {
    BendingWatch watch(run.model);
    watch.step(run.history.back(), run.state);
    return watch.warning();
}

// The fibre stress of a cantilever, 3 rho g L^2/h: 7.8 MPa at 10 m, 1.25 MPa at 4 m, 0.70 MPa at 3 m.
TEST(BondBending, OfGivenBlocksIsWarnedOf) {
    const SceneRun longer = row_of_blocks(10);
    ASSERT_TRUE(stands(longer));
    EXPECT_THAT(bending_warning(longer),
                AllOf(HasSubstr("'wall'"), HasSubstr("'b0'"), HasSubstr("7.8 MPa, 7.8 times its tensile strength")));
    EXPECT_THAT(bending_warning(row_of_blocks(4)), HasSubstr("1.25 MPa, 1.25 times its tensile strength"));
    const SceneRun shorter = row_of_blocks(3);
    ASSERT_TRUE(stands(shorter));
    EXPECT_THAT(bending_warning(shorter), IsEmpty());
}

// The bond of a single block on the other side of the wall has 3 rho g L^2/h = 78 kPa on its 1 kPa.
TEST(BondBending, IsThatOfTheBondMostOverItsStrength) {
    const SceneRun run =
        row_of_blocks(10, "    - {name: weak, polygon: [[-3, 0], [-2, 0], [-2, 1], [-3, 1]], material: weak}\n");
    ASSERT_TRUE(stands(run));
    EXPECT_THAT(bending_warning(run), AllOf(HasSubstr("'weak'"), HasSubstr("78 times its tensile strength")));
}

TEST(BondBending, IsThatOfTheWholeRun) {
    const SceneRun run = row_of_blocks(10);
    ASSERT_TRUE(stands(run));
    BendingWatch watch(run.model);
    watch.step(run.history.back(), run.state);
    watch.step({.step = 3}, initial_state(run.model));
    EXPECT_THAT(watch.warning(), HasSubstr("in load step 2"));
}

// Along a bonded trace a specimen between smooth platens has no stress across it, only round-off.
TEST(BondBending, IsNotWhatRoundOffLeavesOnABondWithoutTensileStrength) {
    const SceneRun run = run_scene(R"(kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 20 GPa, poissons_ratio: 0.25, cohesion: 10 MPa, friction_angle: 40, tensile_strength: 0}}
interfaces:
  bond: {kind: potential_crack, fails_to: crack, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}
  crack: {kind: fracture, friction_angle: 30, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  fractures: [{trace: [[0.4, -1], [0.4, 3]], interface: bond}]
boundaries: {bottom: {support: pinned}, top: {}}
stages: [{strain: {boundary: top, value: 0.01 %}, steps: 5}]
cracks: {criterion: interface_traction}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_THAT(bending_warning(run), IsEmpty());
}

// A column of 1 m by 5 m on a bonded trace, without a net, under 0.4 g from the side: the fibre stress at its foot is
// rho H (6 a H/2/b - g) with b = 1 m, 2500*5*(0.4*9.81*15 - 9.81) = 613 kPa.
TEST(BondBending, OfATraceWithoutANetIsWarnedOf) {
    const SceneRun run = run_scene(R"(kluft: 1
analysis: {gravity: [3.924, -9.81], kinematics: rigid}
materials: {rock: {density: 2500, youngs_modulus: 20 GPa, poissons_ratio: 0.25, cohesion: 1 MPa, friction_angle: 40, tensile_strength: 100 kPa}}
interfaces:
  bond: {kind: potential_crack, fails_to: crack, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}
  crack: {kind: fracture, friction_angle: 30, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m}
geometry:
  domain: {polygon: [[0, -1], [1, -1], [1, 0], [1, 5], [0, 5], [0, 0]]}
  fractures: [{trace: [[-0.5, 0], [1.5, 0]], interface: bond}]
boundaries: {bottom: {sides: [0], support: fixed}}
stages: [{steps: 2}]
cracks: {criterion: interface_traction}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_THAT(bending_warning(run),
                AllOf(HasSubstr("blocks 0 and 1 bends"), HasSubstr("0.613 MPa, 6.13 times its tensile strength")));
}

} // namespace
} // namespace kluft

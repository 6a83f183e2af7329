#include "kluft/simulation/fallen_blocks.hpp"

#include <string>
#include <vector>

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

// A slab of 1.5 m lies on a pedestal by 0.74 m of its length, less than half: it tips over the edge and comes to lean on the floor,
// 0.5 m below, where it is balanced. As cut it does not stand with any strength.
const std::string overhanging_slab = R"(kluft: 1
analysis: {gravity: 10}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 40}}
geometry:
  blocks_interface: joint
  blocks:
    - {name: floor, polygon: [[-2, -1], [5, -1], [5, 0], [-2, 0]], support: fixed}
    - {name: pedestal, polygon: [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]}
    - {name: slab, polygon: [[0.26, 0.5], [1.76, 0.5], [1.76, 1.0], [0.26, 1.0]]}
stages:
  - {steps: 1}
  - {strength_reduction: {from: 1, to: 5}, steps: 4}
)";
const std::vector<std::string> on_its_middle = {
    "geometry.blocks.2.polygon=[[0.2, 0.5], [1.7, 0.5], [1.7, 1.0], [0.2, 1.0]]"};

TEST(FallenBlocks, BodyThatHasFallenBeforeHasNoFactorOfSafety) {
    const SceneRun run = run_scene(overhanging_slab);
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_FALSE(run.report.results.factor_of_safety);
    EXPECT_THAT(run.report.diagnosis, AllOf(HasSubstr("has given way under its loads"), HasSubstr("'slab'"),
                                            HasSubstr("its factor of safety is below stages.")));
}

// The same without a neighbour: it lies a tenth of a millimetre above the pedestal.
TEST(FallenBlocks, BlockThatLiesOnNothingAsCutHasFallenToo) {
    const SceneRun run =
        run_scene(overhanging_slab,
                  {"geometry.blocks.2.polygon=[[0.26, 0.5001], [1.76, 0.5001], [1.76, 1.0001], [0.26, 1.0001]]"});
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_FALSE(run.report.results.factor_of_safety);
    EXPECT_THAT(run.report.diagnosis, AllOf(HasSubstr("has given way under its loads"), HasSubstr("'slab'"),
                                            HasSubstr("its factor of safety is below stages.")));
}

// Held by friction alone it stands up to any factor, since nothing pushes it sideways.
TEST(FallenBlocks, BodyThatStandsHasAFactorOfSafety) {
    const SceneRun run = run_scene(overhanging_slab, on_its_middle);
    EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_THAT(run.report.warnings, Contains(HasSubstr("the factor of safety is above 5")));
    EXPECT_THAT(run.report.warnings, Not(Contains(HasSubstr("gave way"))));
}

TEST(FallenBlocks, AreWarnedOfAtTheEndOfTheStage) {
    const SceneRun run = run_scene(overhanging_slab, {"stages=[{steps: 1}]"});
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_THAT(run.report.warnings, Contains(AllOf(HasSubstr("gave way under the loads of stage 0"),
                                                    HasSubstr("'slab'"), HasSubstr("has turned by"))));
    State without_jump = run.state;
    without_jump.jumps = 0;
    const Eigen::VectorXd as_cut = Eigen::VectorXd::Zero(run.state.body.displacement.size());
    EXPECT_THAT(description_of_fall(run.model, as_cut, without_jump), IsEmpty());
}

} // namespace
} // namespace kluft

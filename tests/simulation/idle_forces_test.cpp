#include "kluft/simulation/idle_forces.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A dam on rock, pushed by its water at a point of the block with that name; `support` of the rock.
std::string dam(const std::string& block, const std::string& point, const std::string& support,
                const std::string& boundaries = "{}") {
    return fmt::format(R"(kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2400, youngs_modulus: 25 GPa, poissons_ratio: 0.2}}}}
interfaces: {{contact: {{kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 45}}}}
geometry:
  blocks:
    - {{name: rock, polygon: [[-50, -50], [150, -50], [150, 0], [80, 0], [0, 0], [-50, 0]], support: {}}}
    - {{name: dam, polygon: [[0, 0], [80, 0], [0, 100]]}}
boundaries: {}
stages:
  - {{name: weight}}
  - {{name: water, forces: {{water: {{block: {}, point: {}, force: [50 MN/m, 0]}}}}}}
)",
                       support, boundaries, block, point);
}

std::vector<std::string> warnings_of_dam(const std::string& scene) {
    return build_scene_model(read_scene_text(scene, {}, "dam.yaml")).model.warnings;
}

const auto told = Contains(HasSubstr("has no effect: it acts on block 'rock'"));

TEST(IdleForces, OnAFixedBlockAreToldOfWithTheirPlace) {
    EXPECT_THAT(warnings_of_dam(dam("rock", "[0, -10]", "fixed")),
                Contains(AllOf(testing::StartsWith("dam.yaml:12:"), HasSubstr("stages.1.forces.water: has no effect"),
                               HasSubstr("acts on block 'rock', which is fixed"))));
    EXPECT_THAT(warnings_of_dam(dam("dam", "[0, 30]", "fixed")), Not(Contains(HasSubstr("has no effect"))));
}

// Three corners that do not lie in one line hold an affine block altogether; two leave it two strains, which a force changes.
TEST(IdleForces, OnABlockThatSupportsHoldAltogetherAreToldOf) {
    EXPECT_THAT(warnings_of_dam(dam("rock", "[0, -10]", "none",
                                    "{bottom: {block: rock, facing: bottom, support: fixed}, "
                                    "right: {block: rock, facing: right, support: fixed}}")),
                told);
    EXPECT_THAT(
        warnings_of_dam(dam("rock", "[0, -10]", "none", "{bottom: {block: rock, facing: bottom, support: fixed}}")),
        Not(told));
}

// The statement itself: displacements with and without the force are the same.
TEST(IdleForces, ChangeNoDisplacement) {
    const SceneRun with = run_scene(read_scene_text(dam("rock", "[0, -10]", "fixed")));
    const SceneRun without =
        run_scene(read_scene_text(dam("rock", "[0, -10]", "fixed"), {"stages.1.forces.water.force=[0, 0]"}));
    EXPECT_THAT(without.model.warnings, Not(told));
    EXPECT_EQ(with.state.body.displacement, without.state.body.displacement);
}

} // namespace
} // namespace kluft

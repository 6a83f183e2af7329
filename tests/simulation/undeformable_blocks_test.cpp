#include "kluft/simulation/undeformable_blocks.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A body of 10 m x 10 m on a floor of two sides, the tip between them at a height of `tip`, under a joint at 6 m; its sides as given.
std::string body_on_a_bent_floor(double tip, const std::string& boundaries) {
    return fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 35}}}}
geometry:
  domain: {{polygon: [[0, 0], [5, {}], [10, 0], [10, 10], [0, 10]]}}
  reference_spacing: 5 m
  fractures: [{{trace: [[-1, 6], [11, 6]], interface: joint}}]
boundaries: {}
stages: [{{pressure: {{top: 5 MPa}}, steps: 1}}]
)",
                       tip, boundaries);
}

std::string all_sides(const std::string& floor, const std::string& wall) {
    return fmt::format(
        "{{floor: {{sides: [0, 1], support: {}}}, right: {{sides: [2], support: {}}}, top: {{sides: [3]}}, "
        "left: {{sides: [4], support: {}}}}}",
        floor, wall, wall);
}

std::vector<int> of(double tip, const std::string& boundaries) {
    return undeformable_blocks(build_scene_model(read_scene_text(body_on_a_bent_floor(tip, boundaries))).model);
}

// Three corners that do not lie in one line hold an affine block altogether; two, or three in one line, leave it two strains.
TEST(UndeformableBlocks, AreThoseWhoseHeldCornersDoNotLieInOneLine) {
    EXPECT_THAT(of(-0.5, all_sides("fixed", "none")), testing::SizeIs(1));
    EXPECT_THAT(of(0.0, all_sides("fixed", "none")), IsEmpty());
    EXPECT_THAT(of(-0.5, all_sides("smooth", "none")), IsEmpty());
    EXPECT_THAT(of(0.0, all_sides("fixed", "smooth")), IsEmpty()); // it still shortens between its walls
}

// One block between smooth walls on a smooth floor has the strain that its platen prescribes, and 24 MPa.
TEST(UndeformableBlocks, AreNotThoseThatAPlatenStrains) {
    const auto warnings = [](const std::string& platens) {
        return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
geometry: {{domain: {{rectangle: {{width: 1, height: 1}}}}}}
boundaries: {{bottom: {{support: smooth}}, left: {{support: smooth}}, right: {{support: smooth}}}}
stages: [{{strain: {{boundary: top, value: 0.1 %}}, platens: {}}}]
)",
                                                             platens)))
            .model.warnings;
    };
    EXPECT_THAT(warnings("smooth"), Not(Contains(HasSubstr("cannot deform"))));
    EXPECT_THAT(warnings("rough"), Not(Contains(HasSubstr("cannot deform"))));
}

// The block below the joint has 62.5 of 102.5 m2 and its middle at x = 5; its stress stays 0 under 5 MPa.
TEST(UndeformableBlocks, AreToldOfWithTheirShareOfTheArea) {
    const SceneRun run = run_scene(body_on_a_bent_floor(-0.5, all_sides("fixed", "none")));
    EXPECT_THAT(run.model.warnings, Contains(AllOf(HasSubstr("cannot deform"), HasSubstr("61 % of the body's area"),
                                                   HasSubstr("at (5, "), HasSubstr("stress 0 is written"))));
    const int held = undeformable_blocks(run.model).front();
    EXPECT_EQ(run.fields.back().stress[static_cast<std::size_t>(held)].norm(), 0.0);
}

TEST(UndeformableBlocks, AreNoneOfRigidKinematicsAndNoFixedBlocks) {
    const std::string text = body_on_a_bent_floor(-0.5, all_sides("fixed", "none"));
    EXPECT_THAT(undeformable_blocks(build_scene_model(read_scene_text(text, {"analysis.kinematics=rigid"})).model),
                IsEmpty());
    const Model model = build_scene_model(read_scene_text(R"(
kluft: 1
materials: {rock: {density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 35}}
geometry:
  blocks:
    - {name: ground, polygon: [[0, 0], [2, 0], [2, 1], [0, 1]], support: fixed}
    - {name: block, polygon: [[0, 1], [2, 1], [2, 2], [0, 2]]}
  blocks_interface: joint
analysis: {gravity: 9.81}
stages: [{steps: 1}]
)"))
                            .model;
    EXPECT_THAT(undeformable_blocks(model), IsEmpty());
}

// Of a body of 100 m2 a foot of 0.5 m2 is less than a hundredth, one of 2 m2 is more.
TEST(UndeformableBlocks, OfLittleAreaAreNotToldOf) {
    const auto warnings = [](double width) {
        return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 35}}}}
geometry:
  blocks:
    - {{name: foot, polygon: [[0, -1], [{0}, -1], [{0}, 0], [0, 0]]}}
    - {{name: body, polygon: [[0, 0], [10, 0], [10, 10], [0, 10]]}}
  blocks_interface: joint
boundaries: {{foot: {{block: foot, sides: [0, 1], support: fixed}}, top: {{block: body, sides: [2]}}}}
stages: [{{pressure: {{top: 1 MPa}}}}]
)",
                                                             width)))
            .model.warnings;
    };
    EXPECT_THAT(warnings(0.5), Not(Contains(HasSubstr("cannot deform"))));
    EXPECT_THAT(warnings(2.0), Contains(HasSubstr("block 'foot' at (1, -0.5) cannot deform")));
}

} // namespace
} // namespace kluft

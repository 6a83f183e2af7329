#include "kluft/simulation/rock_constants.hpp"

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

/// Of a specimen of 1 m x 1 m with a joint along its middle, its boundaries and what the stage has besides the platen on its top.
std::string warning_of(const std::string& boundaries, const std::string& of_stage) {
    return elastic_constants_warning(build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 35}}}}
geometry:
  domain: {{rectangle: {{width: 1, height: 1}}}}
  reference_spacing: 0.5
  fractures: [{{trace: [[-1, 0.5], [2, 0.5]], interface: joint}}]
boundaries: {}
stages: [{{strain: {{boundary: top, value: 0.1 %}}{}}}]
)",
                                                                                   boundaries, of_stage)))
                                         .model);
}

TEST(RockConstants, FollowFromATestBetweenSmoothPlatens) {
    EXPECT_EQ(warning_of("{}", ""), "");
    EXPECT_EQ(warning_of("{bottom: {support: smooth}}", ""), "");
    EXPECT_EQ(warning_of("{bottom: {support: pinned}}", ", pressure: {left: 1 MPa, right: 1 MPa}"), "");
    EXPECT_EQ(warning_of("{left: {support: smooth}}", ""), ""); // a plane of symmetry
}

// A block that platens stick to cannot widen there, one between rollers not at all: its E is E/(1 - nu^2) or more.
TEST(RockConstants, DoNotFollowFromATestThatHoldsTheBodyOtherwise) {
    EXPECT_THAT(warning_of("{}", ", platens: rough"),
                AllOf(HasSubstr("youngs_modulus and poissons_ratio"), HasSubstr("the platen on 'top' rubs")));
    EXPECT_THAT(warning_of("{}", ", platens: {friction_angle: 5}"), HasSubstr("the platen on 'top' rubs"));
    EXPECT_THAT(warning_of("{bottom: {support: fixed}}", ""),
                HasSubstr("the platen on 'bottom', whose support is fixed"));
    EXPECT_THAT(warning_of("{left: {support: smooth}, right: {support: smooth}}", ""),
                HasSubstr("the support of 'left', 'right' holds"));
    EXPECT_THAT(warning_of("{left: {support: pinned}}", ""), HasSubstr("the support of 'left' holds"));
}

TEST(RockConstants, OfAPlatenOnAPartOfTheBodyAreInItsWarning) {
    const Model model = build_scene_model(read_scene_text(R"(
kluft: 1
materials: {rock: {density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 20 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 30}}
geometry:
  domain: {polygon: [[0, 0], [4, 0], [4, 1], [4, 2], [0, 2], [0, 1]]}
  reference_spacing: 1 m
  fractures: [{trace: [[-1, 1], [5, 1]], interface: joint}]
boundaries: {bottom: {sides: [0], support: fixed}, rl: {sides: [1]}, ru: {sides: [2]}, top: {sides: [3]}, lu: {sides: [4]}, ll: {sides: [5]}}
stages: [{pressure: {top: 1 MPa}}, {displacement: {boundary: lu, value: 2 mm}, steps: 20}]
)"))
                            .model;
    EXPECT_EQ(elastic_constants_warning(model), "");
    EXPECT_THAT(model.warnings,
                Contains(AllOf(HasSubstr("over the width of the body"), HasSubstr("are not the rock's"))));
}

/// Of a body between smooth platens on its top and on its bottom.
Model body_of(const std::string& polygon, const char* moved = "top") {
    return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2650, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
geometry: {{domain: {{polygon: [{}]}}}}
stages: [{{strain: {{boundary: {}, value: 0.1 %}}}}]
)",
                                                         polygon, moved)))
        .model;
}

void expect_no_constants(const std::string& polygon, const char* why) {
    const Model model = body_of(polygon);
    EXPECT_FALSE(has_elastic_constants(model)) << polygon;
    EXPECT_THAT(elastic_constants_warning(model), AllOf(HasSubstr("are null"), HasSubstr(why)));
}

// A trapezoid of E = 10 GPa had 7.5 GPa where its wide end was moved, and a warning where its narrow one was.
TEST(RockConstants, DoNotDependOnWhichEndIsMoved) {
    for (const char* trapezoid :
         {"[0, 0], [0.2, 0], [0.15, 0.2], [0.05, 0.2]", "[0.05, 0], [0.15, 0], [0.2, 0.2], [0, 0.2]"}) {
        for (const char* moved : {"top", "bottom"}) {
            const Model model = body_of(trapezoid, moved);
            EXPECT_FALSE(has_elastic_constants(model));
            const bool is_said = !elastic_constants_warning(model).empty();
            const bool is_warned_of = !model.warnings.empty(); // of the narrow end
            EXPECT_NE(is_said, is_warned_of) << trapezoid << moved;
        }
    }
}

// Spikes, raised corners, a steep notch and leaning sides gave a rock of 10 GPa and 0.25 from 7.9 to 11.3 GPa and 0.07 to 0.40.
TEST(RockConstants, DoNotFollowFromABodyOfAnotherShape) {
    expect_no_constants("[0, 0], [0.1, 0], [0.1, 0.1], [0.054, 0.1], [0.05, 0.105], [0.046, 0.1], [0, 0.1]",
                        "stands out by 0.005 m beyond what the platen on 'top'");
    expect_no_constants("[0, 0], [0.1, 0], [0.1, 0.13], [0.09, 0.1], [0, 0.1]", "stands out by 0.03 m");
    expect_no_constants("[0, 0], [0.04, 0], [0.05, -0.03], [0.06, 0], [0.1, 0], [0.1, 0.2], [0, 0.2]",
                        "stands out by 0.03 m beyond what the platen on 'bottom'");
    expect_no_constants("[0, 0], [0.1, 0], [0.15, 0.2], [0.05, 0.2]", "lean by 14 degrees");
    const Model notched = body_of("[0, 0], [0.1, 0], [0.1, 0.2], [0.06, 0.2], [0.05, 0.17], [0.04, 0.2], [0, 0.2]");
    EXPECT_FALSE(has_elastic_constants(notched));
    EXPECT_THAT(notched.warnings, Contains(HasSubstr("not over its own 0.08 m")));
}

// A spike of 1 % of the height changes E by 0.6 %, sides that lean by 3 degrees by 1 %.
TEST(RockConstants, FollowFromABodyThatIsNearlyASpecimen) {
    for (const char* polygon : {"[0, 0], [0.1, 0], [0.1, 0.1], [0.0505, 0.1], [0.05, 0.101], [0.0495, 0.1], [0, 0.1]",
                                "[0, 0], [0.1, 0], [0.11, 0.2], [0.01, 0.2]"}) {
        const Model model = body_of(polygon);
        EXPECT_TRUE(has_elastic_constants(model));
        EXPECT_EQ(elastic_constants_warning(model), "");
        EXPECT_TRUE(model.warnings.empty());
    }
}

TEST(RockConstants, AreNoneWithoutAPlaten) {
    EXPECT_EQ(elastic_constants_warning(build_scene_model(read_scene_text(R"(
kluft: 1
materials: {rock: {density: 2650, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
geometry: {domain: {rectangle: {width: 1, height: 1}}}
boundaries: {bottom: {support: fixed}}
stages: [{pressure: {top: 1 MPa}}]
)"))
                                            .model),
              "");
}

} // namespace
} // namespace kluft

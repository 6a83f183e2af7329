#include "kluft/scene/scene_model.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A body of 1 m by 2 m with triangles of 0.2 m, which resolve 0.05 x 0.2 = 0.01 m.
const std::string body_of_triangles = R"(kluft: 1
materials: {rock: {youngs_modulus: 5 GPa, poissons_ratio: 0.25, cohesion: 5 MPa, friction_angle: 40, tensile_strength: 2 MPa}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 500 GPa/m, shear_stiffness: 250 GPa/m, friction_angle: 30}
  bond: {kind: potential_crack, fails_to: crack}
  crack: {kind: fracture, friction_angle: 35}
geometry:
  domain: {polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}
  fractures: [{name: main, trace: [[0, 1], [1, 1]], interface: joint}]
  tessellation: {triangles: {spacing: 0.2}, interface: bond}
stages: [{pressure: {top: 1 MPa}}]
boundaries: {bottom: {support: fixed}}
)";

std::vector<std::string> warnings_of(const std::vector<std::string>& overrides) {
    return build_scene_model(read_scene_text(body_of_triangles, overrides, "scene.yaml")).model.warnings;
}

std::string refusal_of(const std::vector<std::string>& overrides) {
    const auto messages = test::messages_of(
        [&] { return build_scene_model(read_scene_text(body_of_triangles, overrides, "scene.yaml")); });
    return messages.empty() ? "" : messages.front();
}

// A pressed face at which a joint comes out: as that of a dam's lake, where the body has weight.
TEST(SceneModel, WarnsOfPressuresThatDoNotEnterJoints) {
    const auto warnings = [](const std::string& pressure, const std::string& gravity) {
        return warnings_of({"stages=[" + pressure + "]", "analysis.gravity=" + gravity, "materials.rock.density=2500",
                            "boundaries={bottom: {support: fixed}, left: {}, top: {}}"});
    };
    EXPECT_THAT(warnings("{pressure: {left: 1 kPa}}", "9.81"),
                Contains(AllOf(HasSubstr("stages.0.pressure.left: "), HasSubstr("joints that come out there (1)"),
                               HasSubstr("water would press in them as well"))));
    EXPECT_THAT(warnings("{}, {pressure: {left: 1 kPa}}", "9.81"), Contains(HasSubstr("stages.1.pressure.left")));
    EXPECT_THAT(warnings("{pressure: {left: 1 kPa}}", "0"), Not(Contains(HasSubstr("water"))));
    EXPECT_THAT(warnings("{pressure: {top: 1 kPa}}", "9.81"), Not(Contains(HasSubstr("water"))));
    EXPECT_THAT(warnings("{pressure: {left: 0}}", "9.81"), Not(Contains(HasSubstr("water"))));
}

// What only the body shows to be wrong has its place in the scene, too: that of the key, of the mapping that lacks it, or the override.
TEST(SceneModel, WhatTheBodyShowsToBeWrongHasItsPlace) {
    EXPECT_THAT(
        refusal_of({"interfaces.bond.stiffness_ratio=0.5"}),
        HasSubstr("--set interfaces.bond.stiffness_ratio=0.5: interfaces.bond.stiffness_ratio: 0.5 is too small"));
    EXPECT_THAT(refusal_of({"stages.0.forces={pull: {point: [5, 5], force: [1, 0]}}"}),
                HasSubstr("stages.0.forces.pull: expected a point in a block, found (5, 5)"));
    const std::vector<std::string> rigid{"analysis.kinematics=rigid", "geometry.tessellation.triangles=null",
                                         "geometry.tessellation.hexagons={spacing: 0.2}"};
    EXPECT_THAT(refusal_of(rigid), AllOf(HasSubstr("scene.yaml:2:59: materials.rock.poissons_ratio: 0.25 is too large"),
                                         HasSubstr("\n  materials: {rock: {youngs_modulus: 5 GPa")));
    try {
        (void)build_scene_model(read_scene_text(body_of_triangles, rigid, "scene.yaml"));
        FAIL() << "accepted";
    } catch (const InputError& error) {
        ASSERT_EQ(error.problems().size(), 1);
        const InputProblem& problem = error.problems().front();
        EXPECT_EQ(problem.path, "materials.rock.poissons_ratio");
        EXPECT_EQ(problem.file, "scene.yaml");
        EXPECT_EQ(problem.line, 2);
        EXPECT_EQ(problem.column, 59);
        EXPECT_THAT(problem.what, testing::StartsWith("0.25 is too large"));
    }
}

// Coulomb's law with c alone: |t| <= c under any normal stress.
TEST(SceneModel, WarnsOfACohesionWhoseFrictionIsForgottenWhereTheBodyHasTheFracture) {
    const auto slides = [](const std::string& key, const std::string& at) {
        return HasSubstr(key + ": without friction_angle the fracture has no friction, and slides at " + at + " MPa");
    };
    EXPECT_THAT(warnings_of({"interfaces.joint.friction_angle=null", "interfaces.joint.cohesion=0.2 MPa"}),
                ElementsAre(slides("interfaces.joint.cohesion", "0.2")));
    EXPECT_THAT(warnings_of({"interfaces.crack={friction_angle: null, cohesion: 3 MPa}"}),
                ElementsAre(slides("interfaces.crack.cohesion", "3")));
    EXPECT_THAT(warnings_of({"interfaces.joint.cohesion=0.2 MPa"}), IsEmpty());
    EXPECT_THAT(warnings_of({"interfaces.joint.friction_angle=0", "interfaces.joint.cohesion=0.2 MPa"}), IsEmpty());
    EXPECT_THAT(warnings_of({"interfaces.fault={kind: fracture, cohesion: 0.2 MPa, normal_stiffness: 500 GPa/m, "
                             "shear_stiffness: 250 GPa/m}"}),
                IsEmpty());
}

// Two traces cross 0.1 m behind a side of 2 m: the triangle between them, 0.01 m2, is 0.0115 of a hexagon of 1 m, 0.866 m2.
TEST(SceneModel, PointsInAPieceThatIsTakenOffAreRefusedWithTheKeyThatKeepsIt) {
    const std::string crossed = R"(kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}
geometry:
  domain: {polygon: [[0, 0], [2, 0], [2, 2], [0, 2]]}
  reference_spacing: 1
  minimum_area: 0.02
  fractures:
    - {trace: [[0.9, 0], [2.7, 1.8]], interface: joint}
    - {trace: [[0.9, 2], [2.7, 0.2]], interface: joint}
boundaries: {base: {sides: [0], support: fixed}}
stages: [{forces: {push: {point: [1.98, 1], force: [-1 kN/m, 0]}}}]
output: {histories: {face: {point: [2, 1]}, behind: {point: [0.5, 1]}}}
)";
    const auto messages = [&](const std::vector<std::string>& overrides) {
        return test::messages_of([&] { return build_scene_model(read_scene_text(crossed, overrides, "scene.yaml")); });
    };
    const auto says = [](const std::string& key) {
        return AllOf(HasSubstr(key + ": expected a point in a block"),
                     HasSubstr("in a piece of 0.01 m2 that is too small for a block and is taken off"),
                     HasSubstr("`geometry.minimum_area` of at most 0.011 keeps it"));
    };
    EXPECT_THAT(messages({}), ElementsAre(says("stages.0.forces.push"), says("output.histories.face")));
    EXPECT_THAT(messages({"geometry.minimum_area=0.011"}), IsEmpty());
    EXPECT_THAT(messages({"boundaries.face={sides: [1]}"}), IsEmpty());
    EXPECT_THAT(messages({"stages.0.forces.push.point=[2.1, 1]", "output.histories=null"}),
                ElementsAre(AllOf(HasSubstr("found (2.1, 1)"), Not(HasSubstr("taken off")))));
}

// A layer half a cell thick, at whose sides no line of the net lies: 5 GPa of rock bridge it.
TEST(SceneModel, WarnsOfARegionThatTheNetDoesNotFollow) {
    const std::vector<std::string> layer{
        "materials.weak={youngs_modulus: 0.5 GPa, poissons_ratio: 0.25, cohesion: 5 MPa, friction_angle: 40, "
        "tensile_strength: 2 MPa}",
        "geometry.material=rock",
        "geometry.regions=[{polygon: [[0, 0.45], [1, 0.45], [1, 0.55], [0, 0.55]], material: weak}]"};
    EXPECT_THAT(warnings_of(layer), Contains(AllOf(HasSubstr("geometry.regions.0.polygon"), HasSubstr("ragged"),
                                                   HasSubstr("`geometry.construction_lines`"))));
    std::vector<std::string> followed = layer;
    followed.emplace_back(
        "geometry.construction_lines=[{trace: [[0, 0.45], [1, 0.45]]}, {trace: [[0, 0.55], [1, 0.55]]}]");
    EXPECT_THAT(warnings_of(followed), Not(Contains(HasSubstr("ragged"))));
}

// A cantilever of hexagons bent by 0.04 of what it should because of a material that no block has.
TEST(SceneModel, OfUnusedMaterialsHasNoTrace) {
    const auto stiffness = [](const std::string& more) {
        const Model model = build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials:
  rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 1 MPa, friction_angle: 40, tensile_strength: 0.9 MPa}}
{}
interfaces:
  joint: {{kind: fracture, friction_angle: 25}}
  bond: {{kind: potential_crack, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: 2, height: 4}}}}
  material: rock
  tessellation: {{hexagons: {{spacing: 0.5}}, interface: bond}}
stages: [{{strain: {{boundary: top, value: 1 %}}}}]
)",
                                                                          more)))
                                .model;
        return std::pair(model.laws[1].normal_stiffness, model.moduli[0].mu);
    };
    const auto alone = stiffness("");
    EXPECT_NEAR(alone.first, 10.0 * 1e9 / 0.5, 1.0); // k_n d/E is 10
    EXPECT_EQ(stiffness("  steel: {youngs_modulus: 200 GPa, poissons_ratio: 0.3}"), alone);
}

/// Of a body with this outline, and boundaries by the directions that its sides face unless they are given.
std::vector<std::string> warnings_of_outline(const std::string& polygon, const std::string& boundaries,
                                             const std::string& pressure = "{}") {
    return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
geometry: {{domain: {{polygon: {}}}}}
boundaries: {}
stages: [{{name: weight, pressure: {}}}]
)",
                                                         polygon, boundaries, pressure)))
        .model.warnings;
}

// Rollers on 'left' held the face of a cliff, too, and a plane of 0.875 had a factor of safety above 4.
TEST(SceneModel, WarnsOfSupportsOnTheFaceOfASlope) {
    const std::string cliff = "[[0, 0], [20, 0], [20, 10], [8, 10], [8, 3], [0, 3]]";
    const auto told = Contains(HasSubstr("the support of 'left' also holds sides around (8, 6.5), 8 m behind"));
    EXPECT_THAT(warnings_of_outline(cliff, "{bottom: {support: fixed}, left: {support: smooth}}"), told);
    EXPECT_THAT(
        warnings_of_outline(cliff, "{bottom: {facing: bottom, support: fixed}, left: {facing: left, support: smooth}}"),
        told);
    EXPECT_THAT(warnings_of_outline(cliff, "{bottom: {support: fixed}, right: {support: smooth}}"), IsEmpty());
    EXPECT_THAT(
        warnings_of_outline(cliff, "{bottom: {sides: [0], support: fixed}, left: {sides: [3, 5], support: smooth}}"),
        IsEmpty()); // as the user says
    EXPECT_THAT(warnings_of_outline(cliff, "{bottom: {support: fixed}}", "{left: 1 MPa}"),
                Contains(HasSubstr("the pressure on 'left' also presses sides around (8, 6.5)")));
    EXPECT_THAT(
        warnings_of_outline("[[0, 0], [10, 0], [10, 10], [3, 10], [3, 7], [0, 7], [0, 5], [4, 5], [4, 3], [0, 3]]",
                            "{bottom: {support: fixed}}"),
        Contains(HasSubstr("'bottom' also holds sides around (2, 5), 5 m behind")));
    EXPECT_THAT(warnings_of_outline(cliff, "{bottom: {support: fixed}}", "{left: 1 MPa, right: 1 MPa, top: 1 MPa}"),
                IsEmpty()); // all around
    const std::string with_hole = "[[0, 0], [20, 0], [20, 10], [8, 10], [8, 3], [0, 3]], holes: [{polygon: [[14, 4], "
                                  "[16, 4], [16, 6], [14, 6]]}]";
    EXPECT_THAT(warnings_of_outline(
                    with_hole,
                    "{bottom: {sides: [0], support: fixed}, left: {facing: left, support: smooth}, wall: {hole: 0}}",
                    "{wall: 1 MPa}"),
                told); // the wall has four sides, and the outline three free ones
    // a side that is not quite straight is one side
    EXPECT_THAT(warnings_of_outline("[[0, 0], [10, 0], [10, 10], [0, 10], [0.1, 6], [0, 5.95], [0, 3]]",
                                    "{bottom: {support: fixed}, left: {support: smooth}}"),
                Not(Contains(HasSubstr("each side of the outline belongs"))));
}

// The upper cube of two lies 3 mm above the lower one: a joint between them is meant, and none is there.
TEST(SceneModel, WarnsOfSidesInOpenJointsThatBoundariesLeaveOut) {
    const auto warnings = [](const std::string& upper, const std::string& boundaries) {
        return build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 10 GPa/m}}}}
geometry:
  blocks:
    - {{name: lower, polygon: [[0, 0], [1, 0], [1, 1], [0, 1]]}}
    - {{name: upper, polygon: {}}}
boundaries: {}
stages: [{{name: weight}}]
)",
                                                             upper, boundaries),
                                                 {}, "scene.yaml"))
            .model.warnings;
    };
    const std::string apart = "[[0, 1.003], [1, 1.003], [1, 2], [0, 2]]";
    EXPECT_THAT(warnings(apart, "{bottom: {support: fixed}}"),
                Contains(AllOf(HasSubstr("scene.yaml:8:"),
                               HasSubstr("'upper' and 'lower' are up to 0.003 m apart at (0.5, 1.003)"),
                               HasSubstr("left out of 'bottom' (1 m);"))));
    EXPECT_THAT(warnings(apart, "{left: {support: smooth}}"), Not(Contains(HasSubstr("apart"))));
    EXPECT_THAT(warnings(apart, "{foot: {block: lower, facing: bottom, support: fixed}}"),
                Not(Contains(HasSubstr("apart"))));
    EXPECT_THAT(warnings("[[0, 1], [1, 1], [1, 2], [0, 2]]", "{bottom: {support: fixed}}"),
                Not(Contains(HasSubstr("left out"))));
    EXPECT_THAT(warnings("[[0, 1], [1.004, 1], [1.004, 2], [0, 2]]", "{bottom: {support: fixed}}"),
                Contains(AllOf(HasSubstr("share an edge"), HasSubstr("left out of 'bottom' (0.004 m)"))));
}

// A block on another one. The strength of nothing can be divided by anything: a factor above 3 was told.
TEST(SceneModel, RefusesOrWarnsToReduceTheStrengthOfNothing) {
    const auto model = [](const std::vector<std::string>& overrides) {
        return build_scene_model(read_scene_text(R"(
kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces:
  bed: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 10 GPa/m}
  fault: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 10 GPa/m}
geometry:
  domain: {polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}
  fractures: [{trace: [[-1, 1], [2, 1]], interface: bed}]
boundaries: {bottom: {support: fixed}}
stages: [{name: weight}, {name: reduce, strength_reduction: {to: 3, interfaces: [bed]}}]
)",
                                                 overrides, "scene.yaml"))
            .model;
    };
    const auto errors = [&](const std::vector<std::string>& overrides) {
        return test::messages_of([&] { return model(overrides); });
    };
    EXPECT_THAT(model({}).warnings, IsEmpty());
    EXPECT_THAT(model({"stages.1.strength_reduction.interfaces=[fault, bed]"}).warnings, IsEmpty());
    EXPECT_THAT(model({"stages.1.strength_reduction.interfaces=[fault]"}).warnings,
                ElementsAre(HasSubstr(
                    "stages.1.strength_reduction.interfaces: none of fault occurs in the body: no strength")));
    EXPECT_THAT(errors({"geometry.fractures=null"}),
                ElementsAre(AllOf(HasSubstr("scene.yaml:12:"), HasSubstr("found one without any"))));
    const auto told = [](const std::string& cause) {
        return ElementsAre(AllOf(HasSubstr("scene.yaml:10:"), HasSubstr("geometry.fractures.0: " + cause),
                                 EndsWith("; so the body has no interface whose strength stages.1.strength_reduction "
                                          "could divide")));
    };
    EXPECT_THAT(errors({"geometry.fractures.0.name=plane", "geometry.fractures.0.trace=[[4, 1], [6, 1]]"}),
                told("expected a trace that cuts the domain, found plane outside it"));
    EXPECT_THAT(errors({"geometry.fractures.0.name=plane", "geometry.fractures.0.trace=[[0.2, 1], [0.8, 1]]"}),
                told("plane is left out: it ends inside a block"));
    EXPECT_THAT(errors({"materials.rock.density=0"}),
                ElementsAre(AllOf(HasSubstr("scene.yaml:12:"), HasSubstr("no block that can move has a density"))));
    EXPECT_THAT(errors({"materials.rock.density=0", "stages.0.pressure={top: 1 MPa}"}), IsEmpty());
    EXPECT_THAT(errors({"analysis.gravity=0", "stages.0.pressure={top: 0}"}),
                ElementsAre(HasSubstr("no pressure, force or platen or gravity")));
}

TEST(SceneModel, WarnsOfFracturesThatAreNotLeft) {
    EXPECT_THAT(warnings_of({}), IsEmpty());
    EXPECT_THAT(warnings_of({"geometry.fractures.0.trace=[[0.3, 1], [0.306, 1]]"}),
                ElementsAre(AllOf(HasSubstr("scene.yaml:9:"), HasSubstr("geometry.fractures.0: main is left out: "),
                                  HasSubstr("shorter than 0.01 m"))));
    EXPECT_THAT(warnings_of({"geometry.fractures.0.trace=[[0.004, 0.5], [0.004, 1.5]]"}),
                ElementsAre(HasSubstr("nearer to another line than 0.01 m")));
    EXPECT_THAT(warnings_of({"geometry.fractures.0.trace=[[1, 0.5], [1, 1.5]]"}),
                ElementsAre(HasSubstr("it lies on the outline")));
    EXPECT_THAT(warnings_of({"geometry.fractures=[{name: main, trace: [[0, 1], [1, 1]], interface: joint}, {name: "
                             "again, trace: [[1, 1], [0, 1]], interface: joint}]"}),
                ElementsAre(EndsWith("geometry.fractures.1: again is left out: main runs along it already")));
    EXPECT_THAT(warnings_of({"geometry.fractures=[{name: main, trace: [[0, 1], [1, 1]], interface: joint}, {name: "
                             "again, trace: [[1, 1], [0, 1]], interface: weak}]",
                             "interfaces.weak={kind: fracture, normal_stiffness: 500 GPa/m, shear_stiffness: 250 "
                             "GPa/m, friction_angle: 20}"}),
                ElementsAre(HasSubstr("again is left out: main runs along it already, so that the interface there is "
                                      "'joint' and not 'weak'")));
}

TEST(SceneModel, WarnsOfTracesInHolesAndOnTheirWalls) {
    const auto settings = [](const std::string& trace) {
        return std::vector<std::string>{
            "geometry.domain.holes=[{polygon: [[0.3, 1.3], [0.7, 1.3], [0.7, 1.7], [0.3, 1.7]]}]",
            "geometry.fractures=[{trace: [[0, 1], [1, 1]], interface: joint}, {name: other, trace: " + trace +
                ", interface: joint}]"};
    };
    const auto at_reading = [&](const std::string& trace) {
        return read_scene_text(body_of_triangles, settings(trace), "scene.yaml").warnings;
    };
    EXPECT_THAT(at_reading("[[0.4, 1.4], [0.6, 1.6]]"),
                ElementsAre(HasSubstr("geometry.fractures.1: other lies in a hole of the domain")));
    EXPECT_THAT(at_reading("[[0.3, 1.5], [0.7, 1.5]]"), ElementsAre(HasSubstr("other lies in a hole of the domain")));
    EXPECT_THAT(at_reading("[[0.3, 1.3], [0.3, 1.7]]"), IsEmpty());
    EXPECT_THAT(warnings_of(settings("[[0.3, 1.3], [0.3, 1.7]]")),
                Contains(HasSubstr("other is left out: it lies on the outline of the domain or of a hole")));
}

// A notch that comes within 1e-7 m of the side across from it leaves triangles of about 1e-14 m2 there.
TEST(SceneModel, WarnsOfSliversOfANetWhereTheOutlineNearlyTouchesItself) {
    const std::string left = "geometry.domain.polygon=[[0, 0], [1, 0], [1, 2], [0, 2], [0, 1.001], ";
    EXPECT_THAT(warnings_of({"geometry.fractures=null", left + "[0.9999999, 1], [0, 0.999]]"}),
                Contains(AllOf(HasSubstr("is a sliver of "), HasSubstr("nearly touch there"))));
    EXPECT_THAT(warnings_of({"geometry.fractures=null", left + "[0.5, 1], [0, 0.999]]"}),
                Not(Contains(HasSubstr("is a sliver of "))));
}

// A corner of 0.1 x 0.1 / 2 m2 where the smallest block has 20 % of a hexagon of 0.3 m, 0.0156 m2.
TEST(SceneModel, WarnsOfAFractureThatCutsOffTooLittle) {
    EXPECT_THAT(warnings_of({"geometry.fractures.0.trace=[[0, 0.1], [0.1, 0]]", "geometry.minimum_area=0.2",
                             "geometry.tessellation=null", "geometry.reference_spacing=0.3"}),
                ElementsAre(AllOf(HasSubstr("geometry.fractures.0: main is left out: what it cuts off is 0.005 m2, "
                                            "less than 0.0156 m2"),
                                  HasSubstr("geometry.minimum_area"))));
}

// Beyond the bed the joint meets nothing; 4 % of it were drawn too long.
TEST(SceneModel, WarnsOfJointsThatEndInsideABlock) {
    const auto with = [](const std::string& end) {
        return warnings_of({"geometry.tessellation=null", "geometry.fractures=[{name: bed, trace: [[0, 1], [1, 1]], "
                                                          "interface: joint}, {name: main, trace: [[0.5, 0], [0.5, " +
                                                              end + "]], interface: joint}]"});
    };
    EXPECT_THAT(with("1.04"), IsEmpty());
    EXPECT_THAT(with("1.3"), ElementsAre(AllOf(
                                 HasSubstr("geometry.fractures.1: 0.3 m of main end inside a block and are left out: "),
                                 HasSubstr("without potential cracks"))));
}

// A joint that would cut but for a little: 3 cm of 1.9 m. What misses by more than a twentieth of the joint is meant to end there, and one
// that goes on beyond a line does not end before it.
TEST(SceneModel, SaysByHowMuchAJointMissesWhatItWouldEndOn) {
    const auto with = [](const std::string& fractures) {
        return warnings_of({"geometry.tessellation=null", "geometry.fractures=[" + fractures + "]"});
    };
    const auto main = [](const std::string& trace) { return "{name: main, interface: joint, trace: " + trace + "}, "; };
    const std::string bed = "{name: bed, trace: [[0, 1.97], [1, 1.97]], interface: joint}";
    EXPECT_THAT(with(main("[[0.5, 0.03], [0.5, 1.97]]") + bed),
                ElementsAre(EndsWith("; main ends at (0.5, 0.03), 0.03 m before the outline of the body")));
    EXPECT_THAT(with(main("[[0.5, 0], [0.5, 1.94]]") + bed),
                ElementsAre(EndsWith("; main ends at (0.5, 1.94), 0.03 m before bed")));
    EXPECT_THAT(with(main("[[0.5, 0.2], [0.5, 1.97]]") + bed), ElementsAre(Not(HasSubstr("before"))));
    EXPECT_THAT(with(main("[[0.5, 0.2], [0.5, 1.51]]") + "{name: bed, trace: [[0, 1.5], [1, 1.5]], interface: joint}"),
                ElementsAre(Not(HasSubstr("before"))));
}

TEST(SceneModel, WarnsOfANetWithoutAnEdgeInTheBody) {
    EXPECT_THAT(warnings_of({"geometry.fractures=[]", "geometry.tessellation.triangles=null",
                             "geometry.tessellation.hexagons={spacing: 9}", "interfaces.joint.friction_angle=20",
                             "interfaces.crack.friction_angle=20", "interfaces.bond.stiffness_ratio=10"}),
                ElementsAre(AllOf(HasSubstr("scene.yaml:10:"), HasSubstr("the net has no edge in the body"))));
    EXPECT_THAT(
        warnings_of({"geometry.fractures=[]", "geometry.tessellation.triangles=null",
                     "geometry.tessellation.hexagons={spacing: 0.2}", "interfaces.bond.stiffness_ratio=10",
                     "geometry.tessellation.region=[[5, 5], [6, 5], [6, 6]]", "interfaces.crack.friction_angle=20"}),
        ElementsAre(AllOf(HasSubstr("geometry.tessellation.region: the net has no edge in it that lies in the body"))));
    EXPECT_THAT(refusal_of({"geometry.tessellation.region=[[5, 5], [6, 5], [6, 6]]"}),
                HasSubstr("--set geometry.tessellation.region=[[5, 5], [6, 5], [6, 6]]: geometry.tessellation.region: "
                          "expected a polygon that holds a part of the body"));
}

TEST(SceneModel, WarnsOfARegionInWhichNoBlockLies) {
    const auto region = [](const std::string& polygon) {
        return "geometry.regions=[{polygon: " + polygon + ", material: rock}]";
    };
    EXPECT_THAT(warnings_of({region("[[50, 50], [60, 50], [60, 60]]")}),
                testing::Contains(AllOf(HasSubstr("geometry.regions.0"), HasSubstr("no block"))));
    EXPECT_THAT(warnings_of({region("[[-50, -50], [50, -50], [50, 50], [-50, 50]]")}),
                Not(testing::Contains(HasSubstr("geometry.regions.0"))));
}

// A square of 0.4 m has the area of a circle of 0.226 m, 0.15 of which is 0.034 m.
TEST(SceneModel, WarnsOfANetThatIsCoarseBesideAnOpening) {
    const auto warnings = [](const std::vector<std::string>& overrides) {
        Scene scene = read_scene_text(body_of_triangles, overrides, "scene.yaml");
        scene.geometry.holes = {{{0.3, 1.3}, {0.7, 1.3}, {0.7, 1.7}, {0.3, 1.7}}};
        return build_scene_model(scene).model.warnings;
    };
    const std::string grading = "geometry.tessellation.triangles.grading";
    EXPECT_THAT(warnings({}), ElementsAre(AllOf(HasSubstr("scene.yaml:8:"),
                                                HasSubstr("the net at hole 0 has a spacing of 0.2 m, 0.89 of"))));
    EXPECT_THAT(warnings({grading + ".openings=0.033"}), IsEmpty());
    EXPECT_THAT(warnings({grading + ".openings=0.035"}), ElementsAre(HasSubstr("a spacing of 0.035 m")));
    EXPECT_THAT(warnings({grading + ".region=[[0.1, 1.1], [0.9, 1.1], [0.9, 1.9], [0.1, 1.9]]",
                          grading + ".region_spacing=0.033"}),
                IsEmpty());
}

// The square again, of 0.16 m2, in blocks of 0.84 m2 (the upper half of the body), of a quarter of that, and of 0.04 m2 at most.
TEST(SceneModel, WarnsOfAnOpeningInBlocksThatAreLargerThanIt) {
    const auto warnings = [](const std::string& fractures, const std::string& kinematics = "affine") {
        Scene scene = read_scene_text(body_of_triangles,
                                      {"geometry.tessellation=null", "analysis.kinematics=" + kinematics,
                                       "geometry.fractures=[" + fractures + "]"},
                                      "scene.yaml");
        scene.geometry.holes = {{{0.3, 1.3}, {0.7, 1.3}, {0.7, 1.7}, {0.3, 1.7}}};
        return build_scene_model(scene).model.warnings;
    };
    const auto joint = [](const std::string& trace) { return "{trace: " + trace + ", interface: joint}"; };
    const std::string below = joint("[[0, 1], [1, 1]]");
    EXPECT_THAT(warnings(below),
                ElementsAre(AllOf(HasSubstr("scene.yaml:8:"), HasSubstr("geometry.domain: block "),
                                  HasSubstr("has 100 % of the edge of hole 0 and 5.3 times its area"))));
    EXPECT_THAT(warnings(below, "rigid"), IsEmpty()) << "rigid blocks have no strain";
    const std::string cross = joint("[[0, 1.5], [1, 1.5]]") + ", " + joint("[[0.5, 1], [0.5, 2]]");
    EXPECT_THAT(warnings(below + ", " + cross),
                ElementsAre(HasSubstr("has 25 % of the edge of hole 0 and 1.3 times its area")));
    std::string many = below;
    for (const std::string at : {"0.2", "0.4", "0.6", "0.8"})
        many += ", " + joint("[[" + at + ", 1], [" + at + ", 2]]") + ", " +
                joint("[[0, 1" + at.substr(1) + "], [1, 1" + at.substr(1) + "]]");
    EXPECT_THAT(warnings(many), IsEmpty());
}

TEST(SceneModel, WarnsOfDetailsThatAreFinerThanTheNet) {
    EXPECT_THAT(warnings_of({"geometry.domain.polygon=[[0, 0], [0.5, 0], [0.502, 0], [1, 0], [1, 2], [0, 2]]"}),
                ElementsAre(AllOf(HasSubstr("scene.yaml:8:"),
                                  HasSubstr("a side of the outline at (0.501, 0) is 0.002 m long, less than 0.01 m"))));
}

/// One triangle of 0.05 m has 1.08e-3 m2, the strip of 1 mm 1e-3 m2.
TEST(SceneModel, BlamesANetThatIsCoarserThanTheBody) {
    EXPECT_THAT(refusal_of({"geometry.domain.polygon=[[0, 0], [1, 0], [1, 0.001], [0, 0.001]]",
                            "geometry.tessellation.triangles.spacing=0.05", "geometry.fractures=[]"}),
                AllOf(HasSubstr("geometry.tessellation.triangles.spacing: the spacing of the net, 0.05 m, is larger "
                                "than the body, which is about 0.000999 m wide")));
}

/// Triangles of 1e-6 m on 1 m2: 2.3e12.
TEST(SceneModel, NamesTheSpacingThatMakesTooManyTriangles) {
    const std::string grading = "geometry.tessellation.triangles.grading";
    EXPECT_THAT(refusal_of({grading + ".region=[[0, 0], [1, 0], [1, 1], [0, 1]]", grading + ".region_spacing=1e-6"}),
                AllOf(HasSubstr("--set " + grading + ".region_spacing=1e-6"), HasSubstr("about 2.3e+12")));
}

// Two blocks of 1 m2: the mean size is 1 m.
TEST(SceneModel, WarnsOfAReferenceThatIsLittleBesideTheBlocks) {
    const auto warnings = [](const char* spacing) {
        return warnings_of({"geometry.tessellation=null", std::string("geometry.reference_spacing=") + spacing});
    };
    EXPECT_THAT(warnings("2.9e-3"),
                ElementsAre(AllOf(HasSubstr("reference_spacing"), HasSubstr("0.0029 m is little beside the blocks"))));
    EXPECT_THAT(warnings("3.1e-3"), IsEmpty());
}

// Three traces cut a triangle of half a millimetre's base and height between them: 1.25e-7 of 2 m2.
TEST(SceneModel, WarnsOfSliversWhereNoSpacingSaysWhatIsTooSmall) {
    const std::string traces =
        R"(geometry.fractures=[{trace: [[-1, 0.5], [3, 0.5]], interface: joint}, {trace: [[0.5, -1], [0.5, 3]], interface: joint},
                               {trace: [[-0.4995, -0.5], [2.5005, 2.5]], interface: joint}])";
    const auto warnings = [&](const char* spacing) {
        return warnings_of({"geometry.tessellation=null", std::string("geometry.reference_spacing=") + spacing,
                            "interfaces.bond=null", "interfaces.crack=null", traces});
    };
    EXPECT_THAT(warnings("null"),
                Contains(AllOf(HasSubstr("is a sliver of 1.25e-07 m2"), HasSubstr("reference_spacing"))));
    EXPECT_THAT(warnings("0.2"), Not(Contains(HasSubstr("sliver"))));
}

} // namespace
} // namespace kluft

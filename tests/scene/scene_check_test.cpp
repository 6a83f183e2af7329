// Every class of error in a scene, with the exact message where its shape matters.
#include "kluft/scene/scene_check.hpp"

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using test::errors_in;
using test::errors_with;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST(SceneErrors, UnknownKeyNamesPlaceKeyValidKeysNearestKeyAndShowsTheLine) {
    EXPECT_THAT(errors_in("kluft: 1\n"
                          "materials:\n"
                          "  rock:\n"
                          "    densty: 2300\n"
                          "    youngs_modulus: 1e9\n"
                          "    poissons_ratio: 0.25\n"
                          "geometry: {domain: {rectangle: {width: 1, height: 2}}}\n"
                          "stages: [{strain: {boundary: top, value: 0.01}}]\n"),
                ElementsAre("scene.yaml:4:5: materials.rock.densty: expected one of density, youngs_modulus, "
                            "poissons_ratio, cohesion, friction_angle, tensile_strength, found 'densty'; did you mean "
                            "'density'?\n"
                            "      densty: 2300"));
}

TEST(SceneErrors, AllAreReportedAtOnceInTheOrderOfTheText) {
    const auto errors = errors_in("kluft: 1\n"
                                  "materials:\n"
                                  "  rock: {youngs_modulus: -1 GPa, poissons_ratio: 0.5}\n"
                                  "geometry: {domain: {rectangle: {width: 1, height: two}}, material: rok}\n"
                                  "stages:\n"
                                  "  - strain: {boundary: top, value: 1 m}\n"
                                  "    steps: 0\n"
                                  "colour: red\n");
    EXPECT_THAT(errors,
                ElementsAre(StartsWith("scene.yaml:3:26: materials.rock.youngs_modulus: expected a number > 0 in Pa, "
                                       "found '-1 GPa'\n"),
                            StartsWith("scene.yaml:3:50: materials.rock.poissons_ratio: expected a number >= 0 and < "
                                       "0.5, found '0.5'\n"),
                            StartsWith("scene.yaml:4:51: geometry.domain.rectangle.height: expected a number > 0 in m, "
                                       "found 'two'\n"),
                            StartsWith("scene.yaml:4:68: geometry.material: expected the name of a material (rock), "
                                       "found 'rok'; did you mean 'rock'?\n"),
                            StartsWith("scene.yaml:6:36: stages.0.strain.value: expected a number from -0.5 to 0.5, "
                                       "found '1 m', which is in m\n"),
                            StartsWith("scene.yaml:7:12: stages.0.steps: expected an integer >= 1, found '0'\n"),
                            StartsWith("scene.yaml:8:1: colour: expected one of kluft, title, extends, analysis, ")));
}

TEST(SceneErrors, MissingKeysPointToTheMappingThatLacksThem) {
    EXPECT_THAT(errors_in("title: empty\nmaterials: {rock: {density: 1}}\n"),
                ElementsAre("scene.yaml:1:1: kluft: expected an integer equal to 1, found nothing\n  title: empty",
                            StartsWith("scene.yaml:1:1: geometry: expected a mapping of domain, crs, fractures, "),
                            StartsWith("scene.yaml:1:1: stages: expected a list of at least one, found nothing"),
                            StartsWith("scene.yaml:2:19: materials.rock.youngs_modulus: expected a number > 0 in Pa, "
                                       "found nothing"),
                            StartsWith("scene.yaml:2:19: materials.rock.poissons_ratio: ")));
}

/// The mistyped key is reported, not the one that it was meant to be.
// The parser of YAML makes a byte of each that is no character of UTF-8: no later reader would take the results.
TEST(SceneErrors, EscapesThatMakeNoUtf8AreRefused) {
    const std::string scene = test::short_scene;
    const std::size_t second_line = scene.find('\n', scene.find("kluft: 1")) + 1;
    for (const char* escape : {R"(\N)", R"(\_)"}) {
        const std::string title = std::string("title: \"a") + escape + "b\"\n";
        EXPECT_THAT([&] { (void)read_scene_text(scene.substr(0, second_line) + title + scene.substr(second_line)); },
                    testing::ThrowsMessage<InputError>(testing::HasSubstr("expected a text in UTF-8")))
            << escape;
    }
}

TEST(SceneErrors, AMistypedRequiredKeyIsOneError) {
    EXPECT_THAT(errors_with({"materials.rock.youngs_modulus=null", "materials.rock.young_modulus=1 GPa"}),
                ElementsAre(AllOf(HasSubstr("materials.rock.young_modulus: expected one of "),
                                  HasSubstr("did you mean 'youngs_modulus'?"))));
}

// A comma between braces ends a value in YAML, and begins a key.
TEST(SceneErrors, ADecimalCommaIsOneErrorThatSaysSo) {
    const auto errors = [](const std::string& stage) {
        return errors_in("kluft: 1\n"
                         "materials: {rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.25}}\n"
                         "geometry: {domain: {rectangle: {width: 1, height: 2}}}\n"
                         "stages: [" +
                         stage + "]\n");
    };
    EXPECT_THAT(errors("{strain: {boundary: top, value: 0,5 %}}"),
                ElementsAre("scene.yaml:4:42: stages.0.strain.value: expected a number with a decimal point, '0.5 %', "
                            "found '0,5 %'\n  stages: [{strain: {boundary: top, value: 0,5 %}}]"));
    EXPECT_THAT(errors("{strain: {value: 0,05, boundary: top}}"), ElementsAre(HasSubstr("'0.05', found '0,05'")));
    EXPECT_THAT(errors("{pressure: {left: 1,5 MPa, right: 2,25 MPa}}"),
                ElementsAre(HasSubstr("stages.0.pressure.left: expected a number with a decimal point, '1.5 MPa'"),
                            HasSubstr("stages.0.pressure.right: expected a number with a decimal point, '2.25 MPa'")));
    EXPECT_THAT(errors("{pressure: {left: 1,5 MPa, right: 1,5 MPa}}"),
                ElementsAre(HasSubstr("stages.0.pressure.left: expected a number with a decimal point, '1.5 MPa'"),
                            HasSubstr("found '5 MPa' again; decimals have a point")));
    EXPECT_THAT(errors("{strain: {boundary: top, value: '0,5 %'}}"),
                ElementsAre(HasSubstr("found '0,5 %', which has a comma; decimals have a point")));
    EXPECT_THAT(errors_with({"stages.1.strain.value=1,5 %"}),
                ElementsAre(HasSubstr("found '1,5 %', which has a comma; decimals have a point")));
}

TEST(SceneErrors, DuplicateKeysAreErrors) {
    std::string text = test::short_scene + "title: a\ntitle: b\n";
    EXPECT_THAT(errors_in(text),
                ElementsAre("scene.yaml:9:1: title: expected each key once, found 'title' again\n  title: b"));
    EXPECT_THAT(errors_in(test::short_scene + "solver: {balance: 1e-3, balance: 1e-4}\n"),
                ElementsAre(StartsWith("scene.yaml:8:25: solver.balance: expected each key once")));
}

struct Refusal {
    const char* assignment;
    const char* what; ///< of the message, after "--set assignment: "
};

void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.assignment; }

class RefusedValue : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedValue, IsOneErrorThatSaysWhy) {
    const auto& [assignment, what] = GetParam();
    EXPECT_THAT(errors_with({assignment}), ElementsAre(std::string("--set ") + assignment + ": " + what));
}

INSTANTIATE_TEST_SUITE_P(
    WrongType, RefusedValue,
    testing::Values(
        Refusal{"kluft=2", "kluft: expected an integer equal to 1, found '2'"},
        Refusal{"kluft=1.0", "kluft: expected an integer equal to 1, found '1.0'"},
        Refusal{"title=[a]", "title: expected text, found a list of 1"},
        Refusal{"title=", "title: expected text, found nothing"},
        Refusal{"title=\"a\\tb\"", "title: expected text, found 'a b', which has control characters"},
        Refusal{
            "solver=3",
            "solver: expected a mapping of tolerance, balance, accuracy, detection_every, viscosity, max_iterations, "
            "max_unbalanced_steps, max_step_solves, tangent, reuse, repeatable, found '3'"},
        Refusal{"materials.rock.density={a: 1}",
                "materials.rock.density: expected a number >= 0 in kg/m3, found a mapping"},
        Refusal{"solver.repeatable=yes", "solver.repeatable: expected true or false, found 'yes'"},
        Refusal{"solver.repeatable='true'", "solver.repeatable: expected true or false, found 'true'"},
        Refusal{"analysis.plane=strian",
                "analysis.plane: expected one of strain, stress, found 'strian'; did you mean 'strain'?"},
        Refusal{"analysis.integrator=explict",
                "analysis.integrator: expected one of implicit, explicit, found 'explict'; did you mean 'explicit'?"},
        Refusal{"analysis.damping=0.5",
                "analysis.damping: expected integrator: explicit beside it, found integrator: implicit"},
        Refusal{"analysis.loading_rate=1 mm/s",
                "analysis.loading_rate: expected integrator: explicit beside it, found integrator: implicit"},
        Refusal{"analysis.kinematics=rigidd",
                "analysis.kinematics: expected one of affine, rigid, found 'rigidd'; did you mean 'rigid'?"},
        Refusal{"analysis.gravity=down",
                "analysis.gravity: expected a number >= 0 (downwards) or [gx, gy] in m/s2, found 'down'"},
        Refusal{"analysis.gravity=-9.81",
                "analysis.gravity: expected a number >= 0 (downwards) or [gx, gy] in m/s2, found '-9.81'"},
        Refusal{"analysis.gravity=[0, 0, 9.81]",
                "analysis.gravity: expected a number >= 0 (downwards) or [gx, gy] in m/s2, found a list of 3"},
        Refusal{"stages={a: 1}", "stages: expected a list of at least one, found a mapping"},
        Refusal{"stages=[]", "stages: expected a list of at least one, found an empty list"},
        Refusal{"geometry.fractures.0.trace=[[0, 0]]",
                "geometry.fractures.0.trace: expected a list of at least 2 points [x, y] in m, found a list of 1"},
        Refusal{"geometry.fractures.0.trace=[[0, 0], [1, 2, 3]]",
                "geometry.fractures.0.trace.1: expected a point [x, y] in m, found a list of 3"},
        Refusal{"geometry.fractures.0.trace=[[0, 0], [1, b]]",
                "geometry.fractures.0.trace.1.1: expected a number in m, found 'b'"},
        Refusal{"stages.0.steps=2.5", "stages.0.steps: expected an integer >= 1, found '2.5'"},
        Refusal{"stages.0.steps='3'", "stages.0.steps: expected an integer >= 1, found '3'"},
        Refusal{"geometry.domain.rectangle=1",
                "geometry.domain.rectangle: expected a mapping of width, height, origin, found '1'"}));

INSTANTIATE_TEST_SUITE_P(
    OutOfRange, RefusedValue,
    testing::Values(
        Refusal{"materials.rock.youngs_modulus=0",
                "materials.rock.youngs_modulus: expected a number > 0 in Pa, found '0'"},
        Refusal{"materials.rock.poissons_ratio=-0.1",
                "materials.rock.poissons_ratio: expected a number >= 0 and < 0.5, found '-0.1'"},
        Refusal{"materials.rock.density=-1", "materials.rock.density: expected a number >= 0 in kg/m3, found '-1'"},
        Refusal{"materials.rock.friction_angle=90",
                "materials.rock.friction_angle: expected a number >= 0 and < 90 in deg, found '90'"},
        Refusal{"materials.rock.friction_angle=90 deg",
                "materials.rock.friction_angle: expected a number >= 0 and < 90 in deg, found '90 deg'"},
        Refusal{"interfaces.joint.normal_stiffness=-3 GPa/m",
                "interfaces.joint.normal_stiffness: expected a number > 0 in Pa/m, found '-3 GPa/m'"},
        Refusal{"geometry.tessellation.hexagons.spacing=0",
                "geometry.tessellation.hexagons.spacing: expected a number > 0 in m, found '0'"},
        Refusal{"geometry.tessellation.hexagons.jitter=0.25",
                "geometry.tessellation.hexagons.jitter: expected a number >= 0 and < 0.25, found '0.25'"},
        Refusal{"geometry.tessellation.hexagons.seed=-1",
                "geometry.tessellation.hexagons.seed: expected an integer >= 0, found '-1'"},
        Refusal{"geometry.tessellation={hexagons: null, voronoi: {spacing: 0.1, relaxation: 21}}",
                "geometry.tessellation.voronoi.relaxation: expected an integer from 0 to 20, found '21'"},
        Refusal{"cracks.strength_noise=0.3", "cracks.strength_noise: expected a number >= 0 and < 0.3, found '0.3'"},
        Refusal{"cracks.strength_noise=-0.01",
                "cracks.strength_noise: expected a number >= 0 and < 0.3, found '-0.01'"},
        Refusal{"cracks.strength_seed=-1", "cracks.strength_seed: expected an integer >= 0, found '-1'"},
        Refusal{"stages.0.steps=3000000000",
                "stages.0.steps: expected an integer >= 1, found '3000000000', which is beyond 2147483647"},
        Refusal{"stages.0.steps=99999999999999999999",
                "stages.0.steps: expected an integer >= 1, found '99999999999999999999', which is beyond 2147483647"},
        Refusal{"stages.1.strain.value=1.5", "stages.1.strain.value: expected a number from -0.5 to 0.5, found '1.5'"},
        Refusal{"geometry.domain.rectangle.width=1e300",
                "geometry.domain.rectangle.width: expected a number > 0 in m, found '1e300', which is beyond 1e+09 m"},
        Refusal{"solver.tolerance=1", "solver.tolerance: expected a number > 0 and < 1, found '1'"}));

INSTANTIATE_TEST_SUITE_P(
    NotANumber, RefusedValue,
    testing::Values(
        Refusal{"geometry.domain.rectangle.width=1e-200",
                "geometry.domain.rectangle.width: expected a number > 0 in m, found '1e-200', whose products are below "
                "the range of a number"},
        Refusal{"solver.tolerance=.nan",
                "solver.tolerance: expected a number > 0 and < 1, found '.nan', which is not finite"},
        Refusal{"materials.rock.density=.inf",
                "materials.rock.density: expected a number >= 0 in kg/m3, found '.inf', which is not finite"},
        Refusal{"materials.rock.density=1e999", "materials.rock.density: expected a number >= 0 in kg/m3, found "
                                                "'1e999', which is beyond the range of a number"},
        Refusal{"materials.rock.density=012",
                "materials.rock.density: expected a number >= 0 in kg/m3, found '012', which has a leading zero"},
        Refusal{"stages.0.steps=010",
                "stages.0.steps: expected an integer >= 1, found '010', which has a leading zero"},
        Refusal{"stages.0.steps=0x10", "stages.0.steps: expected an integer >= 1, found '0x10', which is not decimal"},
        Refusal{"materials.rock.density=1_000",
                "materials.rock.density: expected a number >= 0 in kg/m3, found '1_000', which has digit groups"},
        Refusal{"materials.rock.density='2650'",
                "materials.rock.density: expected a number >= 0 in kg/m3, found '2650', which is text"}));

INSTANTIATE_TEST_SUITE_P(
    WrongUnit, RefusedValue,
    testing::Values(
        Refusal{"interfaces.joint.normal_stiffness=25 MPa",
                "interfaces.joint.normal_stiffness: expected a number > 0 in Pa/m, found '25 MPa', which is in Pa"},
        Refusal{"geometry.domain.rectangle.width=3 deg",
                "geometry.domain.rectangle.width: expected a number > 0 in m, found '3 deg', which is in deg"},
        Refusal{"geometry.domain.rectangle.width=3 ccm",
                "geometry.domain.rectangle.width: expected a number > 0 in m, "
                "found '3 ccm' with the unknown unit 'ccm'; did you mean 'cm'?"},
        Refusal{"solver.tolerance=3 m",
                "solver.tolerance: expected a number > 0 and < 1, found '3 m', which is in m"}));

INSTANTIATE_TEST_SUITE_P(
    Reference, RefusedValue,
    testing::Values(
        Refusal{"geometry.material=clya", "geometry.material: expected the name of a material (rock, clay), found "
                                          "'clya'; did you mean 'clay'?"},
        Refusal{"geometry.regions.0.material=sand",
                "geometry.regions.0.material: expected the name of a material (rock, clay), found 'sand'"},
        Refusal{"geometry.fractures.0.interface=joins", "geometry.fractures.0.interface: expected the name of an "
                                                        "interface (joint, bond, seam), found 'joins'; did you mean "
                                                        "'joint'?"},
        Refusal{"geometry.tessellation.interface=bonds",
                "geometry.tessellation.interface: expected the name of an interface (joint, bond, seam), found "
                "'bonds'; did you mean 'bond'?"},
        Refusal{"interfaces.bond.fails_to=seam",
                "interfaces.bond.fails_to: expected the name of an interface of kind fracture (joint), found 'seam'"},
        Refusal{"interfaces.bond.fails_to=jiont", "interfaces.bond.fails_to: expected the name of an interface of kind "
                                                  "fracture (joint), found 'jiont'; did you mean 'joint'?"},
        Refusal{"boundaries.botom.support=smooth", "boundaries.botom: expected the name of a boundary (bottom, right, "
                                                   "top, left), found 'botom'; did you mean 'bottom'?"},
        Refusal{"stages.0.pressure.up=1", "stages.0.pressure.up: expected the name of a boundary (bottom, right, top, "
                                          "left), found 'up'"},
        Refusal{"stages.1.strain.boundary=tpo", "stages.1.strain.boundary: expected the name of a boundary (bottom, "
                                                "right, top, left), found 'tpo'; did you mean 'top'?"}));

INSTANTIATE_TEST_SUITE_P(
    Contradiction, RefusedValue,
    testing::Values(
        Refusal{"interfaces.joint.tensile_strength=1 MPa",
                "interfaces.joint.tensile_strength: expected 0 or nothing for a fracture, which carries no tension, "
                "found '1 MPa'"},
        Refusal{"interfaces.joint.fails_to=joint",
                "interfaces.joint.fails_to: expected nothing for a fracture, which has failed already, found 'joint'"},
        Refusal{"interfaces.joint.dilation_angle=31",
                "interfaces.joint.dilation_angle: expected at most the friction angle (25 deg), found '31'"},
        Refusal{"boundaries.left.sides=[3]", "boundaries.left.sides: expected nothing for a rectangle, whose "
                                             "boundaries are bottom, right, top, left, found a list of 1"},
        Refusal{"stages.1.stress={boundary: right, value: 1}",
                "stages.1.stress: expected one platen in a stage, found stress beside strain"},
        Refusal{"geometry.fractures.0.trace=[[0, 0], [0, 0], [1, 1]]",
                "geometry.fractures.0.trace: expected successive points to differ, found points 0 and 1 (counted from "
                "0) equal"},
        Refusal{"geometry.tessellation.region=[[1, 0], [2, 1], [2, 0], [1, 1]]",
                "geometry.tessellation.region: expected a simple polygon, found sides 0 and 2 (counted from 0) that "
                "cross"},
        Refusal{"geometry.tessellation.region=[[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]",
                "geometry.tessellation.region: expected a simple polygon, found one that touches itself"},
        Refusal{"geometry.regions.0.polygon=[[0, 0], [1, 1], [2, 2]]",
                "geometry.regions.0.polygon: expected a polygon with an area, found none"},
        Refusal{"geometry.tessellation.hexagons.spacing=0.2 mm",
                "geometry.tessellation.hexagons.spacing: expected a spacing in m that makes at most 2e+06 "
                "hexagons, found '0.2 mm', which makes about 2.3e+08"},
        Refusal{"geometry.tessellation={hexagons: null, voronoi: {spacing: 0.2 mm}}",
                "geometry.tessellation.voronoi.spacing: expected a spacing in m that makes at most 2e+06 cells, "
                "found '0.2 mm', which makes about 2.3e+08"},
        Refusal{"geometry.tessellation.hexagons.spacing=1.2 mm", // 8 m2 by sqrt(3)/2 d2
                "geometry.tessellation.hexagons.spacing: expected a spacing in m that makes at most 2e+06 "
                "hexagons, found '1.2 mm', which makes about 6.4e+06"}));

TEST(SceneErrors, TrianglesAreCountedWhereTheNetIs) {
    const std::vector<std::string> fine{"geometry.tessellation.hexagons=null",
                                        "geometry.tessellation.triangles={spacing: 1.3 mm}"};
    EXPECT_THAT(errors_with({fine[0], fine[1], "geometry.tessellation.region=null"}),
                ElementsAre(HasSubstr("which makes about 1.1e+07"))); // 8 m2 by sqrt(3)/4 a2
    EXPECT_THAT(errors_with({fine[0], fine[1], "geometry.tessellation.region=[[1, 0], [2, 0], [2, 1], [1, 1]]"}),
                IsEmpty()); // 1.4e6 of them
}

TEST(SceneErrors, MissingValueIsToldAtItsKey) {
    const auto errors = errors_in("kluft: 1\n"
                                  "materials:\n"
                                  "  rock:\n"
                                  "    youngs_modulus: # to be measured\n"
                                  "    density:\n"
                                  "\n"
                                  "    poissons_ratio: 0.25\n"
                                  "geometry: {domain: {rectangle: {width:, height: 2}}}\n"
                                  "stages:\n"
                                  "  -\n"
                                  "  - {strain: {boundary: top, value: 0.01}}\n"
                                  "output:\n");
    EXPECT_THAT(errors,
                ElementsAre(StartsWith("scene.yaml:4:5: materials.rock.youngs_modulus: expected a number > 0 in "
                                       "Pa, found nothing\n      youngs_modulus: # to be"),
                            StartsWith("scene.yaml:5:5: materials.rock.density: "),
                            StartsWith("scene.yaml:8:33: geometry.domain.rectangle.width: "),
                            StartsWith("scene.yaml:10:3: stages.0: "), StartsWith("scene.yaml:12:1: output: ")));
}

TEST(SceneErrors, KeyWithoutAValueRemovesNothingWhateverFollows) {
    // `name`, `normal_stiffness` and the like begin as `null` does.
    EXPECT_THAT(errors_in(std::string(test::short_scene) + "title:\nnumber: 3\n"),
                testing::Contains(HasSubstr("title: expected text, found nothing")));
}

TEST(SceneErrors, NetIsOfOneKind) {
    EXPECT_THAT(
        errors_with({"geometry.tessellation.voronoi={spacing: 0.1}"}),
        ElementsAre(testing::HasSubstr(
            "geometry.tessellation: expected one of triangles, hexagons, voronoi, found hexagons and voronoi")));
    EXPECT_THAT(errors_with({"geometry.tessellation.hexagons=null"}),
                ElementsAre(testing::HasSubstr(
                    "geometry.tessellation: expected one of triangles, hexagons, voronoi, found none of them")));
}

TEST(SceneErrors, TrianglesHaveTheirKeysTogether) {
    EXPECT_THAT(errors_with({"geometry.tessellation.hexagons=null",
                             "geometry.tessellation.triangles={spacing: 0.1, grading: {region_spacing: 0.05}}"}),
                ElementsAre(testing::HasSubstr("expected region and region_spacing together, found one of them")));
    EXPECT_THAT(errors_with({"geometry.construction_lines=[{trace: [[0, 0], [1, 1]]}]"}),
                ElementsAre(testing::HasSubstr("geometry.construction_lines: expected geometry.tessellation.triangles, "
                                               "which follow them, found none")));
    EXPECT_THAT(errors_with({"geometry.tessellation.hexagons=null", "geometry.tessellation.triangles={spacing: 1e-7}"}),
                ElementsAre(testing::HasSubstr("geometry.tessellation.triangles.spacing: expected a spacing in m that "
                                               "makes at most 2e+06 triangles, found '1e-7', which makes about ")));
}

TEST(SceneErrors, OneOfSeveralMaterialsMustBeNamed) {
    EXPECT_THAT(errors_with({"geometry.material=null"}),
                ElementsAre("--set geometry.material=null: geometry.material: expected the name of a material (rock, "
                            "clay), found nothing"));
}

TEST(SceneErrors, StiffnessIsGivenInOneWay) {
    EXPECT_THAT(errors_with({"interfaces.joint.stiffness_ratio=10"}),
                ElementsAre("--set interfaces.joint.stiffness_ratio=10: interfaces.joint.stiffness_ratio: expected one "
                            "way to give the stiffness, found stiffness_ratio beside normal_stiffness"));
    EXPECT_THAT(errors_with({"interfaces.joint.shear_stiffness=null"}),
                ElementsAre(HasSubstr("interfaces.joint.shear_stiffness: expected a value because normal_stiffness is "
                                      "given, found nothing")));
}

TEST(SceneErrors, StrengthsComeTogetherOrNotAtAll) {
    EXPECT_THAT(errors_with({"interfaces.seam.cohesion=null"}),
                ElementsAre(HasSubstr("interfaces.seam.cohesion: expected cohesion, friction_angle and "
                                      "tensile_strength together or none of them, found nothing")));
    EXPECT_THAT(errors_with({"materials.rock.tensile_strength=null"}),
                ElementsAre(HasSubstr("materials.rock.tensile_strength: expected cohesion, ")));
}

TEST(SceneErrors, APotentialCrackInUseNeedsAStrengthFromSomewhere) {
    EXPECT_THAT(errors_with({"materials.clay={cohesion: null, friction_angle: null, tensile_strength: null}"}),
                ElementsAre(HasSubstr("interfaces.bond: expected cohesion, friction_angle and tensile_strength here or "
                                      "in the material clay, found neither")));
}

TEST(SceneErrors, APotentialCrackNeedsAFractureToFailTo) {
    EXPECT_THAT(errors_with({"interfaces.bond.fails_to=null"}), IsEmpty()) << "the only fracture is the default";
    EXPECT_THAT(errors_with({"interfaces.bond.fails_to=null", "interfaces.other.kind=fracture"}),
                ElementsAre(HasSubstr("interfaces.bond.fails_to: expected the name of an interface of kind fracture "
                                      "(joint, other), found nothing")));
    EXPECT_THAT(errors_in(test::short_scene, {"interfaces.bond.kind=potential_crack"}),
                ElementsAre(HasSubstr("interfaces.bond.fails_to: expected the name of an interface of kind fracture, "
                                      "found nothing, and the scene has none yet")));
}

TEST(SceneErrors, StiffnessesTimesSpacingNeedASpacing) {
    const std::vector<std::string> overrides{"geometry.tessellation=null", "geometry.reference_spacing=null"};
    EXPECT_THAT(errors_with(overrides),
                ElementsAre(HasSubstr("interfaces.seam: expected normal_stiffness and shear_stiffness in Pa/m, or a "
                                      "geometry.tessellation or a geometry.reference_spacing that gives the spacing, "
                                      "found none of them for seam")));
}

TEST(SceneErrors, GravityNeedsDensities) {
    EXPECT_THAT(errors_with({"materials.rock.density=null"}),
                ElementsAre(HasSubstr("materials.rock.density: expected a number > 0 in kg/m3 because there is "
                                      "gravity, found nothing")));
    EXPECT_THAT(errors_in(test::short_scene, {"analysis.gravity=9.81"}), testing::SizeIs(1));
    EXPECT_THAT(errors_in(test::short_scene, {"analysis.integrator=explicit"}), testing::IsEmpty());
    EXPECT_THAT(errors_in(test::short_scene, {"analysis={integrator: explicit, density_scaling: none}"}),
                testing::SizeIs(1)); // inertia needs densities too
}

TEST(SceneErrors, AccuracyIsForCracksInEveryStepOfImplicitRuns) {
    EXPECT_THAT(errors_with({"cracks.every=5", "solver.accuracy=0.01"}),
                ElementsAre("--set solver.accuracy=0.01: solver.accuracy: expected cracks.every: 1 beside it, found "
                            "cracks.every: 5"));
    EXPECT_THAT(errors_in(test::short_scene, {"analysis.integrator=explicit", "solver.accuracy=0.01"}),
                ElementsAre(HasSubstr("expected integrator: implicit beside it, found integrator: explicit")));
    EXPECT_THAT(errors_in(test::short_scene, {"analysis.integrator=explicit", "solver.detection_every=2"}),
                ElementsAre(HasSubstr("expected integrator: implicit beside it, found integrator: explicit")));
    EXPECT_THAT(errors_in(test::short_scene, {"analysis.integrator=explicit", "solver.detection_every=1"}),
                testing::IsEmpty());
}

TEST(SceneErrors, AStageNeedsALoadOrGravity) {
    EXPECT_THAT(errors_in(test::short_scene, {"stages=[{name: idle}]"}),
                ElementsAre("--set stages=[{name: idle}]: stages.0: expected a load (pressure, displacement, strain, "
                            "stress or forces) because there is no gravity, found none"));
    EXPECT_THAT(errors_in(test::short_scene, {"stages=[{pressure: {}}]"}), testing::SizeIs(1));
    EXPECT_THAT(errors_in(test::short_scene,
                          {"stages=[{name: weight}]", "analysis.gravity=9.81", "materials.rock.density=2000"}),
                IsEmpty());
}

TEST(SceneErrors, PlatensAreThoseOfAMovedBoundaryInTheSameStage) {
    EXPECT_THAT(errors_in(test::short_scene, {"stages=[{pressure: {left: 1 kPa}, platens: rough}]"}),
                ElementsAre(HasSubstr("stages.0.platens: expected a moved boundary (displacement, strain or stress) in "
                                      "the same stage, found none")));
    EXPECT_THAT(errors_with({"stages=[{pressure: {left: 1 kPa}}, {strength_reduction: {to: 2}, platens: smooth}]"}),
                ElementsAre(HasSubstr("stages.1.platens: expected a moved boundary")));
    EXPECT_THAT(errors_in(test::short_scene, {"stages=[{stress: {boundary: top, value: 1 kPa}, platens: rough}]"}),
                IsEmpty());
}

TEST(SceneErrors, AStrengthReductionGoesUp) {
    EXPECT_THAT(errors_with({"stages=[{pressure: {left: 1 kPa}}, {strength_reduction: {from: 1.5, to: 1.25}}]"}),
                ElementsAre(HasSubstr("stages.1.strength_reduction.to: expected a number > from (1.5), found 1.25")));
}

TEST(SceneErrors, APlatenAndAPressureExcludeEachOtherOnABoundary) {
    EXPECT_THAT(errors_with({"stages.1.pressure={top: 1}"}),
                ElementsAre(HasSubstr("stages.1.strain.boundary: expected a boundary without a pressure in the same "
                                      "stage, found 'top'")));
}

TEST(SceneErrors, TheDomainIsOneOfThreeThings) {
    EXPECT_THAT(
        errors_with({"geometry.domain={rectangle: null}"}),
        ElementsAre(HasSubstr("geometry.domain: expected one of rectangle, polygon, file, found none of them")));
    EXPECT_THAT(errors_with({"geometry.domain.file=a.geojson"}),
                ElementsAre(HasSubstr("geometry.domain: expected one of rectangle, polygon, file, found rectangle and "
                                      "file")));
    EXPECT_THAT(errors_with({"geometry.fractures.0.file=a.geojson"}),
                ElementsAre(HasSubstr("geometry.fractures.0: expected one of trace, file, found trace and file")));
    EXPECT_THAT(errors_with({"geometry.fractures.0.trace=null"}),
                ElementsAre(HasSubstr("geometry.fractures.0: expected one of trace, file, found none of them")));
    EXPECT_THAT(errors_with({"geometry.fractures.0.trace=null", "geometry.fractures.0.trase=[[0, 0], [1, 1]]"}),
                ElementsAre(HasSubstr("found 'trase'; did you mean 'trace'?")));
}

TEST(SceneErrors, AMissingGeometryFileIsReportedWhereItIsNamed) {
    EXPECT_THAT(errors_with({"geometry.domain={rectangle: null, file: nowhere.geojson}"}),
                ElementsAre(AllOf(StartsWith("--set geometry.domain={rectangle: null, file: nowhere.geojson}: "
                                             "geometry.domain.file: "),
                                  HasSubstr("nowhere.geojson"))));
    EXPECT_THAT(errors_with({"geometry.fractures.0={trace: null, file: nowhere.geojson}"}),
                ElementsAre(HasSubstr("geometry.fractures.0.file: ")));
}

TEST(SceneErrors, ARectangleThatVanishesInRoundOffHasNoArea) {
    EXPECT_THAT(errors_in(test::short_scene, {"geometry.domain.rectangle={width: 1e-12, origin: [1e8, 0]}"}),
                ElementsAre(HasSubstr("expected a rectangle with an area")));
}

TEST(SceneErrors, AFactorBeyondAllRangeIsRefusedOnce) {
    EXPECT_THAT(errors_in(test::short_scene, {"stages=[{strain: {boundary: top, value: 1 %}}, "
                                              "{strength_reduction: {from: 1, to: 1e15}}]"}),
                ElementsAre(::testing::EndsWith("found '1e15', which is beyond 1e+09")));
}

TEST(SceneErrors, WallsOfHolesAreNamedOnceAndBesideTheOutline) {
    const std::string hole = "geometry.domain.holes=[{polygon: [[0.2, 0.2], [0.4, 0.2], [0.4, 0.4]]}]";
    const auto errors = [&](const std::string& boundaries) {
        return errors_in(test::short_scene, {hole, "boundaries=" + boundaries});
    };
    EXPECT_THAT(errors("{wall: {hole: 0}, bottom: {support: fixed}}"), IsEmpty());
    EXPECT_THAT(errors("{wall: {hole: 1}}"),
                ElementsAre(HasSubstr("boundaries.wall.hole: expected a hole of the domain from 0 to 0, found 1")));
    EXPECT_THAT(errors("{wall: {hole: 0}, lining: {hole: 0}}"),
                ElementsAre(HasSubstr("boundaries.lining.hole: expected each hole once, found 0 again")));
    EXPECT_THAT(errors("{top: {hole: 0}}"),
                ElementsAre(HasSubstr("boundaries.top.hole: expected a name that no part of the outline has")));
    EXPECT_THAT(errors_in(test::short_scene, {"boundaries={wall: {hole: 0}}"}),
                ElementsAre(HasSubstr("boundaries.wall.hole: expected a domain with holes, found none")));
    EXPECT_THAT(errors_in(test::short_scene, {"geometry.domain.holes=[{polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]}]"}),
                ElementsAre(HasSubstr("geometry.domain.holes.0.polygon: expected a simple polygon")));
}

TEST(SceneErrors, SidesOfAPolygonBelongToOneBoundaryEach) {
    const std::string polygon = "geometry.domain={rectangle: null, polygon: [[0, 0], [1, 0], [1, 2], [0, 2]]}";
    const auto errors = [&](const std::string& boundaries) {
        return errors_in(test::short_scene, {polygon, "boundaries=" + boundaries, "stages.0.strain.boundary=top"});
    };
    EXPECT_THAT(errors("{top: {sides: [2]}, base: {facing: bottom}}"), IsEmpty());
    EXPECT_THAT(errors("{top: {sides: [2, 4]}}"),
                ElementsAre(HasSubstr("boundaries.top.sides: expected sides of the domain from 0 to 3, found 4")));
    EXPECT_THAT(errors("{top: {sides: [2, -1]}}"),
                ElementsAre(HasSubstr("boundaries.top.sides.1: expected an integer >= 0, found '-1'")));
    EXPECT_THAT(errors("{top: {sides: [2]}, roof: {facing: top}}"),
                ElementsAre(HasSubstr("boundaries.roof: expected each side of the domain once, found side 2 again")));
    EXPECT_THAT(errors("{top: {sides: [2]}, roof: {support: fixed}}"),
                ElementsAre(HasSubstr("boundaries.roof: expected one of sides, facing, hole, found none of them")));
    EXPECT_THAT(errors("{top: {sides: [2], facing: top}}"),
                ElementsAre(HasSubstr("boundaries.top: expected one of sides, facing, hole, found sides and facing")));
}

TEST(SceneErrors, NamesAreMadeOfLettersDigitsUnderscoresAndHyphens) {
    EXPECT_THAT(errors_in(test::short_scene + "interfaces: {'a b': {kind: fracture}, 'a.b': {kind: fracture}}\n"),
                ElementsAre(HasSubstr("interfaces.a b: expected a name of letters, digits, '_' and '-', found 'a b'"),
                            HasSubstr("interfaces.a.b: expected a name of letters, digits, '_' and '-', found 'a.b'")));
    EXPECT_THAT(errors_in(test::short_scene + "interfaces: {Klüfte-2_b: {kind: fracture}}\n"), IsEmpty());
}

TEST(SceneErrors, ThePatternsOfTheTableAreNoKeys) {
    EXPECT_THAT(errors_in(test::short_scene + "analysis.plane: strain\n"), testing::SizeIs(1));
    EXPECT_THAT(errors_in(test::short_scene + "'*': 1\n'#': 1\n"), testing::SizeIs(2));
}

TEST(SceneErrors, StopAfterADropNeedsAPlatenOfGivenTravelWhereTheAxialStressIs) {
    EXPECT_THAT(
        errors_with({"stages.0.stop_after_drop=0.2"}),
        ElementsAre(HasSubstr("stages.0.stop_after_drop: expected a displacement or a strain of a platen in the "
                              "same stage, found none")));
    EXPECT_THAT(errors_with({"stages.3.stop_after_drop=0.2"}), ElementsAre(HasSubstr("found none"))); // by stress
    EXPECT_THAT(errors_with({"stages.2.stop_after_drop=0.2"}),
                ElementsAre(HasSubstr("expected a platen on 'top', on which the axial stress is measured because it is "
                                      "moved first, found one on 'right'")));
    EXPECT_THAT(errors_with({"stages.1.stop_after_drop=20 %"}), IsEmpty());
    for (const char* value : {"0", "1", "20"})
        EXPECT_THAT(errors_with({std::string("stages.1.stop_after_drop=") + value}),
                    ElementsAre(HasSubstr("expected a number > 0 and < 1")));
}

} // namespace
} // namespace kluft

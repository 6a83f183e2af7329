#include "kluft/scene/plausibility.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/scene/scene_reader.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

const std::string pressed_block = R"(kluft: 1
materials:
  rock: {density: 2600, youngs_modulus: 10 GPa, poissons_ratio: 0.2}
interfaces:
  joint: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  fractures: [{trace: [[-1, 1], [2, 1]], interface: joint}]
boundaries:
  bottom: {support: smooth}
stages:
  - {pressure: {left: 1 MPa, right: 1 MPa}}
  - {strain: {boundary: top, value: 1 %}}
)";

std::vector<std::string> warnings_of_block_with(const std::vector<std::string>& changes) {
    return read_scene_text(pressed_block, changes).warnings;
}

TEST(ImplausibleValues, RockAndJointsOfUsualValuesAreTakenWithoutAWord) {
    EXPECT_THAT(warnings_of_block_with({}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"materials.rock.youngs_modulus=20 MPa", "materials.rock.density=1500"}),
                IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.normal_stiffness=1e13"}), IsEmpty());
}

TEST(ImplausibleValues, LostUnitsAreTold) {
    EXPECT_THAT(warnings_of_block_with({"materials.rock.youngs_modulus=15"}),
                ElementsAre(AllOf(HasSubstr("materials.rock.youngs_modulus: 15 Pa is softer than any rock or soil"),
                                  HasSubstr("15 GPa?"))));
    EXPECT_THAT(warnings_of_block_with({"materials.rock.youngs_modulus=15e6 MPa"}),
                ElementsAre(HasSubstr("than diamond")));
    EXPECT_THAT(warnings_of_block_with({"materials.rock.density=2.6"}),
                ElementsAre(HasSubstr("the density of no rock")));
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.normal_stiffness=1e15"}),
                ElementsAre(HasSubstr("interfaces.joint.normal_stiffness: 1e+15 Pa/m is stiffer than a millimetre")));
}

TEST(ImplausibleValues, LostUnitsOfStrengthsAndLoadsAreTold) {
    EXPECT_THAT(
        warnings_of_block_with({"interfaces.joint.normal_stiffness=40", "interfaces.joint.shear_stiffness=20 GPa/m"}),
        ElementsAre(HasSubstr("interfaces.joint.normal_stiffness: 40 Pa/m is softer than any joint")));
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.cohesion=0.5"}),
                ElementsAre(HasSubstr(
                    "interfaces.joint.cohesion: 0.5 Pa is next to nothing; is its unit missing, as in 0.5 MPa?")));
    for (const std::string cohesion : {"5", "40"}) // cohesions of joints: 0 to some 100 kPa, rough ones to some MPa
        EXPECT_THAT(warnings_of_block_with({"interfaces.joint.cohesion=" + cohesion}),
                    ElementsAre(HasSubstr("is its unit missing, as in " + cohesion + " kPa?")));
    EXPECT_THAT(
        warnings_of_block_with({"materials.rock.cohesion=40", "materials.rock.friction_angle=45 deg",
                                "materials.rock.tensile_strength=6 MPa"}),
        testing::Contains(HasSubstr("materials.rock.cohesion: 40 Pa is next to nothing; is its unit missing, as in "
                                    "40 MPa?")));
    EXPECT_THAT(warnings_of_block_with({"materials.rock.cohesion=15 MPa", "materials.rock.friction_angle=45 deg",
                                        "materials.rock.tensile_strength=6", "interfaces.bond.kind=potential_crack",
                                        "interfaces.bond.fails_to=joint"}),
                ElementsAre(HasSubstr("materials.rock.tensile_strength: 6 Pa")));
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.friction_angle=0.61"}),
                ElementsAre(HasSubstr("'0.61 rad'?")));
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.friction_angle=0.61 rad"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure={left: 2, right: 2 MPa}"}),
                ElementsAre(HasSubstr("stages.0.pressure.left: 2 Pa")));
    EXPECT_THAT(warnings_of_block_with({"stages.1.strain.value=40 %"}), ElementsAre(HasSubstr("as in '0.4 %'?")));
}

TEST(ImplausibleValues, ALoadThatPullsAndAJointThatNothingHoldsAreTold) {
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure={left: -2 MPa, right: -2 MPa}"}),
                UnorderedElementsAre(HasSubstr("left: -2e+06 Pa pulls"), HasSubstr("right: -2e+06 Pa pulls")));
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.friction_angle=null"}),
                ElementsAre(HasSubstr("slides without resistance")));
    EXPECT_THAT(warnings_of_block_with({"interfaces.joint.friction_angle=0"}), IsEmpty());
}

TEST(ImplausibleValues, ASupportThatASmoothPlatenTakesThePlaceOfIsTold) {
    EXPECT_THAT(warnings_of_block_with({"boundaries.top={support: fixed}"}),
                ElementsAre(HasSubstr("boundaries.top.support: has no effect in stages.1")));
    EXPECT_THAT(warnings_of_block_with({"boundaries.top={support: fixed}", "stages.1.platens=rough"}), IsEmpty());
}

TEST(ImplausibleValues, PressureOnOneSideIsToldWhereNothingStandsAgainstIt) {
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure.right=null"}),
                ElementsAre(AllOf(StartsWith("scene.yaml:12:"), HasSubstr("stages.0.pressure.left: nothing stands"),
                                  HasSubstr("right has neither a pressure nor a support"))));
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure.right=null", "boundaries.right.support=smooth"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure.right=null", "boundaries.bottom.support=fixed"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure.right=null", "stages.1.platens=rough"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"stages.0.pressure.left=0", "stages.0.pressure.right=0"}), IsEmpty());
}

TEST(ImplausibleValues, ABalanceThatLetsFallingBlocksStandIsTold) {
    for (const char* share : {"0.02", "0.3", "0.99"})
        EXPECT_THAT(warnings_of_block_with({std::string("solver.balance=") + share}),
                    ElementsAre(AllOf(HasSubstr("solver.balance: blocks count as balanced with "),
                                      HasSubstr("the default is 1e-3"))))
            << share;
    for (const char* share : {"1e-9", "1e-3", "0.01"})
        EXPECT_THAT(warnings_of_block_with({std::string("solver.balance=") + share}), IsEmpty()) << share;
}

// A body of 25.66 MPa had 29.3 with 0.5.
TEST(ImplausibleValues, AnEventToleranceThatLetsCracksFailTooLateIsTold) {
    for (const char* tolerance : {"0.021", "0.5", "0.999"})
        EXPECT_THAT(warnings_of_block_with({std::string("cracks.event_tolerance=") + tolerance}),
                    ElementsAre(AllOf(HasSubstr("cracks.event_tolerance: potential cracks fail at up to "),
                                      HasSubstr("the default is 2.5e-3"))))
            << tolerance;
    for (const char* tolerance : {"1e-9", "2.5e-3", "0.02"})
        EXPECT_THAT(warnings_of_block_with({std::string("cracks.event_tolerance=") + tolerance}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"cracks.event_tolerance=0.5", "cracks.update=all"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"cracks.event_tolerance=0.5", "solver.accuracy=0.01"}), IsEmpty());
}

// A wall whose factor of safety is 4.579 by the friction of its top brick came to 4.25.
TEST(ImplausibleValues, SymmetricTangentIsToldOfWhereStrengthsAreReduced) {
    const std::string reduction = "stages=[{pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}}, "
                                  "{strength_reduction: {from: 1, to: 2}, steps: 4}]";
    EXPECT_THAT(warnings_of_block_with({reduction, "analysis.gravity=0", "solver.tangent=symmetric"}),
                ElementsAre(HasSubstr("solver.tangent: with symmetric the search may miss equilibria")));
    EXPECT_THAT(warnings_of_block_with({reduction, "analysis.gravity=0"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"solver.tangent=symmetric"}), IsEmpty());
}

TEST(ImplausibleValues, AFactorOfSafetyOfABodyWithoutWeightIsTold) {
    const std::string reduction = "stages.1.strength_reduction={from: 1, to: 2}";
    const std::string alone = "stages.1.strain=null";
    EXPECT_THAT(warnings_of_block_with({reduction, alone}),
                ElementsAre(HasSubstr("materials.rock.density: the body has no weight, for there is no "
                                      "`analysis.gravity`")));
    EXPECT_THAT(warnings_of_block_with({reduction, alone, "analysis.gravity=9.81"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({reduction, alone, "analysis.gravity=0"}), IsEmpty());
}

TEST(ImplausibleValues, AMinimumAreaOfNoCellIsTold) {
    EXPECT_THAT(warnings_of_block_with({"geometry.minimum_area=0.1"}),
                ElementsAre(HasSubstr("geometry.minimum_area: has no effect: it is a fraction of a cell")));
    EXPECT_THAT(warnings_of_block_with({"geometry.minimum_area=0.1", "geometry.reference_spacing=1"}), IsEmpty());
}

// A platen that goes out at once holds nothing, unless something presses its boundary until then: triaxial extension.
// 2 c cos(phi)/(1 + sin(phi)) = 2 MPa cos 40/(1 + sin 40) = 0.9326 MPa.
TEST(ImplausibleValues, TensileStrengthsThatDecideNothingOrAllAreTold) {
    const auto warnings = [](const std::string& tensile_strength, const std::string& criterion) {
        return warnings_of_block_with({"materials.rock.cohesion=1 MPa", "materials.rock.friction_angle=40",
                                       "materials.rock.tensile_strength=" + tensile_strength,
                                       "interfaces.bond.kind=potential_crack", "interfaces.bond.fails_to=joint",
                                       "geometry.tessellation={triangles: {spacing: 0.2}, interface: bond}",
                                       "cracks.criterion=" + criterion});
    };
    EXPECT_THAT(warnings("0.9 MPa", "principal_stress"), IsEmpty());
    EXPECT_THAT(
        warnings("1.1 MPa", "principal_stress"),
        ElementsAre(HasSubstr("1.1 MPa is never reached where a body is pulled one way: by principal stresses it "
                              "fails in shear at 2 c cos(phi)/(1 + sin(phi)), 0.9326 MPa")));
    EXPECT_THAT(warnings("1.1 MPa", "interface_traction"), IsEmpty());
    EXPECT_THAT(warnings("0", "principal_stress"),
                ElementsAre(HasSubstr("0 Pa lets the net's bonds fail as soon as the body is loaded")));
}

// With 20 GPa and a nu 1e-10 below 0.5 the factor of safety of a jointed slope of 20 m is 1.285 for 1.268.
TEST(ImplausibleValues, BlocksThatAreNearlyIncompressibleAreTold) {
    const auto warnings = [](const std::string& ratio, std::vector<std::string> changes = {}) {
        changes.push_back("materials.rock.poissons_ratio=" + ratio);
        return warnings_of_block_with(changes);
    };
    EXPECT_THAT(warnings("0.4999999999"),
                ElementsAre(HasSubstr("materials.rock.poissons_ratio: 0.4999999999 is so near to 0.5")));
    for (const char* ratio : {"0.49", "0.4999", "0.499999"}) EXPECT_THAT(warnings(ratio), IsEmpty()) << ratio;
    EXPECT_THAT(warnings("0.4999999999", {"analysis.plane=stress"}), IsEmpty()); // E/(1 - nu) is no large number
}

// A slope without a net came out with a factor of safety "above 8" in place of 1.532.
TEST(ImplausibleValues, StrengthsOfAMaterialThatNoPotentialCrackTakesAreTold) {
    const auto warnings = [](std::vector<std::string> changes) {
        changes.insert(changes.end(), {"materials.rock.cohesion=100 kPa", "materials.rock.friction_angle=40",
                                       "materials.rock.tensile_strength=20 kPa"});
        return warnings_of_block_with(changes);
    };
    EXPECT_THAT(warnings({}), ElementsAre(AllOf(HasSubstr("materials.rock.cohesion: has no effect, nor have "
                                                          "friction_angle and tensile_strength: no interface is a "
                                                          "potential crack"),
                                                HasSubstr("`geometry.tessellation`"))));
    EXPECT_THAT(warnings({"interfaces.bond={kind: potential_crack, fails_to: joint}",
                          "geometry.tessellation={triangles: {spacing: 0.2}, interface: bond}"}),
                IsEmpty());
    EXPECT_THAT(warnings({"interfaces.bond={kind: potential_crack, fails_to: joint}"}), IsEmpty())
        << "what all variants of a body have in common may be in one file";
    EXPECT_THAT(warnings({"interfaces.bond={kind: potential_crack, fails_to: joint, cohesion: 1 MPa, friction_angle: "
                          "30, tensile_strength: 1 MPa}"}),
                ElementsAre(HasSubstr("tensile_strength: each potential crack has a strength of its own")));
}

TEST(PlatenThatGoesOut, IsWarnedOfWhereNothingPressesItsBoundary) {
    EXPECT_THAT(warnings_of_block_with({"stages.1.strain.value=-0.1 %"}),
                ElementsAre(HasSubstr("the platen leaves the body")));
    EXPECT_THAT(warnings_of_block_with({"stages.1.strain.value=-0.1 %", "stages.0.pressure.top=1 MPa"}), IsEmpty());
    EXPECT_THAT(warnings_of_block_with({"stages=[{pressure: {top: 1 MPa}}, {pressure: {top: 0}}, "
                                        "{strain: {boundary: top, value: -0.1 %}}]"}),
                ElementsAre(HasSubstr("the platen leaves the body")));
    EXPECT_THAT(warnings_of_block_with({"stages=[{pressure: {top: 0}}, {pressure: {top: 1 MPa}}, "
                                        "{strain: {boundary: top, value: -0.1 %}}]"}),
                IsEmpty());
}

} // namespace
} // namespace kluft

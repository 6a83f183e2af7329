// What a net does not do in silence: stiffness of joints, locking, a ratio of stiffnesses outside the good range.
#include "kluft/scene/net_check.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/constitutive/net_kind.hpp"
#include "kluft/scene/scene_model.hpp"
#include "scene/scene_text.hpp"

namespace kluft {
namespace {

using test::errors_in;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const std::string net_of_cracks = R"(kluft: 1
materials:
  rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.2, cohesion: 1 MPa, friction_angle: 40, tensile_strength: 0.9 MPa}
  soil: {youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 1 MPa, friction_angle: 40, tensile_strength: 0.9 MPa}
interfaces:
  joint: {kind: fracture, friction_angle: 25}
  bond: {kind: potential_crack, fails_to: joint}
geometry:
  domain: {rectangle: {width: 2, height: 4}}
  material: rock
  tessellation: {hexagons: {spacing: 0.5}, interface: bond}
stages: [{strain: {boundary: top, value: 1 %}}]
)";

std::vector<std::string> warnings_with(const std::vector<std::string>& changes) {
    return read_scene_text(net_of_cracks, changes).warnings;
}

// ---- several materials, and rock outside a net ----

std::vector<std::string> warnings_when_cut(const std::vector<std::string>& changes) {
    return build_scene_model(read_scene_text(net_of_cracks, changes)).model.warnings;
}

// The net's stiffness follows from the largest E of the body: beside 10 GPa the cells of 1 GPa have a ratio of 100.
TEST(NetCheck, WarnsOfMaterialsMuchSofterThanTheStiffest) {
    const std::string half = "geometry.regions=[{polygon: [[0, 2], [2, 2], [2, 4], [0, 4]], material: soil}]";
    const std::string all = "geometry.regions=[{polygon: [[0, 0], [2, 0], [2, 4], [0, 4]], material: soil}]";
    EXPECT_THAT(warnings_when_cut({half}),
                Contains(AllOf(HasSubstr("interfaces.bond: k_n d/E is 100 with the E of soil"),
                               HasSubstr("since the stiffness follows from that of rock"))));
    const auto told = Contains(HasSubstr("since the stiffness follows"));
    EXPECT_THAT(warnings_when_cut({half, "materials.soil.youngs_modulus=6 GPa"}), Not(told));
    EXPECT_THAT(warnings_when_cut({}), Not(told));    // no block is of soil
    EXPECT_THAT(warnings_when_cut({all}), Not(told)); // no block is of rock
}

TEST(NetCheck, WarnsOfRockOutsideANet) {
    const std::string region = "geometry.tessellation.region=[[0, 0], [2, 0], [2, 2], [0, 2]]";
    EXPECT_THAT(warnings_when_cut({region}), Contains(AllOf(HasSubstr("geometry.tessellation.region"),
                                                            HasSubstr("% of the body lie outside the net"),
                                                            HasSubstr("the moduli of the net's cells"))));
    EXPECT_THAT(warnings_when_cut({region, "interfaces.bond.normal_stiffness=200 GPa/m",
                                   "interfaces.bond.shear_stiffness=100 GPa/m"}),
                Contains(AllOf(HasSubstr("each with one uniform strain: they"), Not(HasSubstr("the moduli of")))));
    const auto told = Contains(HasSubstr("outside the net"));
    EXPECT_THAT(warnings_when_cut({}), Not(told));
    EXPECT_THAT(warnings_when_cut({"geometry.tessellation.region=[[-1, -1], [3, -1], [3, 5], [-1, 5]]"}), Not(told));
}

// ---- stiffness of mapped fractures ---------------------------------------------------------------------------------

const std::string fracture_along_the_joint =
    "geometry.fractures=[{name: main, trace: [[0, 1], [2, 3]], interface: joint}]";

TEST(JointStiffness, OfAMappedFractureIsNeverTheNets) {
    EXPECT_THAT(
        errors_in(net_of_cracks, {fracture_along_the_joint}),
        ElementsAre(StartsWith("scene.yaml:6:10: interfaces.joint.normal_stiffness: expected a number > 0 in Pa/m "
                               "(or a normal_stiffness_times_spacing or a stiffness_ratio) because the mapped "
                               "fracture 'main' has this interface, and the stiffness of a joint does not follow "
                               "from the net; found nothing\n")));
    EXPECT_THAT(errors_in(net_of_cracks, {fracture_along_the_joint, "interfaces.joint.shear_ratio=0.4"}),
                ElementsAre(HasSubstr("interfaces.joint.normal_stiffness: expected")));
    EXPECT_THAT(errors_in(net_of_cracks,
                          {fracture_along_the_joint, "geometry.tessellation=null", "geometry.reference_spacing=0.5"}),
                ElementsAre(HasSubstr("interfaces.joint.normal_stiffness: expected")));
}

TEST(JointStiffness, MayBeGivenInEachOfTheThreeWays) {
    for (const auto& stiffness : std::vector<std::vector<std::string>>{
             {"interfaces.joint.stiffness_ratio=10"},
             {"interfaces.joint.normal_stiffness=1 GPa/m", "interfaces.joint.shear_stiffness=1 GPa/m"},
             {"interfaces.joint.normal_stiffness_times_spacing=1 GPa",
              "interfaces.joint.shear_stiffness_times_spacing=1 GPa"}}) {
        std::vector<std::string> changes{fracture_along_the_joint};
        changes.insert(changes.end(), stiffness.begin(), stiffness.end());
        EXPECT_THAT(errors_in(net_of_cracks, changes), IsEmpty());
    }
}

TEST(JointStiffness, OfAPartThatIsNewIsWhatItFailsToAsWell) {
    const std::string new_part = "geometry.fractures=[{name: new, trace: [[0, 1], [2, 3]], interface: bond}]";
    EXPECT_THAT(
        errors_in(net_of_cracks, {new_part}),
        ElementsAre(AllOf(HasSubstr("interfaces.joint.normal_stiffness: "), HasSubstr("'new' fails to it")),
                    AllOf(HasSubstr("interfaces.bond.normal_stiffness: "), HasSubstr("'new' has this interface"))));
    EXPECT_THAT(errors_in(net_of_cracks,
                          {new_part, "interfaces.bond.stiffness_ratio=10", "interfaces.joint.stiffness_ratio=10"}),
                IsEmpty());
}

TEST(JointStiffness, OfTheNetAloneHasADefault) { EXPECT_THAT(errors_in(net_of_cracks), IsEmpty()); }

// ---- k_n d/E -------------------------------------------------------------------------------------------------------

// d = 0.5 m and E = 10 GPa: k_n d/E = 1 is 20 GPa/m, or 10 GPa.
TEST(NetStiffness, OutsideTheGoodRangeIsWarnedOfInWhicheverWayItIsGiven) {
    const std::string below =
        ", outside the good range of a net of hexagons, 5 to 20: below it the joints carry most of the "
        "deformation";
    const std::string above =
        ", outside the good range of a net of hexagons, 5 to 20: above it affine blocks are too stiff in "
        "bending, and a body without strength noise fails everywhere at once";
    EXPECT_THAT(
        warnings_with({"interfaces.bond.stiffness_ratio=4"}),
        ElementsAre("--set interfaces.bond.stiffness_ratio=4: interfaces.bond.stiffness_ratio: k_n d/E is 4" + below));
    EXPECT_THAT(warnings_with({"interfaces.bond.stiffness_ratio=21"}), ElementsAre(EndsWith("k_n d/E is 21" + above)));
    EXPECT_THAT(warnings_with({"interfaces.bond.normal_stiffness=20 GPa/m", "interfaces.bond.shear_stiffness=1e9"}),
                ElementsAre(EndsWith("interfaces.bond.normal_stiffness: k_n d/E is 1 with the E of rock" + below)));
    EXPECT_THAT(warnings_with({"interfaces.bond.normal_stiffness_times_spacing=300 GPa",
                               "interfaces.bond.shear_stiffness_times_spacing=1e9"}),
                ElementsAre(EndsWith(
                    "interfaces.bond.normal_stiffness_times_spacing: k_n d/E is 30 with the E of rock" + above)));
}

TEST(NetStiffness, WithinTheGoodRangeIsNot) {
    for (const char* ratio : {"5", "10", "20"})
        EXPECT_THAT(warnings_with({std::string("interfaces.bond.stiffness_ratio=") + ratio}), IsEmpty());
    for (const char* stiffness : {"100 GPa/m", "400 GPa/m"})
        EXPECT_THAT(warnings_with({std::string("interfaces.bond.normal_stiffness=") + stiffness,
                                   "interfaces.bond.shear_stiffness=50 GPa/m"}),
                    IsEmpty());
    EXPECT_THAT(warnings_with({}), IsEmpty());
}

TEST(NetStiffness, OfAJointOrWithoutANetIsNot) {
    EXPECT_THAT(warnings_with({"interfaces.joint.stiffness_ratio=0.1", fracture_along_the_joint}), IsEmpty());
    EXPECT_THAT(warnings_with({"geometry.tessellation=null"}), IsEmpty());
}

// E of the soil is a tenth.
TEST(NetStiffness, IsComparedWithEachMaterialOfTheBody) {
    const std::vector<std::string> given{"interfaces.bond.normal_stiffness=200 GPa/m",
                                         "interfaces.bond.shear_stiffness=1e11"};
    EXPECT_THAT(warnings_with(given), IsEmpty());
    std::vector<std::string> layered = given;
    layered.emplace_back("geometry.regions=[{polygon: [[0, 0], [2, 0], [2, 2], [0, 2]], material: soil}]");
    EXPECT_THAT(warnings_with(layered), ElementsAre(HasSubstr("k_n d/E is 100 with the E of soil, outside")));
}

// They do not bend.
TEST(NetStiffness, OfRigidBlocksMayBeAnyThatIsStiffEnough) {
    const std::string rigid = "analysis.kinematics=rigid";
    EXPECT_THAT(warnings_with({rigid, "interfaces.bond.stiffness_ratio=100"}), IsEmpty());
    EXPECT_THAT(warnings_with({rigid, "interfaces.bond.stiffness_ratio=2"}), IsEmpty());
    const auto given = [&](const std::string& stiffness) {
        return warnings_with(
            {rigid, "interfaces.bond.normal_stiffness=" + stiffness, "interfaces.bond.shear_stiffness=1e10"});
    };
    EXPECT_THAT(given("20 GPa/m"), ElementsAre(HasSubstr("below it")));
    EXPECT_THAT(given("2000 GPa/m"), IsEmpty());
}

// ---- locking -------------------------------------------------------------------------------------------------------

TEST(NetOfCracks, ThatMayLockIsWarnedOf) {
    EXPECT_THAT(warnings_with({"interfaces.joint.friction_angle=27.9"}), IsEmpty());
    EXPECT_THAT(
        warnings_with({"interfaces.joint.friction_angle=28"}),
        ElementsAre(AllOf(StartsWith("--set interfaces.joint.friction_angle=28: interfaces.joint.friction_angle: 28 "
                                     "deg lets the net lock: hexagons interlock"),
                          EndsWith("geometry.tessellation.triangles keeps the strength of the rock"))));
    EXPECT_THAT(warnings_with({"interfaces.joint.friction_angle=35", "geometry.tessellation.hexagons=null",
                               "geometry.tessellation.voronoi.spacing=0.5"}),
                ElementsAre(HasSubstr("35 deg lets the net lock: Voronoi cells interlock")));
}

TEST(NetOfCracks, OnlyOfPotentialCracks) {
    EXPECT_THAT(warnings_with({"interfaces.joint.friction_angle=35", "geometry.tessellation.interface=joint"}),
                IsEmpty());
    EXPECT_THAT(warnings_with({"interfaces.joint.friction_angle=35", "geometry.tessellation=null"}), IsEmpty());
}

TEST(NetKinds, AreToldApart) {
    Tessellation net;
    EXPECT_EQ(net_kind(net), NetKind::hexagons);
    net.voronoi = VoronoiCells{};
    EXPECT_EQ(net_kind(net), NetKind::voronoi);
}

// ---- triangles -----------------------------------------------------------------------------------------------------

TEST(NetOfTriangles, DoesNotLockAndHasItsOwnRange) {
    const auto with = [](const std::string& change) {
        return warnings_with({"geometry.tessellation.hexagons=null", "geometry.tessellation.triangles={spacing: 0.5}",
                              "interfaces.joint.friction_angle=40", change});
    };
    EXPECT_THAT(with("interfaces.bond.stiffness_ratio=30"), IsEmpty());
    EXPECT_THAT(with("interfaces.bond.stiffness_ratio=5"),
                ElementsAre(HasSubstr("k_n d/E is 5, outside the good range of a net of triangles, 10 to 60")));
    EXPECT_THAT(with("analysis.kinematics=rigid"),
                ElementsAre(HasSubstr("intact rock cut into rigid triangles fails at 72 to 81 % of its strength")));
}

// 3 cm and 3 mm without their units, in a body of 2 m by 4 m in which 3 m are no more than one cell.
TEST(NetCheck, WarnsOfCellsLargerThanTheBody) {
    const auto with = [](const std::string& cells, const std::string& spacing) {
        return warnings_with({"interfaces.joint.friction_angle=20", "geometry.tessellation.hexagons=null",
                              "geometry.tessellation." + cells + "={spacing: " + spacing + "}"});
    };
    for (const std::string cells : {"triangles", "hexagons", "voronoi"}) {
        EXPECT_THAT(with(cells, "3"),
                    Contains(AllOf(HasSubstr("geometry.tessellation." + cells +
                                             ".spacing: 3 m is more than the smaller extent of the body, 2 m"),
                                   EndsWith("is its unit missing, as in '3 cm' or '3 mm'?"))));
        EXPECT_THAT(with(cells, "300"), Contains(EndsWith("is its unit missing, as in '300 mm'?")));
        EXPECT_THAT(with(cells, "3 m"), Contains(EndsWith("hardly an edge of the net lies in it")));
        EXPECT_THAT(with(cells, "1.9"), Not(Contains(HasSubstr("the smaller extent of the body"))));
    }
}

} // namespace
} // namespace kluft

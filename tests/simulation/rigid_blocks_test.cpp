#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "support/scene_run.hpp"
#include "support/slope_scene.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

const std::vector<std::string> rigid_blocks{"analysis.kinematics=rigid"};

// Love-Weber: the mean stress of a block that stands on its base is half of that under it, rho g h/2.
TEST(RigidBlocksRun, HistoryOfARigidBlockHasTheStressOfItsForces) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {plane: stress, kinematics: rigid}
materials: {rock: {youngs_modulus: 1e10, poissons_ratio: 0, density: 2500}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle: 30, contact_rounding: 0}}
geometry:
  blocks:
    - {name: base, polygon: [[-1, -1], [3, -1], [3, 0], [-1, 0]], support: fixed}
    - {name: top, polygon: [[0, 0], [2, 0], [2, 1], [0, 1]]}
stages: [{steps: 2, gravity: 10}]
solver: {tolerance: 1e-10, balance: 1e-9}
output: {histories: {b: {block: top}}}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const auto& values = run.history.back().histories; // displacement_x, _y, rotation, stress_xx, _yy, _xy
    ASSERT_EQ(values.size(), 6U);
    EXPECT_NEAR(values[4], 2500.0 * 10.0 * 1.0 / 2, 1e-6 * 12500.0);
    EXPECT_NEAR(values[3], 0.0, 1e-6 * 12500.0);
}

// Statics: N = W cos(slope), T = W sin(slope) below the friction angle; no equilibrium above it.
TEST(RigidBlocksRun, RigidBlockOnASlopeCarriesItsWeightAcrossAndAlongTheJoint) {
    const double weight = 2500.0 * 10.0 * 4.0 * 1.0;
    for (const double slope : {0.0, 12.0, 29.99}) {
        const auto run = run_scene(block_on_slope(4.0, 1.0, slope), rigid_blocks);
        ASSERT_TRUE(stands(run)) << slope << run.report.diagnosis;
        const auto& joint = run.fields.back().interfaces.front();
        EXPECT_NEAR(-joint.normal_traction * 4.0, weight * std::cos(slope * degree), 1e-6 * weight);
        EXPECT_NEAR(std::abs(joint.shear_traction) * 4.0, weight * std::sin(slope * degree), 1e-6 * weight);
    }
    EXPECT_FALSE(stands(run_scene(block_on_slope(4.0, 1.0, 30.01), rigid_blocks)));
}

// A pressure p on its side of height H turns a block of width b over at p H = W b/H.
TEST(RigidBlocksRun, RigidBlockTurnsOverWhereItsWeightCannotBalanceThePush) {
    const double width = 0.5, height = 1.5;
    const double limit = 2500.0 * 10.0 * width * height * width / height / height;
    for (const double share : {0.995, 1.005}) {
        const auto run =
            run_scene(block_on_slope(width, height, 0.0),
                      {"analysis.kinematics=rigid", fmt::format("stages.0.pressure={{left: {:.17g}}}", share * limit)});
        EXPECT_EQ(stands(run), share < 1.0);
    }
}

// Springs in series: joint i closes by the weight above it over k_n L.
TEST(RigidBlocksRun, StackOfRigidBlocksSettlesByTheWeightAboveEachJoint) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {kinematics: rigid, gravity: 10}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30, contact_rounding: 0}}
geometry:
  domain: {rectangle: {width: 2.0, height: 5.0}}
  fractures:
    - {trace: [[-1, 1], [3, 1]], interface: joint}
    - {trace: [[-1, 2], [3, 2]], interface: joint}
    - {trace: [[-1, 3], [3, 3]], interface: joint}
    - {trace: [[-1, 4], [3, 4]], interface: joint}
  reference_spacing: 1.0
boundaries: {bottom: {support: smooth}}
stages: [{name: weight, steps: 2}]
solver: {tolerance: 1e-11, balance: 1e-9}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const double block_weight = 2500.0 * 10.0 * 2.0;
    double closure = 0.0;
    for (int above = 1; above <= 4; ++above) closure += above * block_weight / (1e9 * 2.0);
    double settled = 0.0;
    for (const auto& joint : run.fields.back().interfaces) settled -= joint.gap;
    EXPECT_NEAR(settled, closure, 1e-6 * closure);
    // Love-Weber: the vertical stress of a block is the mean of the tractions on its two faces.
    const BlockSystem& system = run.model.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double above = 5.0 - (system.origin.y() + system.blocks[b].centroid.y());
        EXPECT_NEAR(run.fields.back().stress[b](1, 1), -2500.0 * 10.0 * above, 1.0) << b;
        EXPECT_NEAR(fields_of_state(run.model, run.state).stress[b](1, 1), -2500.0 * 10.0 * above, 1.0) << b;
    }
}

std::string hexagons_under_a_platen(const std::string& kinematics) {
    return fmt::format(R"(
kluft: 1
analysis: {{kinematics: {}}}
materials: {{rock: {{youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 0.15 MPa, friction_angle: 40, tensile_strength: 0.05 MPa}}}}
interfaces:
  net: {{kind: potential_crack, fails_to: joint}}
  joint: {{kind: fracture, normal_stiffness_times_spacing: 1 GPa, shear_stiffness_times_spacing: 0.5 GPa, friction_angle: 38, contact_rounding: 4 kPa}}
geometry:
  domain: {{rectangle: {{width: 0.4, height: 0.8}}}}
  fractures: [{{trace: [[-0.1, 0.1], [0.5, 0.7]], interface: joint}}]
  tessellation: {{hexagons: {{spacing: 0.08}}, interface: net}}
boundaries: {{bottom: {{support: pinned}}}}
stages:
  - {{name: pressure, pressure: {{left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}}, steps: 1}}
  - {{name: platen, strain: {{boundary: top, value: 0.2 %}}, steps: 5}}
)",
                       kinematics);
}

// The same body, loads and strengths: rigid hexagons with the compliance in their interfaces are as stiff as affine ones
// but for the halves of hexagons at the outline, which are not those of a lattice, and they crack.
TEST(SlowRigidBlocksRun, BodyOfRigidHexagonsDeformsAndCracksAboutAsAnAffineOne) {
    const auto rigid = run_scene(hexagons_under_a_platen("rigid"));
    const auto affine = run_scene(hexagons_under_a_platen("affine"));
    ASSERT_EQ(rigid.report.status, RunStatus::done) << rigid.report.diagnosis;
    ASSERT_EQ(affine.report.status, RunStatus::done) << affine.report.diagnosis;
    EXPECT_NEAR(rigid.history[2].axial_stress, affine.history[2].axial_stress, 0.06 * affine.history[2].axial_stress);
    EXPECT_FALSE(rigid.cracks.empty());
    EXPECT_FALSE(affine.cracks.empty());
    for (int b = 0; b < rigid.model.system.n_blocks(); ++b) {
        const double size = rigid.model.system.blocks[b].size;
        EXPECT_NEAR(deformation_gradient(rigid.state.body.displacement, b, size).determinant(), 1.0, 1e-14);
    }
}

// A factorization of three unknowns per block instead of six, with and without the factor kept.
TEST(RigidBlocksRun, FactorThatIsKeptLeadsToTheSameStateAsOneMadeAnew) {
    const auto kept = run_scene(hexagons_under_a_platen("rigid"), {"stages.1.steps=2", "stages.1.strain.value=0.05 %",
                                                                   "solver.tolerance=1e-10", "solver.balance=1e-8"});
    const auto anew = run_scene(hexagons_under_a_platen("rigid"),
                                {"stages.1.steps=2", "stages.1.strain.value=0.05 %", "solver.tolerance=1e-10",
                                 "solver.balance=1e-8", "solver.reuse=false"});
    ASSERT_TRUE(stands(kept)) << kept.report.diagnosis;
    ASSERT_TRUE(stands(anew)) << anew.report.diagnosis;
    EXPECT_NEAR(kept.history.back().axial_stress, anew.history.back().axial_stress,
                1e-6 * anew.history.back().axial_stress);
    EXPECT_LT(kept.report.costs.factorizations, anew.report.costs.factorizations);
}

// A platen under a given stress: the sum of the forces on it is stress times width.
TEST(RigidBlocksRun, PlatenUnderAGivenStressPressesRigidBlocksWithIt) {
    const auto run = run_scene(hexagons_under_a_platen("rigid"),
                               {"stages.1.strain=null", "stages.1.stress={boundary: top, value: 0.4 MPa}",
                                "solver.tolerance=1e-9", "solver.balance=1e-6"});
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    EXPECT_NEAR(run.history.back().axial_stress, 0.4e6, 1.0);
}

/// E' and nu' in the middle of a strip of hexagons between smooth platens, whose ends are too far away to be felt.
std::pair<double, double> moduli_in_the_middle(const std::string& kinematics) {
    const auto run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: strain, kinematics: {}}}
materials: {{rock: {{youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 1 GPa, friction_angle: 30, tensile_strength: 1 GPa}}}}
interfaces:
  bond: {{kind: potential_crack, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, fails_to: joint}}
  joint: {{kind: fracture, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, friction_angle: 30}}
geometry:
  domain: {{rectangle: {{width: 1.8, height: 0.15588457268119895}}}}
  tessellation: {{hexagons: {{spacing: 0.03, offset: [0.0075, 0]}}, interface: bond}}
boundaries: {{bottom: {{support: pinned}}}}
stages: [{{strain: {{boundary: top, value: 1e-7}}}}]
solver: {{tolerance: 1e-12, balance: 1e-9, viscosity: 0}}
)",
                                           kinematics));
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    const BlockSystem& system = run.model.system;
    const double row = 0.03 * std::sqrt(3.0) / 2.0;
    const auto nearest = [&](const Vec2& place) {
        int best = 0;
        for (int b = 0; b < system.n_blocks(); ++b)
            if ((system.origin + system.blocks[b].centroid - place).norm() <
                (system.origin + system.blocks[best].centroid - place).norm())
                best = b;
        return best;
    };
    const int middle = nearest({0.9, 2 * row});
    const Vec2 at = system.origin + system.blocks[middle].centroid;
    const auto motion = [&](const Vec2& place) {
        return Vec2(run.state.body.displacement.segment<2>(n_block_unknowns * nearest(place)));
    };
    const double strain_x = (motion(at + Vec2(0.03, 0)) - motion(at - Vec2(0.03, 0))).x() / 0.06;
    const double strain_y = (motion(at + Vec2(0, 2 * row)) - motion(at)).y() / (2 * row);
    return {run.fields.back().stress[middle](1, 1) / strain_y, -strain_x / strain_y};
}

// 2K_eff = 2400/13 MPa, 2G_eff = 2400/18 MPa of the reference set; E' = 2 (2K)(2G)/(2K + 2G), nu' = (K - G)/(K + G). To the
// strain of 1e-7, that the affine law is linear in only.
TEST(RigidBlocksRun, RigidHexagonsOnGivenStiffnessesAreAsStiffAsAffineOnes) {
    const double bulk = 2400e6 / 13.0, shear = 2400e6 / 18.0;
    for (const char* kinematics : {"affine", "rigid"}) {
        const auto [modulus, ratio] = moduli_in_the_middle(kinematics);
        EXPECT_NEAR(modulus / (2 * bulk * shear / (bulk + shear)), 1.0, 1e-7) << kinematics;
        EXPECT_NEAR(ratio, (bulk - shear) / (bulk + shear), 1e-7) << kinematics;
    }
}

// 1/(2K) and 1/(4G) of the blocks in series, by hand: with k_n d = 1 GPa, k_s d = 0.5 GPa of the joint and blocks of
// (19) to (22), E = 1 GPa, nu = 0.2, k_n d/E = 10, r = 0.5.
TEST(SlowRigidBlocksRun, OnlyTheNetAndItsBrokenEdgesCarryTheComplianceOfBlocks) {
    const Model model = run_scene(hexagons_under_a_platen("rigid"), {"stages.1.steps=1"}).model;
    const double d = 0.08;
    const double bulk = 1e9 / (1.2 * 0.6), shear = 1e9 / 1.2; // 2K, 2G of the rock
    ASSERT_EQ(model.laws.size(),
              3U); // in the order of their names or as in the scene: the net, the joint, broken edges
    EXPECT_NEAR(model.laws[0].normal_stiffness * d, bulk, 1e-6 * bulk);
    EXPECT_NEAR(model.laws[0].shear_stiffness * d, 2 * shear - bulk, 1e-6 * bulk);
    EXPECT_EQ(model.laws[1].normal_stiffness * d, 1e9);
    EXPECT_EQ(model.laws[1].shear_stiffness * d, 0.5e9);
    const double normal = 1.0 / (1.0 / 1e9 + 1.0 / bulk - 1.0 / 10e9);
    const double sum = 1.0 / (1.0 / 1.5e9 + 0.5 / shear - 1.0 / 15e9);
    EXPECT_NEAR(model.laws[2].normal_stiffness * d, normal, 1e-6 * normal);
    EXPECT_NEAR(model.laws[2].shear_stiffness * d, sum - normal, 1e-6 * normal);
    EXPECT_EQ(model.laws[2].tan_friction, model.laws[1].tan_friction);
    EXPECT_EQ(model.fracture_law[0], 2);
    EXPECT_EQ(model.law_types[2], 1);
}

TEST(SlowRigidBlocksRun, RigidHexagonsHaveTheRocksModuliWithAnyStiffnessRatio) {
    const auto stiffness = [](const std::vector<std::string>& overrides) {
        return run_scene(hexagons_under_a_platen("rigid"), overrides).model.laws[0].normal_stiffness;
    };
    EXPECT_EQ(stiffness({"stages.1.steps=1"}), stiffness({"stages.1.steps=1", "interfaces.net.stiffness_ratio=7"}));
}

TEST(RigidBlocksRun, WhatRigidHexagonsCannotBeIsRefused) {
    const auto message = [](const std::vector<std::string>& overrides) -> std::string {
        try {
            (void)run_scene(hexagons_under_a_platen("rigid"), overrides);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_THAT(message({"materials.rock.poissons_ratio=0.3"}), testing::HasSubstr("less than 1/4 in plane strain"));
    EXPECT_THAT(message({"materials.rock.poissons_ratio=0.4", "interfaces.net.normal_stiffness_times_spacing=50 GPa",
                         "interfaces.net.shear_stiffness_times_spacing=20 GPa"}),
                testing::HasSubstr("largest admissible one is 0.2522"));
    EXPECT_THAT(message({"analysis.integrator=explicit"}), testing::HasSubstr("affine"));
    EXPECT_THAT(
        message({"materials.soft={youngs_modulus: 0.5 GPa, poissons_ratio: 0.2, cohesion: 1, friction_angle: 30, "
                 "tensile_strength: 1}",
                 "geometry.material=rock",
                 "geometry.regions=[{polygon: [[0, 0], [0.4, 0], [0.4, 0.4], [0, 0.4]], material: soft}]"}),
        testing::HasSubstr("expected youngs_modulus and poissons_ratio of"));
}

} // namespace
} // namespace kluft

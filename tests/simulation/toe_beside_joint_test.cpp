// Blocks whose toe stands on the end of a joint and has sunk beside the next block before strengths are reduced: that block holds them.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/core/units.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

constexpr double weight_of_rock = 2600.0 * 9.81; // N/m3
const double tan_of_joint = std::tan(35.0 / degrees);

/// A block of 5 m by 6 m on one that slides into a slot under the weights, on a plane of 20 degrees and a friction of 15. So the first block sinks by about a third of
/// the slot's width beside a slab of 5 m by 1 m, towards which it is pushed.
SceneRun block_beside_slab(double slot, double push) {
    const double below_slot = -1.0 - (6.0 + slot) * std::tan(20.0 / degrees);
    const double at_slot = -1.0 - 6.0 * std::tan(20.0 / degrees);
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 35 deg}}
  slip: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 15 deg}}
geometry:
  domain: {{polygon: [[-9, -7], [9, -7], [9, 0], [{0:.17g}, 0], [{0:.17g}, {1:.17g}], [6, {2:.17g}], [6, 0], [5, 0], [5, 6], [0, 6], [0, 0], [-5, 0], [-5, -1], [-9, -1]]}}
  fractures:
    - {{trace: [[0, 0], [5, 0]], interface: joint}}
    - {{trace: [[0, 0], [0, -1]], interface: joint}}
    - {{trace: [[0, -1], [6, {2:.17g}]], interface: slip}}
    - {{trace: [[-5, -1], [0, -1]], interface: joint}}
boundaries: {{bottom: {{sides: [0], support: fixed}}}}
stages:
  - {{steps: 5}}
  - {{forces: {{push: {{point: [3.5, 1.5], force: [{3:.17g}, 0]}}}}, steps: 5}}
  - {{strength_reduction: {{from: 1, to: 8}}}}
)",
                                 6.0 + slot, below_slot, at_slot, -push));
}

// The push brings the block to the slab, and both slide on their bases before the block could ride up. Where no count was taken of the slab's side the factor was
// below the start.
TEST(ToeBesideJoint, PushesTheBlockBesideWhichItHasSunk) {
    constexpr double block = 30.0 * weight_of_rock, slab = 5.0 * weight_of_rock;
    for (const double slot : {0.02, 0.05, 0.2})
        for (const double of_base : {0.9, 0.95}) { // the factor of the block's base alone
            const double push = tan_of_joint * block / of_base;
            const double expected = tan_of_joint * (block + slab) / push;
            const SceneRun run = block_beside_slab(slot, push);
            SCOPED_TRACE(fmt::format("{} {}", slot, of_base));
            ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
            EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 1e-3 * expected);
        }
}

/// A block that leans out over ground that rises from its toe, on two wedges, pushed towards them; `net`: the key of a net in that block, or nothing.
SceneRun leaning_block(const std::string& net) {
    return run_scene(R"(kluft: 1
analysis: {gravity: 9.81}
materials:
  concrete: {density: 2400, youngs_modulus: 20 GPa, poissons_ratio: 0.2}
  rock: {density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.2}
interfaces:
  base: {kind: fracture, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m, friction_angle: 34.0852 deg}
  joint: {kind: fracture, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m, friction_angle: 50.3065 deg}
  slip: {kind: fracture, normal_stiffness: 1000 GPa/m, shear_stiffness: 500 GPa/m, friction_angle: 44.7276 deg}
  bond: {kind: potential_crack, cohesion: 1 GPa, friction_angle: 50, tensile_strength: 0.8 GPa, fails_to: slip}
geometry:
  material: rock
  sets:
    ground: {polygon: [[14.12435, -2.490504], [7.062175, -1.245252], [-10.512977, -3.14051], [-15.261537, 2.966542], [-29.342415, 5.703588], [-31.53232, -6.715979], [12.025034, -14.396316]], support: fixed}
  regions: [{material: concrete, polygon: [[0, 0], [7.062175, -1.245252], [5.291505, 4.080647], [-0.358235, 5.076849]]}]
  domain: {polygon: [[-31.53232, -6.715979], [12.025034, -14.396316], [14.12435, -2.490504], [7.062175, -1.245252], [5.291505, 4.080647], [-0.358235, 5.076849], [0, 0], [-15.261537, 2.966542], [-29.342415, 5.703588]]}
  fractures:
    - {trace: [[0, 0], [7.062175, -1.245252]], interface: base}
    - {trace: [[0, 0], [-10.512977, -3.14051]], interface: joint}
    - {trace: [[-10.512977, -3.14051], [7.062175, -1.245252]], interface: slip}
    - {trace: [[-15.261537, 2.966542], [-10.512977, -3.14051]], interface: slip}
)" + net + R"(
stages:
  - {steps: 10}
  - {forces: {push: {point: [2.775876735, 0.5053386122], force: [-809472.15, -1000035.7]}}}
  - {strength_reduction: {from: 0.7, to: 8}}
)");
}

// Limit analysis of the rigid blocks by linear programming has 2.5576. Where an edge of a net ended in the toe, the corner of the ground held the block's face: none below 8.
TEST(ToeBesideJoint, IsOneCornerThoughANetCutsIt) {
    for (const std::string net :
         {"", "  tessellation: {triangles: {spacing: 5, seed: 1}, interface: bond, region: [[5.291505, 4.080647], "
              "[-0.358235, 5.076849], [0, 0], [7.062175, -1.245252]]}"}) {
        const SceneRun run = leaning_block(net);
        ASSERT_TRUE(run.report.results.factor_of_safety) << net << run.report.diagnosis;
        EXPECT_NEAR(*run.report.results.factor_of_safety, 2.5576, 1e-3 * 2.5576) << net;
    }
}

} // namespace
} // namespace kluft

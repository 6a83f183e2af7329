// A joint that slides through a point in which many blocks meet: its strength is that of the joint alone.
#include <string>

#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// An upper block, 2 m long and 0.6 m high, on a longer lower one, pressed down by 1 MPa and pushed along by 2 mm. Stiff joints with the
/// traces `others` meet the joint between them, which has a friction of 30 degrees, and cut both into wedges.
std::string cut_blocks_on_a_joint(const std::string& cohesion, const std::string& others) {
    return R"(
kluft: 1
materials: {rock: {youngs_modulus: 1e12, poissons_ratio: 0.2}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 5e11, friction_angle: 30, cohesion: )" +
           cohesion + R"(}
  strong: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 5e11, friction_angle: 60, cohesion: 10e6}
geometry:
  domain: {polygon: [[-0.5, -0.6], [2.5, -0.6], [2.5, 0], [2, 0], [2, 0.6], [0, 0.6], [0, 0], [-0.5, 0]]}
  fractures:
  - {trace: [[0, 0], [2, 0]], interface: joint}
)" + others +
           R"(
boundaries:
  bottom: {sides: [0], support: fixed}
  top: {sides: [4]}
  left: {sides: [5]}
stages:
  - {name: normal, pressure: {top: 1e6}}
  - {name: shear, displacement: {boundary: left, value: 2e-3}, steps: 40}
)";
}

/// The largest force of the platen on the upper block (N/m).
double shear_strength(const std::string& scene) {
    const SceneRun run = run_scene(scene);
    EXPECT_TRUE(stands(run)) << run.report.diagnosis;
    constexpr double height = 0.6;
    double largest = 0.0;
    for (const StepRecord& row : run.equilibria) largest = std::max(largest, row.axial_stress);
    return 2.0 * height * largest; // the mean width of the body, 1.2 m, carries the axial stress
}

// Two wedges above and one joint below the point: the tip of the middle one slides over that of a lower block. Coulomb: 1 MPa x 2 m x
// tan 30 degrees = 1.1547 MN/m. Where the tip was a contact with the side of the lower block, it held 36 MN/m.
TEST(BlocksAtAPoint, DoNotCatchAtEachOthersSides) {
    EXPECT_NEAR(shear_strength(cut_blocks_on_a_joint("0", R"(
  - {trace: [[1, 0], [0.22354286469243745, 2.897777478867205]], interface: strong}
  - {trace: [[1, 0], [-0.9283628290596182, 2.298133329356934]], interface: strong}
  - {trace: [[1, 0], [1.2614672282429735, -2.988584094275237]], interface: strong})")),
                1.1547e6, 1e-3 * 1.1547e6);
}

// Eight wedges, and a joint with 0.5 MPa of cohesion: at most 1.1547 + 0.5 x 2 = 2.1547 MN/m, less where the upper block tips and a part of
// the joint is open. Where tips were contacts with a cohesion of their own it rose with the slip.
TEST(BlocksAtAPoint, HaveTheCohesionOfTheJointOnce) {
    const double strength = shear_strength(cut_blocks_on_a_joint("0.5e6", R"(
  - {trace: [[-0.9283628290596182, -2.298133329356934], [2.928362829059618, 2.298133329356934]], interface: strong}
  - {trace: [[1, -3], [1, 3]], interface: strong}
  - {trace: [[2.928362829059618, -2.298133329356934], [-0.9283628290596182, 2.298133329356934]], interface: strong})"));
    EXPECT_LT(strength, 1.001 * 2.1547e6);
    EXPECT_GT(strength, 0.95 * 2.1547e6);
}

} // namespace
} // namespace kluft

#include "kluft/equilibrium/loose_blocks.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using posed::degree;

constexpr double face_dip = 30.0; ///< degrees

/// A block with a horizontal top on a face that dips to the right, of a block that lies on a level base. A smooth platen moves down on
/// it; nothing else acts.
struct BlockUnderAPlaten {
    explicit BlockUnderAPlaten(const std::string& joint, double platen_moves = 1e-3)
        : platen_motion(platen_moves),
          work(build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, {}}}
geometry:
  reference_spacing: 1
  blocks:
    - {{name: base, polygon: [[-1, -0.5], [3, -0.5], [3, 0], [-1, 0]]}}
    - {{name: middle, polygon: [[0, 0], [2, 0], [2, 0.5], [0, {}]]}}
    - {{name: block, polygon: [[0, {}], [2, 0.5], [2, 2], [0, 2]]}}
boundaries: {{bottom: {{facing: bottom, block: base, support: pinned}}, top: {{facing: top, block: block}}}}
stages: [{{strain: {{boundary: top, value: {}}}, platens: smooth}}]
)",
                                                             joint, high, high, platen_motion / 2.5)))
                   .model) {
        StepInProgress p = begin_step(work.bench(), work.state, goal);
        placed = place(p);
        placed.eta.assign(3, 1e7);
        at = p.loads_at(1.0);
        at.carried_stress = 10e6;
    }

    [[nodiscard]] PartedBlocks part() {
        const BlockPattern pattern(3, {{0, 1}, {1, 2}});
        LinearSolver linear_solver;
        linear_solver.analyze(pattern);
        return part_blocks(linear_solver, pose(work.model, placed, at, work.state.body.displacement), pattern);
    }

    /// Of the centroid of a block, over that of the platen; zero where the blocks are held.
    [[nodiscard]] Vec2 motion(int block) {
        const PartedBlocks parted = part();
        if (parted.displacement.size() == 0) return Vec2::Zero();
        return parted.displacement.segment<2>(n_block_unknowns * block) / platen_motion;
    }

    static constexpr int middle = 1;
    static constexpr int upper = 2;
    const double high = 0.5 + 2.0 * std::tan(face_dip * degree);
    double platen_motion;
    posed::Workplace work;
    StepGoal goal;
    PlacedState placed;
    LoadsAt at;
};

class LooseBlocksByMotion : public testing::TestWithParam<double> {};

// A block on a face goes down it, by the motion of the platen over the tangent of the dip, however far that moves. With a friction of 20
// degrees on both faces it pushes what it lies on by 10 degrees off the vertical, which friction holds.
TEST_P(LooseBlocksByMotion, SlideOnWhatFrictionHolds) {
    BlockUnderAPlaten body("friction_angle: 20", GetParam());
    const Vec2 motion = body.motion(BlockUnderAPlaten::upper);
    EXPECT_NEAR(motion.x(), 1.0 / std::tan(face_dip * degree), 0.02);
    EXPECT_NEAR(motion.y(), -1.0, 1e-3);
    EXPECT_NEAR(body.motion(BlockUnderAPlaten::middle).norm(), 0.0, 0.01);
}

// From the dip on friction holds the block, and the platen presses; by how much it has moved does not matter.
TEST_P(LooseBlocksByMotion, AreHeldByFrictionFromTheDipOn) {
    for (const double friction : {31.0, 40.0}) {
        BlockUnderAPlaten body(fmt::format("friction_angle: {}", friction), GetParam());
        EXPECT_EQ(body.part().displacement.size(), 0);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, LooseBlocksByMotion, testing::Values(1e-3, 1e-5, 1e-7));

// With 5 degrees on both faces the push is 25 degrees off the vertical, and the block below gives way to the left.
TEST(LooseBlocks, PushAwayWhatFrictionDoesNotHold) {
    BlockUnderAPlaten body("friction_angle: 5");
    EXPECT_LT(body.motion(BlockUnderAPlaten::middle).x(), -0.1);
}

// Under small pressures a joint with cohesion is steeper than its friction: t_r = 0.01 c, and 100 in place of tan 10; or whole at once.
TEST(LooseBlocks, AreHeldByCohesion) {
    for (const char* onset : {"", ", cohesion_onset: 0"}) {
        BlockUnderAPlaten body(fmt::format("friction_angle: 10, cohesion: 1 MPa{}", onset));
        EXPECT_EQ(body.part().displacement.size(), 0);
    }
}

// A joint that dilates by 10 degrees opens as it slides: along a way that is flatter by so much.
TEST(LooseBlocks, OpenWithTheDilationOfTheirJoints) {
    BlockUnderAPlaten body("friction_angle: 20, dilation_angle: 10");
    const double expected = 1.0 / std::tan((face_dip - 10.0) * degree);
    EXPECT_NEAR(body.motion(BlockUnderAPlaten::upper).x(), expected, 0.02 * expected);
}

// A wedge of half the friction angle that is driven into a notch stays there when its platen leaves it. Explicitly it rises to -0.843 mm.
TEST(LooseBlocks, StayLockedWhereFrictionHoldsThem) {
    const SceneRun run = run_scene(R"(
kluft: 1
materials: {rock: {density: 2600, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 35}
geometry:
  reference_spacing: 0.5
  blocks_interface: joint
  blocks:
    - name: body
      polygon: [[-1, 0], [1, 0], [1, 2], [0.17, 2], [0.1, 1.2], [0.1, 1.0], [-0.1, 1.0], [-0.1, 1.2], [-0.17, 2], [-1, 2]]
    - {name: wedge, polygon: [[-0.1, 1.2], [0.1, 1.2], [0.17, 2], [0.17, 2.1], [-0.17, 2.1], [-0.17, 2]]}
boundaries: {top: {block: wedge, facing: top}, bottom: {block: body, facing: bottom, support: pinned}}
stages:
  - {name: drive, displacement: {boundary: top, value: 2 mm, against: none}, platens: smooth, steps: 20}
  - {name: back, displacement: {boundary: top, value: -4 mm, against: none}, platens: smooth, steps: 40}
)");
    ASSERT_TRUE(stands(run));
    EXPECT_NEAR(run.history.back().axial_stress, 0.0, 1e-3 * run.history[20].axial_stress);
    EXPECT_NEAR(run.state.body.displacement[n_block_unknowns + 1], -0.843e-3, 0.01e-3);
}

// A pillar with a joint that friction holds carries what it carried before when its platen comes back, in however small steps.
TEST(LooseBlocks, CarryAgainInSmallSteps) {
    const SceneRun run = run_scene(R"(
kluft: 1
materials: {rock: {density: 2600, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 35}
geometry:
  reference_spacing: 0.1
  domain: {rectangle: {width: 0.1, height: 4}}
  fractures: [{trace: [[-0.01, 1.978162], [0.11, 2.021838]], interface: joint}]
boundaries: {bottom: {support: fixed}}
stages:
  - {name: load, displacement: {boundary: top, value: 4 mm}, platens: rough, steps: 10}
  - {name: unload, displacement: {boundary: top, value: -4.1 mm}, platens: rough, steps: 10}
  - {name: again, displacement: {boundary: top, value: 4.1 mm}, platens: rough, steps: 400}
)");
    ASSERT_TRUE(stands(run));
    const double first = run.history[10].axial_stress;
    EXPECT_GT(first, 1e6);
    EXPECT_NEAR(run.history.back().axial_stress, first, 1e-3 * first);
}

// When its pillar has broken off, a wedge slides down a face of 28 degrees on a block that stands on a level floor, with a friction of 20
// on both: the block stays, and the wedge meets a wall 10 mm away when its platen has moved by 5 + 10 tan 28 = 10.32 mm.
TEST(LooseBlocks, MeetAWallWhereFrictionLeadsThem) {
    const SceneRun run = run_scene(R"(
kluft: 1
materials: {rock: {density: 2600, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
interfaces:
  bond: {kind: potential_crack, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, fails_to: slick, cohesion: 2 MPa, friction_angle: 0, tensile_strength: 1 MPa}
  slick: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 0}
  joint: {kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 20}
geometry:
  reference_spacing: 1
  domain: {polygon: [[-1, -0.2], [0.51, -0.2], [0.51, 2], [-0.49, 2], [-0.49, 0], [-0.5, 0], [-0.5, 1.995], [-1, 1.995]]}
  fractures:
    - {trace: [[-0.59, 1.96], [0.61, 0.04]], interface: bond}
    - {trace: [[-1.1, 1.7191], [-0.495, 1.39740857]], interface: joint}
    - {trace: [[-1.1, 0.5], [-0.495, 0.5]], interface: joint}
  sets: {base: {polygon: [[-0.45, -0.3], [0.4, -0.3], [-0.2, 1.0], [-0.45, 1.0]], support: fixed}}
boundaries: {bottom: {sides: [0]}, top: {sides: [2]}}
cracks: {criterion: interface_traction}
stages: [{displacement: {boundary: top, value: 20 mm, against: none}, platens: smooth, steps: 40}]
)");
    ASSERT_TRUE(stands(run));
    EXPECT_LT(run.history[20].axial_stress, 1e4); // at 10.0 mm
    EXPECT_GT(run.history[22].axial_stress, 1e5); // at 11.0 mm
}

} // namespace
} // namespace kluft

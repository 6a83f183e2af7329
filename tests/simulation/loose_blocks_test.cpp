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

constexpr double face_dip = 30.0;      ///< degrees
constexpr double platen_motion = 1e-3; ///< of the platen (m)

/// A block with a horizontal top on a base whose face dips to the right. A smooth platen moves down on it; nothing else acts.
struct BlockUnderAPlaten {
    explicit BlockUnderAPlaten(const std::string& joint_and_platen)
        : work(build_scene_model(read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, {}}}
geometry:
  reference_spacing: 1
  blocks:
    - {{name: base, polygon: [[0, 0], [2, 0], [2, 0.5], [0, {}]]}}
    - {{name: block, polygon: [[0, {}], [2, 0.5], [2, 2], [0, 2]]}}
boundaries: {{bottom: {{facing: bottom, block: base, support: pinned}}, top: {{facing: top, block: block}}}}
stages: [{{strain: {{boundary: top, value: {}}}, platens: smooth}}]
)",
                                                             joint_and_platen, high, high, platen_motion / 2.0)))
                   .model) {
        StepInProgress p = begin_step(work.bench(), work.state, goal);
        placed = place(p);
        placed.eta.assign(2, 1e3);
        at = p.loads_at(1.0);
        at.carried_stress = 10e6;
    }

    [[nodiscard]] PartedBlocks part(Passage passage) {
        const BlockPattern pattern(2, {{0, 1}});
        LinearSolver linear_solver;
        linear_solver.analyze(pattern);
        return part_blocks(linear_solver, pose(work.model, placed, at, work.state.body.displacement), pattern, passage);
    }

    /// Of the block's centroid, over that of the platen.
    [[nodiscard]] Vec2 motion(Passage passage) {
        const PartedBlocks parted = part(passage);
        if (parted.displacement.size() == 0) return Vec2::Zero();
        return parted.displacement.segment<2>(n_block_unknowns) / platen_motion;
    }

    const double high = 0.5 + 2.0 * std::tan(face_dip * degree);
    posed::Workplace work;
    StepGoal goal;
    PlacedState placed;
    LoadsAt at;
};

// The least motion that a platen leaves to the block takes it down the face: by its motion over the tangent of the dip.
TEST(LooseBlocks, SlideOutOfTheWayOfAPlaten) {
    for (const double friction : {0.0, 20.0, 40.0}) {
        BlockUnderAPlaten body(fmt::format("friction_angle: {}", friction));
        const Vec2 motion = body.motion(Passage::sliding);
        EXPECT_NEAR(motion.x(), 1.0 / std::tan(face_dip * degree), 1e-3);
        EXPECT_NEAR(motion.y(), -1.0, 1e-4);
    }
}

// A motion that opens the face by the tangent of the friction angle times the slip goes along one that is flatter by that angle. There is
// none from the dip on: friction holds the block, and the platen presses. (The iteration ends as soon as that is known, a few per cent
// from the place.)
TEST(LooseBlocks, AreHeldByFrictionFromTheDipOn) {
    for (const double friction : {0.0, 10.0, 20.0}) {
        BlockUnderAPlaten body(fmt::format("friction_angle: {}", friction));
        const double expected = 1.0 / std::tan((face_dip - friction) * degree);
        EXPECT_NEAR(body.motion(Passage::opening).x(), expected, 0.1 * expected);
    }
    for (const double friction : {31.0, 40.0}) {
        BlockUnderAPlaten body(fmt::format("friction_angle: {}", friction));
        EXPECT_EQ(body.part(Passage::opening).displacement.size(), 0);
    }
}

// Under small pressures a joint with cohesion is steeper than its friction: t_r = 0.01 c, and 100 in place of tan 10.
TEST(LooseBlocks, AreHeldByCohesion) {
    BlockUnderAPlaten body("friction_angle: 10, cohesion: 1 MPa");
    EXPECT_EQ(body.part(Passage::opening).displacement.size(), 0);
}

// A joint that dilates by 10 degrees opens as it slides: along a way that is flatter by so much.
TEST(LooseBlocks, OpenWithTheDilationOfTheirJoints) {
    BlockUnderAPlaten body("friction_angle: 20, dilation_angle: 10");
    EXPECT_NEAR(body.motion(Passage::sliding).x(), 1.0 / std::tan((face_dip - 10.0) * degree), 1e-3);
}

} // namespace
} // namespace kluft

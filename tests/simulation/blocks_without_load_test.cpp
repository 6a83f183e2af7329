// Blocks that carry nothing any more (docs/theory.md, eq. 27c) and that friction holds, or leads, all the same.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

// A wedge whose faces are 5 degrees off the vertical, beside a friction angle of 35, that is driven into a notch stays there when its platen leaves it. Explicitly it rises to -0.843 mm.
TEST(BlocksWithoutLoad, StayLockedWhereFrictionHoldsThem) {
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
TEST(BlocksWithoutLoad, CarryAgainInSmallSteps) {
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
TEST(BlocksWithoutLoad, MeetAWallWhereFrictionLeadsThem) {
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

/// A slider under a platen on the face, which dips by `dip` degrees, of a base on a floor, and a wall 5 mm beside it. A pillar has been loaded
/// and let go before, so that they carry next to nothing beside what the body has carried.
SceneRun slider_beside_a_wall(double dip, const std::string& joint, const std::string& base, int n_steps) {
    const double rise = std::tan(dip * posed::degree);
    return run_scene(fmt::format(R"(
kluft: 1
materials: {{rock: {{density: 2600, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, {joint}}}
geometry:
  reference_spacing: 1
  blocks_interface: joint
  blocks:
    - {{name: floor, polygon: [[-3, -0.3], [6, -0.3], [6, 0], [-3, 0]], support: fixed}}
    - {{name: pillar, polygon: [[4, 0], [5, 0], [5, {pillar}], [4, {pillar}]]}}
    - {{name: base, polygon: [[0, 0], [1, 0], [1, 0.3], [0, {high}]]{base}}}
    - {{name: slider, polygon: [[0, {high}], [1, 0.3], [1, {top}], [0, {top}]]}}
    - {{name: wall, polygon: [[1.005, 0.31], [2, 0.31], [2, {wall}], [1.005, {wall}]], support: fixed}}
boundaries: {{pillar_top: {{block: pillar, facing: top}}, top: {{block: slider, facing: top}}}}
stages:
  - {{name: load, displacement: {{boundary: pillar_top, value: 1 mm, against: none}}, platens: smooth, steps: 2}}
  - {{name: let go, displacement: {{boundary: pillar_top, value: -2 mm, against: none}}, platens: smooth, steps: 2}}
  - {{name: slide, displacement: {{boundary: top, value: 20 mm, against: none}}, platens: smooth, steps: {n_steps}}}
)",
                                 fmt::arg("joint", joint), fmt::arg("base", base), fmt::arg("high", 0.3 + rise),
                                 fmt::arg("top", 0.5 + rise), fmt::arg("wall", 0.25 + rise),
                                 fmt::arg("pillar", 1.3 + rise), fmt::arg("n_steps", n_steps)));
}

/// The motion of the platen at which the slider begins to carry (mm).
double start_of_load(const SceneRun& run, int n_steps) {
    const auto sliding = std::ranges::find(run.history, 2, &StepRecord::stage);
    int n = 0;
    for (auto row = sliding; row != run.history.end(); ++row, ++n) {
        constexpr int slider = 3;
        if (run.fields[row - run.history.begin()].stress[slider](1, 1) < -0.2e6) break;
    }
    return 20.0 * n / n_steps;
}

// The slider pushes its base by 20 degrees off the vertical, which a friction of 45 holds: it meets the wall after 5 tan 65 = 10.72 mm.
// The compliance and one load step are to be added.
TEST(BlocksWithoutLoad, SlideOnABaseThatFrictionHolds) {
    for (const int n_steps : {50, 200}) {
        const SceneRun run = slider_beside_a_wall(65.0, "friction_angle: 45", "", n_steps);
        ASSERT_EQ(run.report.status, RunStatus::done);
        EXPECT_NEAR(start_of_load(run, n_steps), 10.72, 0.2 + 20.0 / n_steps) << n_steps;
    }
}

// With a dilation of 10 degrees on a face of 45 it goes along one of 35: 5 tan 35 = 3.50 mm.
TEST(BlocksWithoutLoad, OpenWithTheDilationOfTheirJoints) {
    for (const int n_steps : {50, 200}) {
        const SceneRun run =
            slider_beside_a_wall(45.0, "friction_angle: 20, dilation_angle: 10", ", support: fixed", n_steps);
        ASSERT_EQ(run.report.status, RunStatus::done);
        EXPECT_NEAR(start_of_load(run, n_steps), 3.50, 0.2 + 20.0 / n_steps) << n_steps;
    }
}

} // namespace
} // namespace kluft

// Equilibria that a body would leave for good: symmetric columns above the load at which they turn over.
#include "kluft/simulation/stability.hpp"

#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// A block 1 m wide and 10 m high on a joint of 100 MPa/m, under a force in the middle of its top or its own weight.
SceneRun upright_block(const std::string& kinematics, double force, double gravity) {
    return run_scene(fmt::format(R"(kluft: 1
analysis: {{plane: stress, kinematics: {}, gravity: {:.17g}}}
materials: {{rock: {{youngs_modulus: 100 GPa, poissons_ratio: 0, density: 2000}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e8, shear_stiffness: 1e8, friction_angle: 45, contact_rounding: 0}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[0, -1], [1, -1], [1, 0], [0, 0]], support: fixed}}
    - {{name: block, polygon: [[0, 0], [1, 0], [1, 10], [0, 10]]}}
stages: [{{forces: {{P: {{block: block, point: [0.5, 10], force: [0, {:.17g}]}}}}, steps: 4}}]
)",
                                 kinematics, gravity, -force));
}

// The closed joint resists a turn w with the moment k_n b^3/12 w, and the load has the moment P h w, the weight W h/2 w.
TEST(Stability, ColumnOnAJointIsUnstableAboveTheLoadThatTurnsItOver) {
    const double stiffness = 1e8 / 12.0, height = 10.0;
    for (const std::string kinematics : {"affine", "rigid"}) {
        for (const double share : {0.9, 1.1, 3.0}) {
            const SceneRun loaded = upright_block(kinematics, share * stiffness / height, 0.0);
            ASSERT_TRUE(stands(loaded)) << loaded.report.diagnosis;
            EXPECT_EQ(is_unstable(loaded.model, loaded.state), share > 1.0) << kinematics << " " << share;
            const double weight = share * stiffness / (0.5 * height);
            const SceneRun heavy = upright_block(kinematics, 1.0, weight / (2000.0 * height));
            ASSERT_TRUE(stands(heavy)) << heavy.report.diagnosis;
            EXPECT_EQ(is_unstable(heavy.model, heavy.state), share > 1.0) << kinematics << " " << share;
        }
    }
}

TEST(Stability, IsToldInWords) {
    const SceneRun run = upright_block("affine", 1e7, 0.0);
    EXPECT_THAT(unstable_equilibrium_warning(run.model, run.state), ::testing::HasSubstr("is not stable"));
    const SceneRun stable = upright_block("affine", 1e5, 0.0);
    EXPECT_EQ(unstable_equilibrium_warning(stable.model, stable.state), "");
}

} // namespace
} // namespace kluft

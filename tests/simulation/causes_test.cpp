// What a message says of why there is no equilibrium.
#include "kluft/simulation/causes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/simulation/stage_loads.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Two blocks of 1 m by 1 m, one on the other, between the given supports and under the given loads.
SceneRun run_two_blocks(const std::string& boundaries, const std::string& stage,
                        const std::string& modulus = "10 GPa") {
    return run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {density: 2500, youngs_modulus: )" +
                     modulus + R"(, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  fractures: [{trace: [[-0.1, 1], [1.1, 1]]}]
boundaries: )" + boundaries +
                     R"(
stages: [)" + stage + R"(]
)");
}

TEST(Causes, PressuresThatDoNotBalanceAreNamed) {
    const SceneRun run =
        run_two_blocks("{bottom: {support: smooth}}", "{pressure: {top: 1 MPa, left: 2 MPa, right: 1 MPa}}");
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(run.report.diagnosis, AllOf(HasSubstr("push the body towards (1, 0) with 2000 kN/m"),
                                            HasSubstr("left 2"), HasSubstr("right 1")));
}

TEST(Causes, LoadsThatTurnTheBodyAreNamed) {
    const Model model = run_two_blocks("{bottom: {support: pinned}}", "{pressure: {top: 0}}").model;
    LoadsAt at;
    Loads& loads = at.loads;
    loads.pressures.assign(model.system.boundaries.size(), 0.0);
    loads.point_loads = {{.block = 1, .xi = {0.5, 0.0}, .force = {0.0, 1e5}},
                         {.block = 1, .xi = {-0.5, 0.0}, .force = {0.0, -1e5}}};
    const auto causes = likely_causes(model, at, {});
    ASSERT_EQ(causes.size(), 1U);
    EXPECT_THAT(causes.front(), HasSubstr("turn the body"));
}

TEST(Causes, LoadsThatAreHeldHaveNone) {
    const Model model = run_two_blocks("{bottom: {support: fixed}}", "{pressure: {top: 1 MPa, left: 2 MPa}}").model;
    State state = initial_state(model);
    const StageLoads stage = enter_stage(model, state);
    const LoadsAt at = loads_at(model, stage, hold_of(model, stage, state.body), 0, 1.0);
    EXPECT_TRUE(likely_causes(model, at, {}).empty());
}

TEST(Causes, AModulusWithoutItsUnitIsSuspected) {
    const SceneRun run =
        run_two_blocks("{bottom: {support: pinned}}", "{pressure: {top: 1 MPa, left: 1 MPa, right: 1 MPa}}", "10e3");
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(run.report.diagnosis,
                AllOf(HasSubstr("is a unit missing"), HasSubstr("0.01 MPa"), Not(HasSubstr("push the body"))));
}

} // namespace
} // namespace kluft

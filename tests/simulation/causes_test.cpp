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

// A block of 2 m on a slope that it slides down, and a fixed one 100 000 km away: 2500 kg/m3 over that would be 2.5e6 MPa.
TEST(Causes, FixedBlocksAreNoOverburden) {
    const SceneRun run = run_scene(R"(
kluft: 1
analysis: {gravity: 10}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 10}}
geometry:
  reference_spacing: 1
  blocks:
    - {name: base, polygon: [[0, -1], [4, -1], [4, 2], [0, 0]], support: fixed}
    - {name: top, polygon: [[1, 0.5], [3, 1.5], [3, 3], [1, 2]]}
    - {name: far, polygon: [[1e8, 1], [100000001, 1], [1e8, 2]], support: fixed}
stages: [{}]
)");
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(run.report.diagnosis, AllOf(HasSubstr("'top'"), Not(HasSubstr("times the modulus"))));
}

/// Warnings of two blocks, one on the other, whose scene says this of boundaries, gravity and stages.
std::vector<std::string> warnings_of_two_blocks(const std::string& boundaries, const std::string& gravity,
                                                const std::string& stages) {
    const std::string scene = R"(kluft: 1
analysis: {gravity: )" + gravity +
                              R"(}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}
geometry: {domain: {rectangle: {width: 1, height: 2}}, fractures: [{trace: [[-0.1, 1], [1.1, 1]]}]}
boundaries: )" + boundaries + R"(
stages: )" + stages + "\n";
    return build_scene_model(read_scene_text(scene, {}, "two.yaml")).model.warnings;
}

// By statics: what nothing holds stands only under loads whose sum and moment vanish.
TEST(UnheldBody, UnderLoadsThatDoNotBalanceIsWarnedOfBeforeItIsRun) {
    const auto told = [](const std::string& where, const std::string& how) {
        return ::testing::Contains(AllOf(HasSubstr(where),
                                         HasSubstr("expected a support, a fixed block or a platen that holds the body"),
                                         HasSubstr(how)));
    };
    // 2500 kg/m3 x 2 m2 x 10 m/s2
    EXPECT_THAT(warnings_of_two_blocks("{}", "10", "[{name: weight}]"),
                told("two.yaml:7:10: stages.0: ", "towards (0, -1) with 50 kN/m"));
    EXPECT_THAT(
        warnings_of_two_blocks("{}", "0", "[{pressure: {left: 2 MPa, right: 2 MPa}}, {pressure: {left: 3 MPa}}]"),
        told("stages.1: ", "towards (1, 0) with 2000 kN/m"));
    EXPECT_THAT(warnings_of_two_blocks("{}", "0",
                                       "[{forces: {up: {point: [0.9, 1.9], force: [0, 1e5]}, "
                                       "down: {point: [0.1, 1.9], force: [0, -1e5]}}}]"),
                told("stages.0: ", "the loads turn the body"));
}

TEST(UnheldBody, IsNoneWhereLoadsBalanceOrAnythingHoldsIt) {
    const auto none = Not(::testing::Contains(HasSubstr("that holds the body, found none")));
    const std::string all_around = "[{pressure: {left: 1 MPa, right: 1 MPa, top: 2 MPa, bottom: 2 MPa}}]";
    EXPECT_THAT(warnings_of_two_blocks("{}", "0", all_around), none);
    EXPECT_TRUE(stands(run_two_blocks("{}", all_around.substr(1, all_around.size() - 2))));
    const std::string platen = "{strain: {boundary: top, value: 0.01 %}}";
    EXPECT_THAT(warnings_of_two_blocks("{}", "0", "[" + platen + "]"), none);
    EXPECT_THAT(warnings_of_two_blocks("{}", "10", "[" + platen + ", {pressure: {top: 1 MPa}}]"), none);
    EXPECT_THAT(warnings_of_two_blocks("{bottom: {support: smooth}}", "10", "[{name: weight}]"), none);
}

} // namespace
} // namespace kluft

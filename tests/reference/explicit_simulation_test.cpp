#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/reference/explicit_simulation.hpp"
#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr const char* by_steps = "analysis.integrator=explicit";

void expect_closed_energy(const SceneRun& run) {
    for (const StepRecord& record : run.history) {
        ASSERT_TRUE(record.motion);
        EXPECT_LT(std::abs(record.motion->energy_error), 0.01) << record.step;
    }
}

// Plane stress: strain = p/E, here over 2 m of height.
TEST(ExplicitSimulation, ElasticBlockUnderPressureShortensByItsStressOverE) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {plane: stress, integrator: explicit}
materials: {rock: {youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12}}
geometry: {domain: {rectangle: {width: 1.0, height: 2.0}}, reference_spacing: 1.0}
boundaries: {bottom: {support: pinned}}
stages: [{name: pressure, pressure: {top: 2 MPa}, steps: 2}]
)");
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_EQ(run.report.unbalanced_steps, 0);
    EXPECT_NEAR(run.history.back().axial_strain, 1e-4, 1e-7);
    EXPECT_NEAR(run.history.back().lateral_strain, -0.25e-4, 1e-7);
    EXPECT_LT(run.history.back().motion->platen_imbalance, 1e-3);
    expect_closed_energy(run);
}

const char* const hexagons = R"(
kluft: 1
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.25, cohesion: 2 MPa, friction_angle: 40, tensile_strength: 1 MPa}}
interfaces:
  joint: {kind: fracture, friction_angle: 30, normal_stiffness_times_spacing: 100 GPa, shear_stiffness_times_spacing: 50 GPa}
  bond: {kind: potential_crack, fails_to: joint, normal_stiffness_times_spacing: 100 GPa, shear_stiffness_times_spacing: 50 GPa}
geometry:
  domain: {rectangle: {width: 0.3, height: 0.5}}
  fractures: [{trace: [[-0.1, 0.1], [0.4, 0.4]], interface: joint}]
  tessellation: {hexagons: {spacing: 0.1}, interface: bond}
boundaries: {bottom: {support: pinned}}
stages:
  - {name: pressure, pressure: {left: 1 MPa, right: 1 MPa, top: 1 MPa}, steps: 2}
  - {name: platen, strain: {boundary: top, value: 4e-4}, steps: 5}
)";

TEST(SlowExplicitSimulation, FracturedHexagonsFollowTheImplicitCurve) {
    const auto reference = run_scene(hexagons);
    const auto run = run_scene(hexagons, {by_steps});
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_EQ(run.history.size(), reference.history.size());
    const double scale = reference.history.back().axial_stress;
    for (std::size_t i = 0; i < run.history.size(); ++i) {
        EXPECT_NEAR(run.history[i].axial_stress, reference.history[i].axial_stress, 5e-3 * scale) << i;
        EXPECT_NEAR(run.history[i].axial_strain, reference.history[i].axial_strain, 2e-6) << i;
        EXPECT_NEAR(run.history[i].lateral_strain, reference.history[i].lateral_strain, 5e-6) << i;
        EXPECT_TRUE(run.history[i].balanced) << i;
    }
    EXPECT_GT(run.history.back().motion->friction_energy, 0.0);
    expect_closed_energy(run);
}

// An unfractured bonded body is elastic: no friction, so both integrators meet at one state.
TEST(SlowExplicitSimulation, BondedHexagonsAreAsStiffAsInTheImplicitRun) {
    const std::vector<std::string> overrides{"geometry.fractures=[]", "materials.rock.cohesion=1e9",
                                             "materials.rock.tensile_strength=1e9"};
    auto explicit_overrides = overrides;
    explicit_overrides.emplace_back(by_steps);
    const auto reference = run_scene(hexagons, overrides);
    const auto run = run_scene(hexagons, explicit_overrides);
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    const double expected = reference.history.back().axial_stress;
    EXPECT_NEAR(run.history.back().axial_stress, expected, 1e-3 * expected);
    EXPECT_NEAR(run.history.back().lateral_strain, reference.history.back().lateral_strain, 1e-6);
    EXPECT_EQ(run.history.back().motion->friction_energy, 0.0);
    EXPECT_EQ(run.history.back().motion->crack_energy, 0.0);
    expect_closed_energy(run);
}

TEST(SlowExplicitSimulation, PotentialCracksFailAtTheStressOfTheImplicitRun) {
    const std::vector<std::string> overrides{"geometry.fractures=[]", "materials.rock.cohesion=0.5 MPa",
                                             "materials.rock.friction_angle=30"};
    auto explicit_overrides = overrides;
    explicit_overrides.emplace_back(by_steps);
    const auto reference = run_scene(hexagons, overrides);
    const auto run = run_scene(hexagons, explicit_overrides);
    ASSERT_FALSE(reference.cracks.empty());
    ASSERT_FALSE(run.cracks.empty());
    EXPECT_EQ(run.cracks.front().interface, reference.cracks.front().interface);
    EXPECT_EQ(run.cracks.front().step, reference.cracks.front().step);
    EXPECT_NEAR(run.cracks.front().p1, reference.cracks.front().p1, 0.02 * reference.cracks.front().p1);
    EXPECT_GT(run.history.back().motion->crack_energy, 0.0);
    expect_closed_energy(run);
}

// At a stress of 1 MPa the index of an intact body with 0.5 MPa of cohesion and 30 degrees is 1 MPa / (2 c cos(phi)/(1 - sin(phi))) = 0.58;
// with a tenth of the cohesion 5.8.
TEST(SlowExplicitSimulation, StressesThatPassTheStrengthBetweenTwoChecksAreWarnedOf) {
    const auto warnings_of = [](const char* interval) {
        const auto run =
            run_scene(hexagons, {by_steps, "geometry.fractures=[]", "materials.rock.cohesion=0.05 MPa",
                                 "materials.rock.friction_angle=30", "stages=[{pressure: {top: 1 MPa}, steps: 2}]",
                                 std::string("analysis.crack_check_interval=") + interval});
        return run.report.warnings;
    };
    EXPECT_THAT(
        warnings_of("1000000"),
        ::testing::ElementsAre(::testing::AllOf(
            ::testing::StartsWith("load step 2: stresses reach "),
            ::testing::HasSubstr("only one time step in 1000000 checks them (analysis.crack_check_interval)"),
            ::testing::HasSubstr("analysis.crack_check_interval, made smaller, finds where each crack fails"))));
    EXPECT_THAT(warnings_of("5"), ::testing::IsEmpty());
}

TEST(ExplicitSimulation, LoadStepsThatTakeForEverAreWarnedOf) {
    const auto warning = [](const std::vector<std::string>& settings) {
        const Scene scene = read_scene_text(hexagons, settings);
        return warning_of_long_steps(build_scene_model(scene).model, scene.explicit_options);
    };
    EXPECT_EQ(warning({by_steps}), "");
    EXPECT_EQ(warning({by_steps, "analysis.loading_rate=0.01"}), "");
    EXPECT_THAT(warning({by_steps, "analysis.loading_rate=1e-12"}),
                ::testing::AllOf(::testing::StartsWith("stages.1: a load step takes "),
                                 ::testing::HasSubstr("a larger analysis.loading_rate takes fewer")));
    EXPECT_THAT(warning({by_steps, "interfaces.joint.normal_stiffness_times_spacing=1e15",
                         "materials.rock.youngs_modulus=1", "analysis.density_scaling=none"}),
                ::testing::AllOf(::testing::StartsWith("stages.0: a load step takes "),
                                 ::testing::HasSubstr("smaller stiffnesses of the interfaces")));
}

std::string incline(double slope_degrees) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, integrator: explicit, gravity: [{:.17g}, {:.17g}]}}
materials: {{rock: {{density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e8, shear_stiffness: 1e8, friction_angle: 30, contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: 4.0, height: 1.5}}}}
  fractures: [{{name: plane, trace: [[-1, 0.5], [5, 0.5]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: weight, steps: 2}}]
solver: {{max_unbalanced_steps: 1}}
)",
                       10.0 * std::sin(slope_degrees * degree), -10.0 * std::cos(slope_degrees * degree));
}

// Coulomb: phi = 30 degrees.
TEST(ExplicitSimulation, BlockOnInclineStaysBelowTheFrictionAngleAndSlipsAboveIt) {
    const auto stays = run_scene(incline(29.5));
    EXPECT_EQ(stays.report.status, RunStatus::done) << stays.report.diagnosis;
    EXPECT_EQ(stays.report.unbalanced_steps, 0);
    const auto slips = run_scene(incline(30.5));
    EXPECT_TRUE(slips.report.status == RunStatus::collapsed || slips.report.status == RunStatus::no_equilibrium);
    EXPECT_FALSE(slips.report.diagnosis.empty());
}

/// A block of 0.1 m on the upper side of a body of `ratio` times its area, both tilted by 30 degrees.
std::string small_block_on_large(double ratio, double friction_angle) {
    const double width = 0.1 * std::sqrt(2.0 * ratio);
    return fmt::format(R"(
kluft: 1
analysis: {{integrator: explicit, gravity: [5, -8.660254037844387]}}
materials: {{rock: {{density: 2500, youngs_modulus: 50 GPa, poissons_ratio: 0.25}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 2e10, shear_stiffness: 1e10, friction_angle: {0}, cohesion: 0}}}}
geometry:
  blocks:
    - {{name: large, polygon: [[-{1}, -{1}], [{1}, -{1}], [{1}, 0], [-{1}, 0]]}}
    - {{name: small, polygon: [[0, 0], [0.1, 0], [0.1, 0.1], [0, 0.1]]}}
boundaries: {{bottom: {{block: large, facing: bottom, support: fixed}}}}
stages: [{{name: weight, steps: 1}}, {{name: hold, steps: 2}}]
)",
                       friction_angle, 0.5 * width);
}

// What is left over on a block that slides is sin 30 - cos 30 tan phi of its weight, however large the body beside it is.
TEST(ExplicitSimulation, SmallBlockThatSlidesOnALargeBodyIsNamed) {
    for (const double ratio : {10.0, 100.0, 1000.0}) {
        const auto run = run_scene(small_block_on_large(ratio, 5.0));
        EXPECT_EQ(run.report.status, RunStatus::unbalanced) << ratio;
        EXPECT_THAT(run.report.diagnosis, testing::HasSubstr("block 'small'")) << ratio;
        ASSERT_EQ(run.report.falling.size(), 1U) << ratio;
        EXPECT_EQ(run.report.falling.front().block, "small") << ratio;
        EXPECT_NEAR(run.report.falling.front().direction.x(), 1.0, 1e-3) << ratio;
        const double share = std::sin(30 * degree) - std::cos(30 * degree) * std::tan(5 * degree);
        EXPECT_NEAR(run.history.back().balance_error, share, 0.02) << ratio;
        EXPECT_FALSE(run.history.back().balanced) << ratio;
        EXPECT_LE(run.history.back().unbalanced_ratio, 0.1) << ratio;
    }
}

TEST(ExplicitSimulation, SmallBlockThatStandsOnALargeBodyIsBalanced) {
    for (const double ratio : {10.0, 100.0, 1000.0}) {
        const auto run = run_scene(small_block_on_large(ratio, 35.0));
        EXPECT_TRUE(stands(run)) << ratio << ": " << run.report.diagnosis;
        EXPECT_TRUE(run.report.falling.empty()) << ratio;
        for (const StepRecord& row : run.history) EXPECT_LE(row.balance_error, run.scene.solver.balance) << ratio;
    }
}

// The platen takes the upper block along and leaves it without a force on it: it goes on at its velocity.
TEST(ExplicitSimulation, BlockThatDriftsIsNamed) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {integrator: explicit}
materials: {rock: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 30, normal_stiffness: 1e10, shear_stiffness: 5e9}}
geometry: {domain: {rectangle: {width: 1, height: 2}}, fractures: [{trace: [[-0.1, 1], [1.1, 1]]}]}
boundaries: {bottom: {support: fixed}}
stages:
  - {stress: {boundary: top, value: 0.1 MPa}, platens: rough, steps: 2}
  - {strain: {boundary: top, value: -1 %}, platens: rough, steps: 2}
)");
    EXPECT_EQ(run.report.status, RunStatus::unbalanced);
    EXPECT_THAT(run.report.diagnosis, testing::HasSubstr("moves towards"));
    EXPECT_EQ(run.report.falling.size(), 1U);
}

// Nothing waits for the platen, so that its rows are judged by the whole body; the block is told of all the same.
TEST(ExplicitSimulation, BlockThatFallsWhileThePlatenMovesIsWarnedOf) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {integrator: explicit, gravity: 10, loading_rate: 1 mm/s}
materials: {rock: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 30, normal_stiffness: 1e10, shear_stiffness: 5e9}}
geometry:
  blocks:
    - {name: large, polygon: [[0, 0], [2, 0], [2, 2], [0, 2]]}
    - {name: loose, polygon: [[3, 1], [3.1, 1], [3.1, 1.1], [3, 1.1]]}
boundaries:
  bottom: {block: large, facing: bottom, support: fixed}
  top: {block: large, facing: top}
stages: [{name: platen, displacement: {boundary: top, value: 0.02 mm}, steps: 2}]
)");
    ASSERT_EQ(run.report.warnings.size(), 1U);
    EXPECT_THAT(run.report.warnings.front(), testing::HasSubstr("block 'loose'"));
    EXPECT_NEAR(run.history.back().balance_error, 1.0, 1e-6);
}

/// A plane with c = 0.1 MPa and phi = 30 degrees at 0.2 MPa lateral pressure; its normal makes 60 degrees with p1.
std::string plane_of_weakness(const char* platen) {
    const double rise = 1.4 * std::tan(60 * degree) / 2;
    return fmt::format(R"(
kluft: 1
analysis: {{integrator: explicit}}
materials: {{rock: {{youngs_modulus: 5 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30, cohesion: 0.1 MPa, cohesion_onset: 1000, contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: 1.0, height: 3.0}}}}
  fractures: [{{name: plane, trace: [[-0.2, {:.17g}], [1.2, {:.17g}]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{name: pressure, pressure: {{left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}}, steps: 1}}
  - {{name: platen, {}, platens: smooth, steps: 10}}
)",
                       1.5 - rise, 1.5 + rise, platen);
}

// Jaeger: p1 - p3 = 2 (c + p3 tan phi)/((1 - tan phi cot beta) sin 2 beta).
const double jaegers_stress = 2 * (0.1e6 + 0.2e6 * std::tan(30 * degree)) /
                              ((1 - std::tan(30 * degree) / std::tan(60 * degree)) * std::sin(120 * degree));

TEST(ExplicitSimulation, PlaneOfWeaknessSlipsAtJaegersStress) {
    const auto run = run_scene(plane_of_weakness("strain: {boundary: top, value: 1e-3}"));
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_NEAR(run.history.back().differential_stress, jaegers_stress, 5e-3 * jaegers_stress);
    expect_closed_energy(run);
}

TEST(ExplicitSimulation, BodyUnderAGivenStressCollapsesAtTheStepThatPassesJaegersStress) {
    const auto run = run_scene(plane_of_weakness("stress: {boundary: top, value: 1.1 MPa}"));
    EXPECT_EQ(run.report.status, RunStatus::collapsed) << run.report.diagnosis;
    const double step = (1.1e6 - 0.2e6) / 10;
    EXPECT_LT(run.history.back().differential_stress, 1.001 * jaegers_stress);
    EXPECT_GT(run.history.back().differential_stress, jaegers_stress - 1.5 * step);
    EXPECT_TRUE(run.state.body.displacement.allFinite());
}

// A platen at constant velocity: slower and slower runs meet the quasi-static one; the waves of a fast one are seen.
// The upper block is torn off in the second of two load steps. In motion the body is never balanced to the usual share, so
// that nothing of the step is told; where a large share counts as balanced it ends at its crack.
TEST(ExplicitSimulation, FailedStepEndsAtItsLastBalancedEquilibrium) {
    const Model model = posed::two_bonded_blocks(1.5 * posed::tensile_strength, 2);
    const std::atomic<bool> stop{false};
    const auto torn = [&](double balance, posed::Told& told) {
        State state = initial_state(model);
        const RunReport report = run_explicit(model, {}, {.balance = balance}, {}, state, told, stop);
        EXPECT_EQ(report.status, RunStatus::no_equilibrium) << report.diagnosis;
        EXPECT_EQ(told.rows.back().load_factor, state.at.load_factor);
        EXPECT_TRUE(told.rows.back().balanced);
        return state;
    };
    posed::Told nothing;
    EXPECT_EQ(torn(1e-3, nothing).at.load_factor, 0.5);
    EXPECT_TRUE(nothing.cracks.empty());
    posed::Told crack;
    const State state = torn(0.5, crack);
    EXPECT_NEAR(state.at.load_factor, 1.0 / 1.5, 0.05);
    EXPECT_EQ(state.at.step_in_stage, 1);
    EXPECT_EQ(crack.cracks.size(), 1U);
    EXPECT_EQ(crack.rows.back().cracks_tension, 1);
    EXPECT_EQ(state.body.interfaces.front(), InterfaceStatus::tension_crack);
}

// A joint under 1 MPa: tan(30) MPa over its length, which is that of the box across the platen's way too. A body that is pushed
// fast slides on by its inertia when the platen stops, and leaves it.
TEST(ExplicitSimulation, JointIsShearedWithItsFrictionHoweverFarThePlatenGoesInALoadStep) {
    for (const char* const steps : {"2", "8"}) {
        SCOPED_TRACE(steps);
        const auto run = run_scene(R"(
kluft: 1
analysis: {integrator: explicit}
materials: {rock: {density: 2600, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, friction_angle: 30, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_rounding: 0}}
geometry:
  domain: {polygon: [[0, 0], [1, 0], [1, 0.5], [1, 1], [0, 1], [0, 0.5]]}
  fractures: [{trace: [[-0.1, 0.5], [1.1, 0.5]]}]
boundaries:
  bottom: {sides: [0], support: fixed}
  lower_right: {sides: [1], support: smooth}
  top: {sides: [3]}
  upper_left: {sides: [4]}
stages:
  - {pressure: {top: 1 MPa}}
  - {displacement: {boundary: upper_left, value: 4 mm}}
)",
                                   {"stages.1.steps=" + std::string(steps)});
        ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        for (std::size_t i = 2; i < run.history.size(); ++i) {
            if (!run.history[i].balanced) continue;
            EXPECT_NEAR(run.history[i].axial_stress, 1e6 * std::tan(30 * degree), 0.01e6) << i;
        }
    }
}

// Rock of two blocks of some 27 m at a crest, where a footing pushes the upper one down its plane: 20 mm are a thousandth of their size,
// and a corner that has gone from the face below it would press as it lay, 50 times as much as there is. In the load step in which it goes it does.
TEST(ExplicitSimulation, CornerOfALargeBlockThatHasGonePressesNoMore) {
    const char* const crest = R"(
kluft: 1
analysis: {gravity: 9.81}
materials: {rock: {density: 2600, youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces:
  plane: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 28, cohesion: 60 kPa}
  release: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m, friction_angle: 0}
geometry:
  domain: {polygon: [[0, 0], [60, 0], [60, 30], [36, 30], [32, 30], [30, 30], [20, 10], [0, 10]]}
  fractures:
    - {trace: [[20, 10], [45, 27.5]], interface: plane}
    - {trace: [[40, 23.9], [40, 30.2]], interface: release}
boundaries:
  bottom: {sides: [0], support: fixed}
  footing: {sides: [3]}
stages:
  - {name: weight}
  - {name: load, displacement: {boundary: footing, value: 20 mm, against: none}, steps: 40}
)";
    const auto reference = run_scene(crest);
    const auto run = run_scene(crest, {by_steps});
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_EQ(run.history.size(), reference.history.size());
    for (std::size_t i = 3; i < run.history.size(); ++i)
        EXPECT_NEAR(run.history[i].axial_stress, reference.history[i].axial_stress,
                    0.02 * reference.history[i].axial_stress)
            << i;
    expect_closed_energy(run);
}

TEST(ExplicitSimulation, PlatenVelocityIsWhatTheSceneSays) {
    const std::string platen = "strain: {boundary: top, value: 1e-4}";
    const auto run_at = [&](const char* rate) {
        return run_scene(plane_of_weakness(platen.c_str()), {fmt::format("analysis.loading_rate={}", rate)});
    };
    const auto slow = run_at("1 mm/s");
    const auto fast = run_at("10 mm/s");
    ASSERT_EQ(slow.report.status, RunStatus::done);
    ASSERT_TRUE(slow.report.motion && fast.report.motion);
    const auto in_platen_stage = [](const SceneRun& run) {
        return run.history.back().motion->time_steps - run.history[1].motion->time_steps;
    };
    EXPECT_NEAR(in_platen_stage(slow), 10 * in_platen_stage(fast), 0.1 * in_platen_stage(slow));
    const auto largest_imbalance = [](const SceneRun& run) {
        double largest = 0.0;
        for (const StepRecord& row : run.history)
            if (row.stage == 1) largest = std::max(largest, row.motion->platen_imbalance);
        return largest;
    };
    EXPECT_LT(largest_imbalance(slow), largest_imbalance(fast));
    EXPECT_LT(slow.history.back().motion->platen_imbalance, 0.02);
    EXPECT_TRUE(slow.report.warnings.empty());
    EXPECT_THAT(run_at("1 km/s").report.warnings, // a load step takes one time step at least
                testing::ElementsAre(testing::HasSubstr("slower than loading_rate"), testing::HasSubstr("in motion")));
}

TEST(ExplicitSimulation, BodyThatNothingHoldsEndsWithADiagnosisAndFiniteNumbers) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {integrator: explicit, gravity: 10}
materials: {rock: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9}}
geometry: {domain: {rectangle: {width: 1.0, height: 1.0}}, reference_spacing: 1.0}
stages: [{name: weight, steps: 2}]
)");
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(run.report.diagnosis, testing::HasSubstr("moves towards (0, -1)"));
    EXPECT_THAT(run.report.diagnosis, testing::HasSubstr("neither a support nor a platen"));
    ASSERT_EQ(run.report.falling.size(), 1U);
    EXPECT_TRUE(run.state.body.displacement.allFinite());
    for (const StepRecord& record : run.history) EXPECT_TRUE(std::isfinite(record.axial_stress));
}

TEST(ExplicitSimulation, InterruptedRunKeepsTheLastCommittedStep) {
    const Scene scene = read_scene_text(hexagons, {by_steps});
    const Model model = build_scene_model(scene).model;
    State state = initial_state(model);
    SceneRun run;
    RecordingObserver observer(run);
    const std::atomic<bool> stop{true};
    const auto report = run_explicit(model, scene.cracks, scene.solver, scene.explicit_options, state, observer, stop);
    EXPECT_EQ(report.status, RunStatus::interrupted);
    EXPECT_THAT(report.diagnosis, testing::HasSubstr("does not go on from its saved state"));
    EXPECT_EQ(state.at.step, 0);
    EXPECT_EQ(state.body.displacement.norm(), 0.0);
}

TEST(SlowExplicitSimulation, SameSceneTwiceGivesTheSameBits) {
    const auto first = run_scene(hexagons, {by_steps});
    const auto second = run_scene(hexagons, {by_steps});
    EXPECT_EQ((first.state.body.displacement - second.state.body.displacement).norm(), 0.0);
    EXPECT_EQ(first.report.motion->time_steps, second.report.motion->time_steps);
}

/// Axial stresses within 3 % of the implicit peak at every load step before it, peaks within 5 %.
void expect_triaxial_agreement(const std::string& model, std::vector<std::string> overrides) {
    const std::string file = std::string(KLUFT_SOURCE_DIR) + "/models/triaxial/" + model + ".yaml";
    const auto reference = run_scene(read_scene(file, overrides));
    overrides.emplace_back(by_steps);
    const auto run = run_scene(read_scene(file, overrides));
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_EQ(run.history.size(), reference.history.size());
    const auto by_stress = [](const StepRecord& a, const StepRecord& b) { return a.axial_stress < b.axial_stress; };
    const auto implicit_peak = std::ranges::max_element(reference.history, by_stress);
    const double peak = implicit_peak->axial_stress;
    EXPECT_NEAR(std::ranges::max_element(run.history, by_stress)->axial_stress, peak, 0.05 * peak);
    const auto n_before = static_cast<std::size_t>(implicit_peak - reference.history.begin());
    for (std::size_t i = 0; i <= n_before; ++i)
        EXPECT_NEAR(run.history[i].axial_stress, reference.history[i].axial_stress, 0.03 * peak) << i;
    expect_closed_energy(run);
}

TEST(ExplicitSimulation, FracturedSampleFollowsTheImplicitCurve) { expect_triaxial_agreement("case-1", {}); }

TEST(SlowExplicitSimulation, SampleWithPotentialCracksFollowsTheImplicitCurveToItsPeak) {
    expect_triaxial_agreement("case-3-all", {"stages.1.steps=56", "stages.1.strain.value=0.014"});
}

} // namespace
} // namespace kluft

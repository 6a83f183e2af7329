#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "support/scene_run.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

/// A block of 4 m x 1 m on a fixed plinth, gravity turned by the slope; phi = 30 degrees.
std::string block_on_slope(double slope_degrees, const std::string& reduction, const std::string& more_joints = "",
                           const std::string& type = "joint") {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: [{:.17g}, {:.17g}]}}
materials: {{rock: {{density: 2500, youngs_modulus: 100 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30, contact_rounding: 0}}
  {}
geometry:
  domain: {{rectangle: {{width: 4, height: 1.5}}}}
  fractures: [{{trace: [[-9, 0.5], [9, 0.5]], interface: {}}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages:
  - {{name: weight, steps: 2}}
  - {{name: reduction, strength_reduction: {}, steps: 4}}
cracks: {{criterion: interface_traction}}
solver: {{tolerance: 1e-10}}
)",
                       10.0 * std::sin(slope_degrees * degree), -10.0 * std::cos(slope_degrees * degree), more_joints,
                       type, reduction);
}

// F = tan(phi)/tan(slope): the block slides where its reduced friction angle is the slope.
TEST(StrengthReduction, BlockOnASlopeHasTheRatioOfTheTangentsAsFactorOfSafety) {
    for (const double slope : {12.0, 20.0, 29.0}) {
        const auto run = run_scene(block_on_slope(slope, "{to: 4, tolerance: 1e-6}"));
        ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
        EXPECT_EQ(run.report.status, RunStatus::collapsed);
        const double expected = std::tan(30 * degree) / std::tan(slope * degree);
        EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 3e-6 * expected);
        EXPECT_EQ(run.report.unbalanced_steps, 0);
        for (const FallingBlock& each : run.report.falling) EXPECT_EQ(each.block, "1"); // not the plinth, 0
    }
}

// Whether the block stands is not known where the solves of a trial are spent: no factor then, which would be too small.
TEST(StrengthReduction, TrialWhoseSolvesAreSpentIsNoLimit) {
    const auto run = run_scene(block_on_slope(20.0, "{to: 4, tolerance: 1e-6}"), {"solver.max_step_solves=5"});
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_FALSE(run.report.results.factor_of_safety);
    EXPECT_NE(run.report.diagnosis.find("solver.max_step_solves"), std::string::npos) << run.report.diagnosis;
}

// A specimen that only pressures hold has a factor of safety too: uniaxial compression s fails where
// s = 2 (c/F) cos(phi_F)/(1 - sin(phi_F)) with tan(phi_F) = tan(phi)/F.
TEST(StrengthReduction, BodyHeldByPressuresAloneHasAFactorOfSafety) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1e10, poissons_ratio: 0, cohesion: 0.1 MPa, friction_angle: 30, tensile_strength: 0.01 MPa}}
interfaces:
  bond: {kind: potential_crack, normal_stiffness: 1e11, shear_stiffness: 1e11, fails_to: joint}
  joint: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11}
geometry: {domain: {rectangle: {width: 1, height: 2}}, fractures: [{trace: [[-1, 0], [2, 2]], interface: bond}], reference_spacing: 1}
stages:
  - {name: load, pressure: {top: 0.1 MPa, bottom: 0.1 MPa}}
  - {name: reduction, strength_reduction: {to: 20, interfaces: [bond]}, steps: 20}
)");
    ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
    EXPECT_EQ(run.report.status, RunStatus::collapsed);
    const auto strength = [](double f) {
        const double phi = std::atan(std::tan(30 * degree) / f);
        return 2 * 0.1e6 / f * std::cos(phi) / (1 - std::sin(phi));
    };
    EXPECT_NEAR(strength(*run.report.results.factor_of_safety), 0.1e6, 2e-3 * 0.1e6);
}

// A slope above the friction angle is weak: its factor of safety is less than 1, and its weight is brought up with
// strengths that are not divided but multiplied.
TEST(StrengthReduction, SlopeSteeperThanItsFrictionAngleHasAFactorBelowOne) {
    const auto run = run_scene(block_on_slope(40.0, "{from: 0.3, to: 1, tolerance: 1e-6}"));
    ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
    const double expected = std::tan(30 * degree) / std::tan(40 * degree);
    EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 3e-6 * expected);
    EXPECT_EQ(run.history.front().strength_factor, 0.3);
    EXPECT_EQ(run.history.back().strength_factor, run.report.results.factor_of_safety);
}

// The default tolerance, and a factor that lies between two steps of the stage.
TEST(StrengthReduction, FactorOfSafetyIsFoundWithinItsTolerance) {
    const auto run = run_scene(block_on_slope(20.0, "{to: 2}"));
    ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
    const double expected = std::tan(30 * degree) / std::tan(20 * degree);
    EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 2e-4 * expected);
}

TEST(StrengthReduction, BodyThatStandsToTheEndHasNoFactorOfSafetyButAWarning) {
    const auto run = run_scene(block_on_slope(20.0, "{to: 1.5}"));
    EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_FALSE(run.report.results.factor_of_safety);
    ASSERT_EQ(run.report.warnings.size(), 1U);
    EXPECT_NE(run.report.warnings.front().find("above 1.5"), std::string::npos);
    EXPECT_EQ(run.history.back().strength_factor, 1.5);
}

TEST(StrengthReduction, BodyThatDoesNotStandAtTheFirstFactorHasNone) {
    const auto run = run_scene(block_on_slope(40.0, "{to: 2}"));
    EXPECT_NE(run.report.status, RunStatus::done);
    EXPECT_FALSE(run.report.results.factor_of_safety);
}

// F = tan(30 deg)/tan(40 deg) = 0.69 is below 0.7 and 1, and above 0.65, with which the search goes on to it.
TEST(StrengthReduction, AFactorBelowTheFirstIsSaidToBeSo) {
    for (const char* from : {"0.7", "1"}) {
        const auto run = run_scene(block_on_slope(40.0, fmt::format("{{from: {}, to: 2}}", from)));
        EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
        EXPECT_THAT(run.report.diagnosis, testing::HasSubstr(fmt::format(
                                              "its factor of safety is below stages.1.strength_reduction.from, {}, "
                                              "with which the body was loaded",
                                              from)));
    }
    const auto run = run_scene(block_on_slope(40.0, "{from: 0.65, to: 2}"));
    EXPECT_TRUE(run.report.results.factor_of_safety);
    EXPECT_THAT(run.report.diagnosis, testing::Not(testing::HasSubstr("is below")));
}

// A crumb of 1 mm on a plane of 40 degrees, which it slides down with a friction of 30; the other block stands with any.
TEST(StrengthReduction, ASliverThatFailsFirstIsNamedBesideTheFactor) {
    const double slope = std::numbers::pi * 40.0 / 180.0;
    const Vec2 up = 1e-3 * Vec2(-std::cos(slope), std::sin(slope));
    const Vec2 out = 1e-3 * Vec2(std::sin(slope), std::cos(slope));
    const Vec2 foot(5.5, 0.5 * std::tan(slope));
    std::string crumb;
    for (const Vec2& corner : {foot, Vec2(foot + out), Vec2(foot + out + up), Vec2(foot + up)})
        crumb += fmt::format("[{:.17g}, {:.17g}], ", corner.x(), corner.y());
    const auto run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2600, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, friction_angle: 30, normal_stiffness: 1e10, shear_stiffness: 1e10}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[0, -1], [2, -1], [2, 0], [0, 0]], support: fixed}}
    - {{name: block, polygon: [[0.5, 0], [1.5, 0], [1.5, 1], [0.5, 1]]}}
    - {{name: ramp, polygon: [[5, 0], [6, 0], [5, {:.17g}]], support: fixed}}
    - {{name: crumb, polygon: [{}]}}
stages: [{{steps: 1}}, {{strength_reduction: {{to: 2}}, steps: 2}}]
)",
                                           std::tan(slope), crumb.substr(0, crumb.size() - 2)));
    EXPECT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(
        run.report.diagnosis,
        testing::HasSubstr("block 'crumb' is a sliver, which may fail where the body stands: "
                           "`geometry.reference_spacing` leaves it out; or else its factor of safety is below"));
}

TEST(StrengthReduction, InterfacesThatAreNotNamedKeepTheirStrength) {
    const auto run = run_scene(
        block_on_slope(20.0, "{to: 2, interfaces: [other]}",
                       "other: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30}"));
    EXPECT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    EXPECT_FALSE(run.report.results.factor_of_safety);
}

// Two cuts, of which the upper one alone is reduced: tan 30/tan 20 = 1.586 is that of the cut, not of the body.
TEST(StrengthReduction, AFactorOfSomeInterfacesSaysOfWhich) {
    const auto run_with = [](const std::string& interfaces, const std::string& above) {
        return run_scene(block_on_slope(20.0, fmt::format("{{to: 2{}}}", interfaces),
                                        "other: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, "
                                        "friction_angle: 40, contact_rounding: 0}"),
                         {fmt::format("geometry.fractures.1={{trace: [[-9, 1], [9, 1]], interface: {}}}", above)});
    };
    const auto of_part = run_with(", interfaces: [joint]", "other");
    EXPECT_THAT(of_part.report.reduced_alone, testing::ElementsAre("joint"));
    EXPECT_THAT(of_part.report.diagnosis, testing::StartsWith("factor of safety of joint alone 1.58"));
    const auto stands = run_with(", interfaces: [other]", "other");
    EXPECT_THAT(stands.report.warnings,
                testing::Contains(testing::HasSubstr("the factor of safety of other alone is above 2")));
    for (const auto& of_all : {run_with(", interfaces: [other, joint]", "other"), run_with("", "other"),
                               run_with(", interfaces: [joint]", "joint")}) {
        EXPECT_THAT(of_all.report.reduced_alone, testing::IsEmpty());
        EXPECT_THAT(of_all.report.diagnosis, testing::StartsWith("factor of safety 1.58"));
    }
}

// A bond on a slope that nothing holds once it is broken: it breaks where c L/F + W cos tan(phi)/F = W sin.
TEST(StrengthReduction, StrengthOfAPotentialCrackIsDividedToo) {
    const auto run = run_scene(block_on_slope(50.0, "{to: 4, tolerance: 1e-6}",
                                              "bond: {kind: potential_crack, normal_stiffness: 1e11, shear_stiffness: "
                                              "1e11, fails_to: joint, cohesion: 20 kPa, "
                                              "friction_angle: 30, tensile_strength: 30 kPa}",
                                              "bond"));
    ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
    const double weight = 2500.0 * 10.0 * 4.0;
    const double expected =
        (20e3 * 4.0 + weight * std::cos(50 * degree) * std::tan(30 * degree)) / (weight * std::sin(50 * degree));
    EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 1e-5 * expected);
    EXPECT_TRUE(run.cracks.empty()); // of the steps that failed nothing is told
}

// What pictures show of the last state is computed with the strengths that it stood with.
TEST(StrengthReduction, FieldsOfASavedStateHaveTheReducedStrengths) {
    const auto run = run_scene(block_on_slope(20.0, "{to: 2, tolerance: 1e-6}"));
    ASSERT_TRUE(run.report.results.factor_of_safety);
    const auto& shown = run.fields.back().interfaces.front();
    const auto saved = fields_of_state(run.model, run.state).interfaces.front();
    EXPECT_NEAR(saved.shear_traction, shown.shear_traction, 1e-6 * std::abs(shown.shear_traction));
    EXPECT_EQ(saved.state, shown.state);
}

// A resumed run goes on with the factors: the state is that of a step before the limit.
TEST(StrengthReduction, RunThatIsResumedInTheStageFindsTheSameFactor) {
    const Scene scene = read_scene_text(block_on_slope(20.0, "{to: 2, tolerance: 1e-5}"));
    const Model model = build_scene_model(scene).model;
    struct Stop : StepObserver {
        std::atomic<bool> stop{false};
        void step(const StepRecord& record, const State&, const std::function<FieldRecord()>&, bool) override {
            stop = record.step == 3;
        }
    } observer;
    State state = initial_state(model);
    const RunReport stopped = run_simulation(model, scene.cracks, scene.solver, state, observer, observer.stop);
    EXPECT_EQ(stopped.status, RunStatus::interrupted);
    EXPECT_EQ(state.at.step_in_stage, 1);
    const double stood = model.loads.stages[state.at.stage].strength_reduction->factor_at(state.at.load_factor);
    EXPECT_EQ(stopped.diagnosis.find(fmt::format("the body stood with the strengths divided by {:.4g}, ", stood)), 0U)
        << stopped.diagnosis;
    EXPECT_FALSE(stopped.results.factor_of_safety);
    observer.stop = false;
    const auto resumed = run_simulation(model, scene.cracks, scene.solver, state, observer, observer.stop);
    ASSERT_TRUE(resumed.results.factor_of_safety) << resumed.diagnosis;
    const double expected = std::tan(30 * degree) / std::tan(20 * degree);
    EXPECT_NEAR(*resumed.results.factor_of_safety, expected, 2e-5 * expected);
}

/// A vertical face of 10 m over a plane that dips 45 degrees out of it; c 20 kPa, phi 30 degrees, 25 kN/m3.
std::string planar_slope(const std::string& trace, double onset) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: strain, gravity: 10}}
materials: {{rock: {{density: 2500, youngs_modulus: 20 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30, cohesion: 20 kPa, cohesion_onset: {}, contact_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: 12, height: 12, origin: [0, -2]}}}}
  fractures: [{{trace: {}, interface: joint}}]
  reference_spacing: 0.1
boundaries: {{bottom: {{support: fixed}}}}
stages:
  - {{name: weight, steps: 2}}
  - {{name: reduction, strength_reduction: {{from: 0.5, to: 1.5, tolerance: 1e-5}}, steps: 5}}
solver: {{tolerance: 1e-10}}
)",
                       onset, trace);
}

// F = (c L + W cos(45) tan(30))/(W sin(45)), L = 14.142 m, W = 1250 kN/m. The normal traction falls to zero at the upper
// end of the plane; the point that stands there has the cohesion of its piece of the plane, whether that is in one piece
// or a corner of the trace (of 1e-6 m) near the top makes the last piece 0.1 % of the length.
TEST(StrengthReduction, PlanarSlopeHasTheFactorOfSafetyOfLimitEquilibrium) {
    const double weight = 1.25e6, length = 10.0 * std::sqrt(2.0);
    const auto factor = [&](double cohesive_length) {
        return (20e3 * cohesive_length + weight * std::cos(45 * degree) * std::tan(30 * degree)) /
               (weight * std::sin(45 * degree));
    };
    EXPECT_NEAR(factor(length), 0.8974, 5e-5);
    for (const char* trace : {"[[0, 0], [10, 10]]", "[[0, 0], [9.99, 9.990001], [10, 10]]"}) {
        const auto run = run_scene(planar_slope(trace, 20.0));
        ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
        EXPECT_NEAR(*run.report.results.factor_of_safety, factor(length), 1e-4) << trace;
    }
}

/// A block of `width` by `height` on a joint of k_n = 1e12 Pa/m that dips; gravity is turned in its place. Weight 25 kN/m3.
std::string cohesive_block(double width, double height, double dip, int pieces) {
    std::string top_of_base;
    for (int i = pieces; i >= 0; --i) top_of_base += fmt::format(", [{:.17g}, 0]", width * i / pieces);
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: [{}, {}]}}
materials: {{rock: {{density: 2500, youngs_modulus: 1e14, poissons_ratio: 0}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12, friction_angle: 30, cohesion: 20 kPa}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[-5, -1], [{}, -1], [{}, 0]{}, [-5, 0]], support: fixed}}
    - {{name: block, polygon: [[0, 0], [{}, 0], [{}, {}], [0, {}]]}}
stages:
  - {{name: weight}}
  - {{name: reduction, strength_reduction: {{from: 0.5, to: 3, tolerance: 1e-4}}, steps: 10}}
)",
                       10 * std::sin(dip * degree), -10 * std::cos(dip * degree), width + 5, width + 5, top_of_base,
                       width, width, height, height);
}

// Only the closed part of a joint has cohesion. The resultant meets the joint at e = h/2 tan(dip) from its middle; without tension
// the closed part is L = 3 (b/2 - e) long where e > b/6, and F = (N tan(phi) + c L)/T.
TEST(SlowStrengthReduction, PartlyOpenJointHasTheCohesionOfItsClosedPart) {
    struct Case {
        double width, height, dip;
    };
    for (const auto& [width, height, dip] :
         {Case{3.0, 1.5, 45.0}, Case{2.0, 2.0, 40.0}, Case{4.0, 1.0, 30.0}, Case{2.0, 1.9, 35.0}}) {
        const double weight = 25e3 * width * height;
        const double e = 0.5 * height * std::tan(dip * degree);
        const double closed = e > width / 6 ? 3 * (width / 2 - e) : width;
        const double expected = (weight * std::cos(dip * degree) * std::tan(30 * degree) + 20e3 * closed) /
                                (weight * std::sin(dip * degree));
        for (const int pieces : {1, 4}) {
            const auto run = run_scene(cohesive_block(width, height, dip, pieces));
            ASSERT_TRUE(run.report.results.factor_of_safety) << run.report.diagnosis;
            EXPECT_NEAR(*run.report.results.factor_of_safety, expected, 0.01 * expected)
                << width << " x " << height << ", " << pieces;
        }
    }
}

} // namespace
} // namespace kluft

#include "kluft/simulation/step_control.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

// ---- the rule ------------------------------------------------------------------------------------------------------

// A path error e h^2 that adds up over 1/h steps to e h: h = a/e, with the safety factor 0.9.
TEST(StepControl, SizeFollowsFromAnErrorThatGrowsWithItsSquare) {
    const double accuracy = 0.01, curvature = 0.4, size = 0.02;
    const StepError error{curvature * size * size, 0.0};
    EXPECT_TRUE(is_accurate(size, error, accuracy));
    EXPECT_NEAR(next_step_size(size, error, accuracy), 0.9 * accuracy / curvature, 1e-12);
    EXPECT_FALSE(is_accurate(0.03, {curvature * 0.03 * 0.03, 0.0}, accuracy));
}

// The error of a chord does not add up: 4e-4 (h/0.01)^2 = 0.01 at h = 0.05.
TEST(StepControl, ChordIsAsLongAsItsOwnErrorAllows) {
    EXPECT_NEAR(next_step_size(0.04, {0.0, 6.4e-3}, 0.01), 0.9 * 0.05, 1e-12);
}

TEST(StepControl, StepWithoutErrorDoublesTheNextOne) { EXPECT_EQ(next_step_size(0.1, {}, 0.01), 0.2); }

TEST(StepControl, NoSplinterStaysForTheLastStep) {
    EXPECT_EQ(fitted_step_size(0.25, 1.0), 0.25);
    EXPECT_EQ(fitted_step_size(0.9, 1.0), 0.5);
    EXPECT_EQ(fitted_step_size(3.0, 0.5), 0.5);
}

// ---- events at their own load --------------------------------------------------------------------------------------

/// One plane, dipping 60 degrees, through a specimen of nearly rigid blocks under 0.2 MPa (validation/plane-of-weakness).
std::string plane_of_weakness(const std::string& plane, int steps, const std::string& solver) {
    const double rise = std::sqrt(3.0);
    return fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1e13, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e13, shear_stiffness: 1e13, cohesion: 0.1 MPa, friction_angle: 30,
          contact_rounding: 0, friction_rounding: 0}}
  bond: {{kind: potential_crack, normal_stiffness: 1e13, shear_stiffness: 1e13, cohesion: 0.3 MPa, friction_angle: 30,
         tensile_strength: 0.1 MPa, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: 1, height: {}}}}}
  fractures: [{{trace: [[-0.05, {}], [1.05, {}]], interface: {}}}]
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{name: pressure, pressure: {{left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}}}}
  - {{name: platen, displacement: {{boundary: top, value: 2e-6}}, steps: {}}}
solver: {{tolerance: 1e-9, balance: 1e-6{}}}
)",
                       rise + 1.0, 0.5 - 0.05 * rise, 0.5 + 1.05 * rise, plane, steps, solver);
}

/// Rows of the platen's stage, the last one before it first.
std::vector<StepRecord> platen_equilibria(const SceneRun& run) {
    std::vector<StepRecord> rows;
    std::ranges::copy_if(run.equilibria, std::back_inserter(rows), [](const StepRecord& r) { return r.stage == 1; });
    return rows;
}

/// How near an equilibrium comes to the corner of the curve: the end of the elastic line at the stress of slip, relative
/// to that stress.
double distance_from_corner(const SceneRun& run, double slip_stress, double modulus) {
    const auto rows = platen_equilibria(run);
    double nearest = 1.0;
    for (const StepRecord& row : rows) {
        const double along = std::abs(modulus * row.axial_strain / slip_stress - 1.0);
        const double up = std::abs(row.differential_stress / slip_stress - 1.0);
        nearest = std::min(nearest, std::max(along, up));
    }
    return nearest;
}

// Jaeger (1960): p1 - p3 = 2 (c + p3 tan phi)/((1 - tan phi cot beta) sin 2 beta) at slip, with beta = 60 degrees.
TEST(StepControl, MappedFractureSlipsFirstAtItsOwnLoad) {
    const double tan_phi = std::tan(std::numbers::pi / 6);
    const double slip = 2 * (0.1e6 + 0.2e6 * tan_phi) / ((1 - tan_phi / std::sqrt(3.0)) * std::sqrt(0.75));
    const auto fine = run_scene(plane_of_weakness("joint", 400, ""));
    const StepRecord first = platen_equilibria(fine).front(); // well below slip
    const double modulus = first.differential_stress / first.axial_strain;
    for (const int steps : {5, 37}) {
        const auto run = run_scene(plane_of_weakness("joint", steps, ", accuracy: 0.01"));
        ASSERT_EQ(run.report.status, RunStatus::done);
        EXPECT_LT(distance_from_corner(run, slip, modulus), 0.012) << steps;
        EXPECT_EQ(run.state.control.slipped, std::vector{0});
    }
    // steps pass the corner
    EXPECT_GT(distance_from_corner(run_scene(plane_of_weakness("joint", 5, "")), slip, modulus), 0.05);
}

// Mohr-Coulomb: p1 = p3 N + 2 c sqrt(N) with N = 3 at 30 degrees, p3 = 0.2 MPa.
TEST(StepControl, PotentialCrackFailsAtItsOwnLoadFromAnyFirstStep) {
    const double strength = 3.0 * 0.2e6 + 2 * 0.3e6 * std::sqrt(3.0);
    for (const int steps : {1, 10, 100}) {
        const auto run = run_scene(plane_of_weakness("bond", steps, ", accuracy: 0.01"));
        ASSERT_EQ(run.report.status, RunStatus::done);
        ASSERT_EQ(run.cracks.size(), 1U) << steps;
        double peak = 0.0;
        for (const StepRecord& row : run.equilibria) peak = std::max(peak, row.axial_stress);
        EXPECT_NEAR(peak, strength, 0.0105 * strength) << steps;
        EXPECT_LT(*run.report.results.estimated_error, 0.02);
    }
}

// ---- frictional path -----------------------------------------------------------------------------------------------

/// The confined block with a diagonal joint in a load cycle (validation/joint-load-cycle).
std::string load_cycle(int steps, const std::string& solver) {
    return fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 10 GPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 50 GPa/m, shear_stiffness: 25 GPa/m, friction_angle: 15,
          contact_rounding: 0, friction_rounding: 0}}
geometry:
  domain: {{rectangle: {{width: 1, height: 1}}}}
  fractures: [{{trace: [[0, 0], [1, 1]]}}]
boundaries: {{bottom: {{support: smooth}}, left: {{support: smooth}}, right: {{support: smooth}}}}
stages:
  - {{name: loading, displacement: {{boundary: top, value: 1e-8}}, steps: {}}}
  - {{name: unloading, displacement: {{boundary: top, value: -8e-9}}, steps: {}}}
solver: {{tolerance: 1e-10, balance: 1e-9{}}}
)",
                       steps, steps, solver);
}

/// Largest difference of the axial stress from `curve` at the same stage and load factor, over the largest stress.
double curve_error(const SceneRun& run, const SceneRun& curve) {
    double error = 0.0, largest = 0.0;
    for (const StepRecord& row : curve.history) {
        largest = std::max(largest, std::abs(row.axial_stress));
        const auto after = std::ranges::find_if(run.history, [&](const StepRecord& r) {
            return r.stage > row.stage || (r.stage == row.stage && r.load_factor >= row.load_factor);
        });
        if (after == run.history.begin() || after == run.history.end()) continue;
        const StepRecord& before = *(after - 1);
        const double start = before.stage == after->stage ? before.load_factor : 0.0;
        const double share = (row.load_factor - start) / (after->load_factor - start);
        error =
            std::max(error, std::abs(std::lerp(before.axial_stress, after->axial_stress, share) - row.axial_stress));
    }
    return error / largest;
}

// Against 200 steps: the law is piecewise linear, and the chords show where it bends. They are judged at their middles;
// a bend elsewhere can be missed by twice as much.
TEST(StepControl, CycleOfAFrictionalJointIsFollowedToTheAccuracyFromAnyFirstStep) {
    const auto reference = run_scene(load_cycle(200, ""));
    for (const int steps : {1, 3, 50}) {
        const auto run = run_scene(load_cycle(steps, ", accuracy: 0.01"));
        ASSERT_EQ(run.report.status, RunStatus::done);
        EXPECT_LT(curve_error(run, reference), 0.02) << steps;
        EXPECT_LT(run.history.size(), 100U) << steps;
    }
}

// Shear over friction does not depend on the load: f > 1 as soon as there is any, and no load is that of the first slip.
TEST(StepControl, SlipUnderAnyLoadIsNoErrorAndNoLongSearch) {
    const auto run = run_scene(load_cycle(20, ", accuracy: 0.01"));
    EXPECT_EQ(run.state.control.slipped, std::vector{0});
    EXPECT_LT(*run.report.results.estimated_error, 0.01);
    EXPECT_GT(run.history[1].load_factor, 1e-9);
    EXPECT_LT(run.history[1].open_close_iterations, 60);
}

TEST(StepControl, LessAccuracyCostsLess) {
    const auto solves = [](const char* accuracy) {
        return run_scene(load_cycle(20, fmt::format(", accuracy: {}", accuracy))).report.costs.open_close_iterations;
    };
    EXPECT_LT(solves("0.1"), solves("0.001"));
}

TEST(StepControl, WithoutAnAccuracyThereIsNoEstimate) {
    const auto run = run_scene(load_cycle(4, ""));
    EXPECT_FALSE(run.report.results.estimated_error.has_value());
    EXPECT_EQ(run.report.costs.rejected_steps, 0);
    EXPECT_EQ(run.history.size(), 9U);
}

// Small motions: contacts stay where they are, so that fewer detections change nothing but their number.
TEST(StepControl, ContactsAreDetectedInEveryFifthStepOnly) {
    const auto each = run_scene(load_cycle(20, ""));
    const auto fifth = run_scene(load_cycle(20, ", detection_every: 5"));
    EXPECT_EQ(each.report.detections, 5 * fifth.report.detections - 4); // one for the initial state
    EXPECT_NEAR(fifth.history.back().axial_stress, each.history.back().axial_stress,
                1e-6 * std::abs(each.history[20].axial_stress));
}

// `all` breaks at the ends of steps; those that are too long are taken back with what broke in them.
TEST(SlowStepControl, CracksOfARejectedStepAreNotToldOf) {
    const auto run = run_scene(read_scene(KLUFT_SOURCE_DIR "/tests/support/specimen_of_hexagons.yaml",
                                          {"cracks.update=all", "solver.accuracy=0.02", "stages.1.strain.value=0.01"}));
    EXPECT_GT(run.report.costs.rejected_steps, 0);
    const StepRecord& last = run.history.back();
    EXPECT_GT(run.cracks.size(), 0U);
    EXPECT_EQ(run.cracks.size(), static_cast<std::size_t>(last.cracks_tension + last.cracks_shear));
}

// ---- whole sample --------------------------------------------------------------------------------------------------

std::string sample(int steps, const std::string& options) {
    return fmt::format(R"(
extends: {}/models/triaxial/case-3-all.yaml
stages:
  - {{name: pressure, pressure: {{left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}}, steps: 4}}
  - {{name: platen, strain: {{boundary: top, value: 1.3 %}}, platens: smooth, steps: {}}}
{}
)",
                       KLUFT_SOURCE_DIR, steps, options);
}

double peak_of(const SceneRun& run) {
    double peak = 0.0;
    for (const StepRecord& row : run.equilibria)
        if (row.balanced) peak = std::max(peak, row.axial_stress);
    return peak;
}

// Against events located to 1e-3 with 13 fixed steps.
TEST(SlowStepControl, PeakOfACrackingSampleIsMetToTheAccuracyFromAnyFirstStep) {
    const double reference = peak_of(run_scene(sample(13, "cracks: {event_tolerance: 1e-3}")));
    for (const int steps : {13, 400}) {
        const auto run = run_scene(sample(steps, "solver: {accuracy: 0.01}"));
        ASSERT_EQ(run.report.status, RunStatus::done);
        EXPECT_NEAR(peak_of(run), reference, 0.01 * reference) << steps;
        EXPECT_LT(run.report.costs.open_close_iterations, 500) << steps;
    }
}

// Two cracks of this specimen nearly fail together, and the first relieves the second: failing both at once takes it to 15.5 MPa.
// Against fixed load steps with events located to 1e-4.
TEST(SlowStepControl, ACrackThatItsNeighbourRelievesDoesNotFailWithIt) {
    const auto peak_with = [](const std::string& setting) {
        return peak_of(run_scene(read_scene(KLUFT_SOURCE_DIR "/models/quickstart.yaml",
                                            {setting, "stages.1.stop_after_drop=2 %", "stages.1.steps=20"})));
    };
    const double reference = peak_with("cracks.event_tolerance=1e-4");
    for (const double accuracy : {0.01, 0.005})
        EXPECT_NEAR(peak_with(fmt::format("solver.accuracy={}", accuracy)), reference, accuracy * reference)
            << accuracy;
}

} // namespace
} // namespace kluft

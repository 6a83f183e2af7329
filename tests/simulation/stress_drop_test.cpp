// Stages that end where the axial stress has fallen from the largest one.
#include "kluft/simulation/stress_drop.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;

Stage stage_that_waits(double platen_value, double drop) {
    Stage stage;
    stage.motion = PlatenMotion{.value = platen_value};
    stage.stop_after_drop = drop;
    return stage;
}

/// Whether the stage has ended after these axial stresses, the last of which may be unbalanced.
bool ends_after(const Stage& stage, const std::vector<double>& stresses, bool balanced = true) {
    StressHistory history;
    for (std::size_t i = 0; i < stresses.size(); ++i) {
        StepRecord row;
        row.axial_stress = stresses[i];
        row.balanced = balanced || i + 1 < stresses.size();
        note_axial_stress(stage, row, history);
    }
    return has_dropped(stage, history);
}

TEST(StressDrop, CountsFromTheLargestStressOfTheStage) {
    const Stage stage = stage_that_waits(0.01, 0.2);
    EXPECT_FALSE(ends_after(stage, {}));
    EXPECT_FALSE(ends_after(stage, {1e6, 5e6, 4.001e6}));
    EXPECT_TRUE(ends_after(stage, {1e6, 5e6, 4e6}));
    EXPECT_FALSE(ends_after(stage, {1e6, 5e6, 4e6, 4.1e6}));
    Stage patient = stage;
    patient.stop_after_drop.reset();
    EXPECT_FALSE(ends_after(patient, {5e6, 0.0}));
}

TEST(StressDrop, PullingPlatenLosesTension) {
    const Stage stage = stage_that_waits(-0.01, 0.5);
    EXPECT_FALSE(ends_after(stage, {2e6, 1e6, 0.0})); // pressed at first, and unloaded
    EXPECT_FALSE(ends_after(stage, {2e6, -1e6, -0.6e6}));
    EXPECT_TRUE(ends_after(stage, {2e6, -1e6, -0.5e6}));
}

TEST(StressDrop, UnbalancedEquilibriumIsNeverTheLargest) {
    const Stage stage = stage_that_waits(0.01, 0.2);
    StressHistory history;
    for (const auto& [stress, balanced] : {std::pair{4e6, true}, std::pair{9e6, false}, std::pair{3.9e6, true}}) {
        StepRecord row;
        row.axial_stress = stress;
        row.balanced = balanced;
        note_axial_stress(stage, row, history);
    }
    EXPECT_EQ(history.largest_in_stage, 4e6);
    EXPECT_EQ(history.largest_axial, 4e6);
    EXPECT_FALSE(has_dropped(stage, history));
}

// A body of hexagons that collapses at half of the strain of its second stage.
const std::string collapsing_body = R"(
kluft: 1
materials: {r: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 0.1 MPa, friction_angle: 30,
                tensile_strength: 0.05 MPa}}
interfaces:
  j: {kind: fracture, friction_angle: 20, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
  p: {kind: potential_crack, fails_to: j, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
geometry: {domain: {rectangle: {width: 1, height: 2}}, tessellation: {hexagons: {spacing: 0.4}, interface: p}}
stages:
  - {pressure: {left: 20 kPa, right: 20 kPa, top: 20 kPa, bottom: 20 kPa}}
  - {strain: {boundary: top, value: 0.1 %}, platens: {friction_angle: 20}, steps: 20}
  - {strain: {boundary: top, value: 0.01 %}}
solver: {repeatable: true}
)";

const std::string stop = "stages.1.stop_after_drop=20 %";

/// The step of the first row of the stage that is balanced and lies by `drop` below all that came before it in the stage.
int first_step_below(const SceneRun& whole, int stage, double drop) {
    for (const StepRecord& row : whole.history) {
        if (row.stage != stage || !row.balanced) continue;
        double largest = 0.0;
        for (const StepRecord& each : whole.equilibria)
            if (each.stage == stage && each.step <= row.step && each.balanced)
                largest = std::max(largest, each.axial_stress);
        if (row.axial_stress <= (1.0 - drop) * largest) return row.step;
    }
    return -1;
}

void expect_same_rows(const std::vector<StepRecord>& rows, const std::vector<StepRecord>& whole) {
    ASSERT_LE(rows.size(), whole.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].step, whole[i].step);
        EXPECT_EQ(rows[i].axial_stress, whole[i].axial_stress) << i;
        EXPECT_EQ(rows[i].axial_strain, whole[i].axial_strain) << i;
    }
}

// What the whole run has up to there, and nothing more.
TEST(SlowStressDrop, RunEndsAtTheFirstBalancedLoadStepBelow) {
    for (const std::string integrator : {"implicit", "explicit"}) {
        const std::string by = "analysis.integrator=" + integrator;
        const SceneRun whole = run_scene(collapsing_body, {by});
        ASSERT_EQ(whole.report.status, RunStatus::done);
        EXPECT_EQ(whole.report.remark, "");
        EXPECT_EQ(whole.history.back().stage, 2);
        const int last = first_step_below(whole, 1, 0.2);
        ASSERT_GT(last, 1) << integrator;
        ASSERT_LT(last, 21) << integrator;
        const SceneRun run = run_scene(collapsing_body, {by, stop});
        EXPECT_EQ(run.report.status, RunStatus::done);
        EXPECT_THAT(run.report.remark, HasSubstr("stopped in stage 1 at load step " + std::to_string(last)));
        EXPECT_EQ(run.history.back().step, last);
        EXPECT_EQ(run.state.at.step, last);
        expect_same_rows(run.history, whole.history);
        expect_same_rows(run.equilibria, whole.equilibria);
    }
}

TEST(StressDrop, RunOfLoadStepsFromAnAccuracyEndsToo) {
    const std::vector<std::string> accurate{"solver.accuracy=0.05"};
    const SceneRun whole = run_scene(collapsing_body, accurate);
    const int last = first_step_below(whole, 1, 0.2);
    ASSERT_GT(last, 1);
    const SceneRun run = run_scene(collapsing_body, {accurate.front(), stop});
    EXPECT_EQ(run.report.status, RunStatus::done);
    EXPECT_EQ(run.history.back().step, last);
    EXPECT_EQ(run.history.back().stage, 1);
}

TEST(StressDrop, PressureStageBeforeDoesNotCount) {
    const SceneRun run =
        run_scene(collapsing_body, {"stages.0.pressure.top=0.4 MPa", "stages.0.pressure.bottom=0.4 MPa",
                                    "materials.r.cohesion=1 MPa", "materials.r.tensile_strength=1 MPa",
                                    "stages.1.stop_after_drop=1 %", "stages.1.strain.value=-0.01 %"});
    EXPECT_EQ(run.report.status, RunStatus::done); // the platen goes back, which is no drop of what it presses with
    EXPECT_EQ(run.history.back().stage, 2);
    EXPECT_LT(run.history[run.history.size() - 2].axial_stress, 0.35e6);
}

} // namespace
} // namespace kluft

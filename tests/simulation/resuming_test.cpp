// How a resumed run goes on, and that a run which had ended ends the same when it is resumed.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/simulation/stress_drop.hpp"
#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using testing::HasSubstr;

/// Also keeps the state after each load step, that before any load first.
class StateKeeper : public RecordingObserver {
public:
    StateKeeper(SceneRun& run, std::vector<State>& states) : RecordingObserver(run), states_(states) {}
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>& fields,
              bool last) override {
        RecordingObserver::step(record, state, fields, last);
        states_.push_back(state);
    }

private:
    std::vector<State>& states_;
};

/// Goes on from a state of the run of the same scene.
SceneRun resumed(const SceneRun& of, const State& from) {
    SceneRun run{.scene = of.scene, .model = of.model, .state = from};
    RecordingObserver observer(run);
    const std::atomic<bool> stop{false};
    run.report = run_simulation(run.model, run.scene.cracks, run.scene.solver, run.state, observer, stop);
    return run;
}

/// Runs a model posed in code.
SceneRun run_model(Model model, double accuracy) {
    SceneRun posed;
    posed.model = std::move(model);
    posed.scene.solver = posed::Workplace::tight();
    posed.scene.solver.accuracy = accuracy;
    return resumed(posed, initial_state(posed.model));
}

// Cracks have the strain of the event that they failed at, on the way to the end of the load step, and those in a motion that
// of the equilibrium that the motion began at; in the first load step of a resumed run as well.
TEST(SlowResuming, CracksOfTheFirstLoadStepHaveTheStrainTheyWouldHaveWithoutIt) {
    SceneRun whole;
    whole.scene = read_scene_text(R"(
kluft: 1
materials: {r: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 0.1 MPa, friction_angle: 30,
                tensile_strength: 0.05 MPa}}
interfaces:
  j: {kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
  p: {kind: potential_crack, fails_to: j, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
geometry: {domain: {rectangle: {width: 1, height: 2}}, tessellation: {hexagons: {spacing: 0.4}, interface: p}}
stages: [{strain: {boundary: top, value: 0.1 %}, platens: {friction_angle: 20}, steps: 10}]
solver: {repeatable: true}
)");
    whole.model = build_scene_model(whole.scene).model;
    whole.state = initial_state(whole.model);
    std::vector<State> states;
    StateKeeper observer(whole, states);
    const std::atomic<bool> stop{false};
    (void)run_simulation(whole.model, whole.scene.cracks, whole.scene.solver, whole.state, observer, stop);
    ASSERT_EQ(states.size(), 11U);
    int n_on_the_way = 0;
    for (int step = 1; step < 10; ++step) {
        std::vector<CrackRecord> expected = whole.cracks;
        std::erase_if(expected, [&](const CrackRecord& crack) { return crack.step <= step; });
        for (const CrackRecord& crack : expected)
            if (crack.step == step + 1 && crack.axial_strain < whole.history[step + 1].axial_strain) ++n_on_the_way;
        const SceneRun rest = resumed(whole, states[step]);
        ASSERT_EQ(rest.cracks.size(), expected.size()) << step;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(rest.cracks[i].interface, expected[i].interface) << step;
            EXPECT_EQ(rest.cracks[i].axial_strain, expected[i].axial_strain) << step;
        }
    }
    EXPECT_GT(n_on_the_way, 0);
}

/// Goes on from the end of a run; returns the report.
RunReport expect_same_end(const SceneRun& run) {
    const SceneRun again = resumed(run, run.state);
    EXPECT_EQ(again.report.status, run.report.status);
    EXPECT_EQ(again.report.results.factor_of_safety, run.report.results.factor_of_safety);
    EXPECT_EQ(again.report.falling.size(),
              run.report.falling.size()); // that were followed as far as it took to see that they fall
    for (std::size_t i = 0; i < std::min(again.report.falling.size(), run.report.falling.size()); ++i) {
        EXPECT_EQ(again.report.falling[i].block, run.report.falling[i].block);
        EXPECT_LT((again.report.falling[i].direction - run.report.falling[i].direction).norm(), 1e-5);
        EXPECT_EQ(again.report.falling[i].turn, run.report.falling[i].turn);
    }
    EXPECT_TRUE(again.history.empty());
    EXPECT_TRUE(again.cracks.empty());
    EXPECT_EQ(again.state.at.step, run.state.at.step);
    return again.report;
}

/// A block on a fixed one that a smooth platen pushes off it: past the edge nothing carries it.
std::string pushed_block(double distance, int steps) {
    return fmt::format(R"(
kluft: 1
analysis: {{gravity: 10}}
materials: {{r: {{density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2}}}}
interfaces: {{j: {{kind: fracture, friction_angle: 30, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}}}}
geometry:
  blocks:
    - {{name: base, polygon: [[0, 0], [3, 0], [3, 1], [0, 1]], support: fixed}}
    - {{name: a, polygon: [[1, 1], [2, 1], [2, 2], [1, 2]]}}
boundaries: {{l: {{block: a, facing: left}}, r: {{block: base, facing: right}}}}
stages:
  - {{}}
  - {{displacement: {{boundary: l, value: {}}}, steps: {}}}
)",
                       distance, steps);
}

TEST(SlowResuming, RunThatEndedAfterUnbalancedLoadStepsEndsTheSame) {
    for (const char* most : {"1", "3", "100"}) { // 100: the stage ends before there are as many
        const SceneRun run = run_scene(pushed_block(3.0, 30), {std::string("solver.max_unbalanced_steps=") + most});
        EXPECT_EQ(run.report.status, std::string(most) == "100" ? RunStatus::unbalanced : RunStatus::no_equilibrium);
        EXPECT_THAT(run.report.diagnosis, HasSubstr("block 'a'"));
        ASSERT_FALSE(run.report.falling.empty());
        EXPECT_EQ(expect_same_end(run).diagnosis, run.report.diagnosis);
    }
}

// The bond fails at a quarter of the load: what comes before that is kept, in load steps of a given size or not.
TEST(Resuming, RunThatEndedWithinALoadStepEndsTheSame) {
    for (const double accuracy : {0.0, 0.01}) {
        const SceneRun run = run_model(posed::two_bonded_blocks(4.0 * posed::tensile_strength, 3), accuracy);
        EXPECT_EQ(run.report.status, RunStatus::no_equilibrium) << accuracy;
        EXPECT_FALSE(run.state.is_settled) << accuracy;
        EXPECT_THAT(run.report.diagnosis, HasSubstr(fmt::format("at load step {}: ", run.history.back().step)));
        EXPECT_EQ(expect_same_end(run).diagnosis, run.report.diagnosis);
    }
}

// tan(phi)/tan(dip) = 1.35 for 25 and 19 degrees.
TEST(Resuming, RunThatEndedAtAFactorOfSafetyEndsTheSame) {
    const StrengthReduction factors{.from = 1.0, .to = 2.0, .tolerance = 1e-3, .interface_types = {}};
    const SceneRun run =
        run_model(posed::block_on_a_plane(19.0 * posed::degree, 25.0 * posed::degree, factors, 4), 0.0);
    EXPECT_EQ(run.report.status, RunStatus::collapsed);
    EXPECT_THAT(expect_same_end(run).diagnosis, HasSubstr("beyond it no equilibrium in stage 1"));
}

// A pile of hexagons that loses half of its stress in one load step; a stage comes after it.
TEST(SlowResuming, RunThatStoppedAfterADropEndsTheSameAndGoesOnWithoutIt) {
    const std::string scene = R"(
kluft: 1
materials: {r: {density: 2500, youngs_modulus: 1 GPa, poissons_ratio: 0.2, cohesion: 0.1 MPa, friction_angle: 30,
                tensile_strength: 0.05 MPa}}
interfaces:
  j: {kind: fracture, friction_angle: 20, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
  p: {kind: potential_crack, fails_to: j, normal_stiffness: 10 GPa/m, shear_stiffness: 5 GPa/m}
geometry: {domain: {rectangle: {width: 1, height: 2}}, tessellation: {hexagons: {spacing: 0.4}, interface: p}}
stages:
  - {strain: {boundary: top, value: 0.1 %}, platens: {friction_angle: 20}, steps: 20, stop_after_drop: 20 %}
  - {strain: {boundary: top, value: 0.01 %}}
solver: {repeatable: true}
)";
    SceneRun run = run_scene(scene);
    ASSERT_EQ(run.report.status, RunStatus::done);
    ASSERT_LT(run.state.at.step, 20);
    EXPECT_EQ(expect_same_end(run).remark, run.report.remark);
    const SceneRun whole = run_scene(scene, {"stages.0.stop_after_drop=null"});
    run.model.loads.stages.front().stop_after_drop.reset();
    const SceneRun rest = resumed(run, run.state);
    EXPECT_EQ(rest.state.at.step, 21);
    EXPECT_EQ(rest.history.back().axial_stress, whole.history.back().axial_stress);
}

// The largest stress was reached before the state was saved.
TEST(Resuming, DropCountsFromALargestStressBeforeTheResume) {
    State peaked;
    peaked.stresses.largest_in_stage = 5e6;
    Stage stage;
    stage.motion = PlatenMotion{.value = 0.01};
    stage.stop_after_drop = 0.2;
    StepRecord row;
    row.axial_stress = 3.9e6;
    note_axial_stress(stage, row, peaked.stresses);
    EXPECT_TRUE(has_dropped(stage, peaked.stresses));
}

// The stages have 1 + 30 load steps.
TEST(SlowEnding, NamesTheLastOfTheUnbalancedLoadSteps) {
    const SceneRun run = run_scene(pushed_block(3.0, 30));
    ASSERT_EQ(run.report.status, RunStatus::no_equilibrium);
    EXPECT_THAT(run.report.diagnosis, HasSubstr(fmt::format("in stage 1 at load step {}: ", run.history.back().step)));
}

} // namespace
} // namespace kluft

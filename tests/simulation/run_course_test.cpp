// The course of a run, with load steps that are made up: what it commits, what it tells and how it ends.
#include "kluft/simulation/run_course.hpp"

#include <new>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

// Two stages of 2 and 3 load steps: a pressure, then a platen.
const char* const two_stages = R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 20 GPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 1e12}}
geometry: {domain: {rectangle: {width: 1.0, height: 2.0}}, reference_spacing: 1.0}
boundaries: {bottom: {support: pinned}}
stages: [{name: pressure, pressure: {top: 2 MPa}, steps: 2}, {name: platen, strain: {boundary: top, value: 1e-4}, steps: 3}]
)";

/// A run whose load steps do nothing, but for the one that is told to.
struct MadeUpRun {
    Model model = build_scene_model(read_scene_text(two_stages)).model;
    State state = initial_state(model);
    SceneRun seen;
    RecordingObserver observer{seen};
    std::atomic<bool> stop{false};
    RunCourse course{model, state, observer, stop};
    LoadSteps steps;
    std::vector<double> load_factors;
    int n_stages_begun = 0;
    int n_stages_ended = 0;

    MadeUpRun() {
        steps.begin_stage = [this] { ++n_stages_begun; };
        steps.initial_record = [] { return StepRecord{}; };
        steps.load_step = [this](double load_factor, bool) {
            load_factors.push_back(load_factor);
            return StepRecord{};
        };
        steps.look_back = [](const StepRecord&) {};
        steps.end_stage = [this] {
            ++n_stages_ended;
            ++course.work.stage;
            course.work.step_in_stage = 0;
        };
        steps.costs = [] { return RunCosts{}; };
        steps.fields = [] { return FieldRecord{}; };
    }

    /// Runs with something else in the load step that begins after `n_before` others.
    template <class Action> RunReport run_with(int n_before, Action action) {
        steps.load_step = [this, n_before, action](double, bool) {
            if (course.work.step == n_before) action();
            return StepRecord{};
        };
        return run_stages(course, steps);
    }
};

TEST(RunCourse, TakesEveryLoadStepOfEveryStageAndReportsTheInitialStateOnce) {
    MadeUpRun run;
    const RunReport report = run_stages(run.course, run.steps);
    EXPECT_EQ(report.status, RunStatus::done);
    EXPECT_THAT(run.load_factors, ElementsAre(1.0 / 2.0, 1.0, 1.0 / 3.0, 2.0 / 3.0, 1.0));
    ASSERT_EQ(run.seen.history.size(), 6U);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(run.seen.history[i].step, i);
    EXPECT_EQ(run.state.step, 5);
    EXPECT_EQ(run.state.stage, 1); // a finished run stays at its last load step
    EXPECT_EQ(run.n_stages_begun, 2);
    EXPECT_EQ(run.n_stages_ended, 2);
}

TEST(RunCourse, GoesOnInTheMiddleOfAStageWithoutAnotherInitialState) {
    MadeUpRun run;
    run.course.work.stage = 1;
    run.course.work.step = 3;
    run.course.work.step_in_stage = 1;
    (void)run_stages(run.course, run.steps);
    EXPECT_THAT(run.load_factors, ElementsAre(2.0 / 3.0, 1.0));
    EXPECT_EQ(run.seen.history.front().step, 4);
}

TEST(RunCourse, LeavesTheStateAtTheLastCommittedLoadStepHoweverItEnds) {
    const auto expect_end = [](RunStatus status, const std::string& diagnosis, auto action) {
        MadeUpRun run;
        const RunReport report = run.run_with(3, [&] {
            run.course.work.unbalanced_ratio = 0.5;
            action();
        });
        EXPECT_EQ(report.status, status) << diagnosis;
        EXPECT_THAT(report.diagnosis, StartsWith(diagnosis));
        EXPECT_EQ(run.state.step, 3) << diagnosis;
        EXPECT_EQ(run.state.unbalanced_ratio, 0.0) << diagnosis;
        EXPECT_EQ(run.seen.history.size(), 4U) << diagnosis;
    };
    expect_end(RunStatus::interrupted, "", [] { throw Interrupted{}; });
    expect_end(RunStatus::out_of_resources, "disk full", [] { throw ResourceError("disk full"); });
    expect_end(RunStatus::out_of_resources, "out of memory", [] { throw std::bad_alloc(); });
    expect_end(RunStatus::no_equilibrium, "no equilibrium in stage 1 at load step 4: reason", [] {
        throw LostEquilibrium{"reason", true};
    }); // by the platen's displacement
}

TEST(RunCourse, IsACollapseOnlyUnderStressAndAfterTheFirstLoadStep) {
    const auto status_after = [](int n_before, bool may_be_collapse) {
        MadeUpRun run;
        return run.run_with(n_before, [&] { throw LostEquilibrium{"", may_be_collapse}; }).status;
    };
    EXPECT_EQ(status_after(1, true), RunStatus::collapsed);
    EXPECT_EQ(status_after(1, false), RunStatus::no_equilibrium);
    EXPECT_EQ(status_after(0, true), RunStatus::no_equilibrium);
}

TEST(RunCourse, CountsUnbalancedLoadStepsAndThoseInSuccession) {
    MadeUpRun run;
    std::vector<int> in_succession;
    run.steps.load_step = [&](double, bool) {
        StepRecord record;
        record.balanced = run.course.work.step == 2;
        return record;
    };
    run.steps.look_back = [&](const StepRecord&) { in_succession.push_back(run.course.work.unbalanced_in_succession); };
    EXPECT_EQ(run_stages(run.course, run.steps).unbalanced_steps, 4);
    EXPECT_THAT(in_succession, ElementsAre(1, 2, 0, 1, 2));
}

} // namespace
} // namespace kluft

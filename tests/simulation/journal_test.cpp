// What a run commits, what it tells and how it ends, with load steps that are made up.
#include "kluft/simulation/journal.hpp"

#include <new>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/posed_run.hpp"

namespace kluft {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

/// Two blocks and a stage of 4 load steps under a pressure.
struct MadeUpRun {
    Model model = posed::two_bonded_blocks(1e5, 4);
    State state = initial_state(model);
    posed::Told told;
    Journal journal{model, state, told, number_of_steps(model)};

    /// A load step to `load_factor` in which one equilibrium was found.
    [[nodiscard]] Step step_to(double load_factor, bool balanced = true) const {
        Step step;
        step.end = state;
        step.end.at.load_factor = load_factor;
        step.row.load_factor = load_factor;
        step.row.balanced = step.balanced = balanced;
        step.equilibria = {step.row};
        return step;
    }
};

TEST(Commit, MovesTheStateAndTellsTheStepAfterwards) {
    MadeUpRun run;
    Step step = run.step_to(0.25);
    step.cracks = {CrackRecord{.step = 1, .pass = 1}};
    step.crack_passes = 1;
    commit(std::move(step), {}, run.state, run.journal);
    EXPECT_EQ(run.state.at.load_factor, 0.25);
    EXPECT_EQ(run.state.at.step, 1);
    EXPECT_EQ(run.state.at.step_in_stage, 1);
    EXPECT_EQ(run.state.costs.events, 1);
    ASSERT_EQ(run.told.rows.size(), 1U);
    EXPECT_EQ(run.told.rows.front().step, 1);
    EXPECT_EQ(run.told.rows.front().crack_passes, 1);
    EXPECT_EQ(run.told.equilibria.size(), 1U);
    EXPECT_EQ(run.told.cracks.size(), 1U);
    EXPECT_EQ(run.told.states.front().at.step, 1);
}

TEST(Commit, StepBetweenTwoStepsOfTheStageDoesNotCountAmongThem) {
    MadeUpRun run;
    commit(run.step_to(0.1), {.regular = false}, run.state, run.journal);
    EXPECT_EQ(run.state.at.step, 1);
    EXPECT_EQ(run.state.at.step_in_stage, 0);
}

TEST(Commit, CountsUnbalancedLoadStepsAndThoseInSuccession) {
    MadeUpRun run;
    std::vector<int> in_succession;
    for (const bool balanced : {false, false, true, false}) {
        commit(run.step_to(0.1, balanced), {}, run.state, run.journal);
        in_succession.push_back(run.state.unbalanced_in_succession);
    }
    EXPECT_THAT(in_succession, ElementsAre(1, 2, 0, 1));
    EXPECT_EQ(run.journal.report().unbalanced_steps, 3);
}

// A full disk or lack of memory while a step is told loses nothing of it: a resumed run goes on after it.
TEST(Commit, StateHasMovedBeforeTheStepIsTold) {
    struct FullDisk : posed::Told {
        void equilibrium(const StepRecord&) override { throw std::bad_alloc(); }
    };
    MadeUpRun run;
    FullDisk full;
    Journal journal(run.model, run.state, full, 1);
    const RunReport report = report_of(journal, [&]() -> RunReport {
        commit(run.step_to(0.25), {}, run.state, journal);
        return {};
    });
    EXPECT_EQ(report.status, RunStatus::out_of_resources);
    EXPECT_EQ(run.state.at.load_factor, 0.25);
    EXPECT_EQ(run.state.at.step, 1);
}

TEST(Commit, WarnsOfALostContactOnceInARun) {
    MadeUpRun run;
    for (int i = 0; i < 3; ++i) {
        Step step = run.step_to(0.1 * i);
        step.lost_contact = "block 1 lies in block 2";
        commit(std::move(step), {}, run.state, run.journal);
    }
    ASSERT_EQ(run.journal.report().warnings.size(), 1U);
    EXPECT_THAT(run.journal.report().warnings.front(), StartsWith("load step 1: a contact was lost"));
}

TEST(BalancedPart, OfAFailedStepIsCommittedWithTheCracksChosenAtIt) {
    MadeUpRun run;
    Step step = run.step_to(0.5);
    step.end.body.interfaces.front() = InterfaceStatus::tension_crack;
    step.cracks = {CrackRecord{.step = 1, .pass = 1}};
    step.crack_passes = 1;
    step.end.stresses.largest_axial = 3e5;
    step.end.control.size = 0.125;
    step.balanced_part = Step::BalancedPart{.body = step.end.body,
                                            .load_factor = 0.5,
                                            .control = step.end.control,
                                            .stresses = step.end.stresses,
                                            .n_equilibria = 1,
                                            .n_cracks = 1};
    // What came after it: an unbalanced equilibrium, more cracks, and then nothing.
    step.end.body.displacement.setConstant(7.0);
    step.end.stresses.largest_axial = 9e5;
    step.end.control.size = 0.0625;
    step.row.balanced = false;
    step.row.unbalanced_ratio = 0.1;
    step.equilibria.push_back(step.row);
    step.cracks.push_back(CrackRecord{.step = 1, .pass = 2});
    step.crack_passes = 2;
    step.balanced = false;
    step.failure = Failure{};
    keep_balanced_part(step);
    const StageEnd end = commit_balanced_part(std::move(step), run.state, run.journal);
    EXPECT_TRUE(end.failure.has_value());
    EXPECT_EQ(end.step, 1);
    EXPECT_EQ(run.state.at.load_factor, 0.5);
    EXPECT_EQ(run.state.body.displacement.norm(), 0.0);
    EXPECT_EQ(run.state.stresses.largest_axial, 3e5);
    EXPECT_EQ(run.state.control.size, 0.125);
    EXPECT_FALSE(run.state.is_settled);
    EXPECT_EQ(run.told.equilibria.size(), 1U);
    EXPECT_EQ(run.told.cracks.size(), 1U);
    ASSERT_EQ(run.told.rows.size(), 1U);
    EXPECT_TRUE(run.told.rows.front().balanced);
    EXPECT_EQ(run.told.rows.front().unbalanced_ratio, 0.0);
    EXPECT_EQ(run.told.rows.front().cracks_tension, 1);
    EXPECT_EQ(run.told.rows.front().crack_passes, 1);
    EXPECT_EQ(run.state.costs.events, 1);
}

TEST(BalancedPart, OfAStepWithoutEquilibriumIsNothing) {
    MadeUpRun run;
    Step step;
    step.end = run.state;
    step.failure = Failure{};
    (void)commit_balanced_part(std::move(step), run.state, run.journal);
    EXPECT_EQ(run.state.at.step, 0);
    EXPECT_TRUE(run.told.rows.empty() && run.told.equilibria.empty());
}

TEST(Ending, IsACollapseOnlyUnderThePlatensStressAndAfterTheFirstLoadStep) {
    MadeUpRun run;
    Stage& stage = run.model.loads.stages.front();
    stage.motion = PlatenMotion{PlatenControl::stress, 2, 1e6};
    const auto status_of = [&](Failure failure, int step, std::optional<double> factor = std::nullopt) {
        State state = run.state;
        state.at.step_in_stage = step - 1; // whole load steps before the one that failed
        return run.journal.ended(state, {failure, step, factor, {}}).status;
    };
    EXPECT_EQ(status_of({}, 2), RunStatus::collapsed);
    EXPECT_EQ(status_of({.nothing_holds = true}, 2), RunStatus::no_equilibrium);
    EXPECT_EQ(status_of({.kind = FailureKind::broken_body, .what = "a block is inside out"}, 2),
              RunStatus::no_equilibrium);
    EXPECT_EQ(status_of({}, 1), RunStatus::no_equilibrium);
    EXPECT_EQ(status_of({}, 1, 1.5), RunStatus::collapsed); // what a strength reduction looks for
    EXPECT_EQ(run.journal.ended(run.state, {}).status, RunStatus::done);
    stage.motion.reset(); // nobody asked for the limit
    EXPECT_EQ(status_of({}, 2), RunStatus::no_equilibrium);
    EXPECT_EQ(status_of({}, 2, 1.5), RunStatus::collapsed);
}

TEST(Ending, InAStepThatIsNotBalancedIsNotDone) {
    MadeUpRun run;
    Step step = run.step_to(0.25, false);
    step.moving = {{0, Vec2(0, -1)}};
    commit(std::move(step), {}, run.state, run.journal);
    const RunReport report = run.journal.ended(run.state, {});
    EXPECT_EQ(report.status, RunStatus::unbalanced);
    EXPECT_THAT(report.diagnosis, StartsWith("stage 0 ends out of balance: block 0 at (0.5, 0.5)"));
    ASSERT_EQ(report.falling.size(), 1U);
    EXPECT_EQ(report.falling.front().direction, Vec2(0, -1));
}

// Each block is in balance, and the mass-like term adds up to too much over the body (27b).
TEST(Ending, OutOfBalanceWithoutABlockThatMovesNamesTheOneWithMostLeft) {
    MadeUpRun run;
    Step step = run.step_to(0.25, false);
    step.worst_block = 0;
    step.worst_share = 0.002;
    commit(std::move(step), {}, run.state, run.journal);
    EXPECT_THAT(
        run.journal.ended(run.state, {}).diagnosis,
        StartsWith("stage 0 ends out of balance: residual 0.002 of the forces, worst is block 0 at (0.5, 0.5)"));
}

TEST(Ending, SaysWhereTheRunEndedAndAtWhichFactorOfSafety) {
    const MadeUpRun run;
    const Failure failure{.residual_ratio = 0.25};
    EXPECT_EQ(run.journal.ended(run.state, {failure, 7, {}, {}}).diagnosis,
              "no equilibrium in stage 0 at load step 7: residual 0.25 of the forces");
    const RunReport report = run.journal.ended(run.state, {failure, 7, 1.5, {}});
    EXPECT_THAT(report.diagnosis, StartsWith("factor of safety 1.5; beyond it no equilibrium in stage 0"));
    EXPECT_EQ(report.results.factor_of_safety, 1.5);
}

TEST(Ending, OfARunThatIsCutShortIsAStatusToo) {
    MadeUpRun run;
    const auto end_of = [&](auto action) {
        return report_of(run.journal, [&]() -> RunReport {
            action();
            return {};
        });
    };
    EXPECT_EQ(end_of([] { throw Interrupted{}; }).status, RunStatus::interrupted);
    const RunReport full = end_of([] { throw ResourceError("disk full"); });
    EXPECT_EQ(full.status, RunStatus::out_of_resources);
    EXPECT_EQ(full.diagnosis, "disk full");
    EXPECT_EQ(end_of([] { throw std::bad_alloc(); }).diagnosis, "out of memory");
}

TEST(Failure, NamesTheBlockWithItsInterfaces) {
    const Model model = posed::two_bonded_blocks(1e5);
    const std::string text =
        description(model, Failure{.worst_block = 1, .residual_ratio = 0.5, .strength_factor = 1.25});
    EXPECT_THAT(text, StartsWith("residual 0.5 of the forces, worst is block "));
    EXPECT_THAT(text, ::testing::EndsWith("; with the strengths divided by 1.25"));
    EXPECT_THAT(text, ::testing::HasSubstr("at (0.5, 1.5), area 1 m2, interfaces 0"));
    EXPECT_THAT(description(model, Failure{.nothing_holds = true}),
                ::testing::HasSubstr("neither a support nor a platen"));
    EXPECT_EQ(description(model, Failure{.what = "the body flows"}), "the body flows");
}

} // namespace
} // namespace kluft

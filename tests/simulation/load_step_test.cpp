// Load steps as values: what they leave alone, what they repeat and where they stop. Bodies of two blocks.
#include "kluft/simulation/load_step.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/simulation/breaking.hpp"
#include "support/posed_run.hpp"

namespace kluft {
namespace {

using posed::same;
using posed::tensile_strength;
using posed::Workplace;
using ::testing::HasSubstr;

TEST(LoadStep, DroppedStepLeavesTheStateBitForBit) {
    Workplace work(posed::two_bonded_blocks(4e6));
    const State before = work.state;
    const Step step = work.take(0.2);
    EXPECT_FALSE(step.failure.has_value());
    EXPECT_FALSE(same(step.end.body, before.body));
    EXPECT_TRUE(same(work.state.body, before.body));
    EXPECT_EQ(work.state.at.load_factor, 0.0);
    EXPECT_EQ(work.state.memory.rate.size(), 0);
    EXPECT_TRUE(work.told.equilibria.empty() && work.told.rows.empty() && work.told.cracks.empty());
}

TEST(LoadStep, SameStepTwiceIsTheSameAnswer) {
    Workplace work(posed::two_bonded_blocks(4e6));
    const Step first = work.take(0.2);
    (void)work.take(1.0); // another one in between, dropped
    const Step second = work.take(0.2);
    EXPECT_TRUE(same(first.end.body, second.end.body));
    EXPECT_EQ(first.row.axial_stress, second.row.axial_stress);
}

TEST(LoadStep, SameStepTwiceWithAReusedFactorIsTheSameWithinTheTolerance) {
    SolverOptions options = Workplace::tight();
    options.repeatable = false;
    Workplace work(posed::two_bonded_blocks(4e6), options);
    const Step first = work.take(0.2);
    const Step second = work.take(0.2);
    const auto& q = first.end.body.displacement;
    EXPECT_LT((second.end.body.displacement - q).norm(), 1e-8 * q.norm());
}

// The bond carries the pull p alone until p reaches its tensile strength; then nothing holds the upper block.
TEST(LoadStep, StepPastTheStrengthStopsAtTheEventAndKeepsWhatStood) {
    Workplace work(posed::two_bonded_blocks(4e6));
    const Step step = work.take(1.0);
    ASSERT_TRUE(step.failure.has_value());
    ASSERT_EQ(step.equilibria.size(), 1U); // the one at the event; none after it
    EXPECT_TRUE(step.equilibria.front().balanced);
    ASSERT_EQ(step.cracks.size(), 1U);
    EXPECT_GE(-step.cracks.front().p3, tensile_strength);
    EXPECT_LE(-step.cracks.front().p3, 1.02 * tensile_strength);
    EXPECT_NEAR(step.equilibria.front().load_factor, tensile_strength / 4e6, 0.02 * tensile_strength / 4e6);
}

// Beyond the strength the upper block moves on, for more solves than are allowed: what it would come to is not known, and
// what stood is kept.
TEST(LoadStep, StepWithoutAnEndStopsAtItsBoundOfSolvesAndKeepsWhatStood) {
    SolverOptions options = Workplace::tight();
    options.max_step_solves = 5;
    Workplace work(posed::two_bonded_blocks(4e6), options);
    const Step step = work.take(1.0);
    ASSERT_TRUE(step.failure.has_value());
    EXPECT_EQ(step.failure->kind, FailureKind::too_many_solves);
    EXPECT_FALSE(step.failure->may_be_collapse());
    EXPECT_THAT(step.failure->what, HasSubstr("solver.max_step_solves"));
    for (const StepRecord& row : step.equilibria) EXPECT_TRUE(row.balanced);
    EXPECT_LE(step.row.load_factor, 1.02 * tensile_strength / 4e6);
}

// Planted in each array that the forces follow from: the first solve tells its place, no equilibrium is kept, and a run ends
// there with what stood before.
TEST(LoadStep, NumberThatIsNoneEndsTheStepInItsFirstSolveWithItsPlace) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::pair<std::string, std::function<void(State&)>>> plants{
        {"the displacement of block 1 at (0.5, 1.5)", [](State& state) { state.body.displacement[7] = none; }},
        {"the traction on interface 0 between block 0 at (0.5, 0.5) and block 1 at (0.5, 1.5)",
         [](State& state) { state.body.bond_shear[1] = none; }},
        {"a force of block 1 at (0.5, 1.5)", [](State& state) { state.stage_start.boundary_pressure[2] = none; }},
    };
    for (const auto& [place, plant] : plants) {
        SCOPED_TRACE(place);
        Workplace work(posed::two_bonded_blocks(4e6, 40));
        work.state = work.take(0.05).end;
        plant(work.state);
        work.enter(); // the loads are counted from the state
        const int solves_before = work.journal.report().costs.open_close_iterations;
        const Step step = work.take(0.1);
        ASSERT_TRUE(step.failure.has_value());
        EXPECT_EQ(step.failure->kind, FailureKind::broken_body);
        EXPECT_THAT(step.failure->what, HasSubstr(place + " is no finite number"));
        EXPECT_TRUE(step.equilibria.empty());
        EXPECT_EQ(work.journal.report().costs.open_close_iterations, solves_before);
    }
}

// A guess only: what it spoils is searched for again from the last equilibrium.
TEST(LoadStep, PredictorThatIsNoNumberLeavesTheAnswerAsItIs) {
    Workplace work(posed::two_bonded_blocks(4e6, 40));
    work.state = work.take(0.05).end;
    work.state.memory.rate = Eigen::VectorXd::Constant(12, std::numeric_limits<double>::quiet_NaN());
    const Step spoilt = work.take(0.1);
    work.state.memory.rate.resize(0);
    const Step step = work.take(0.1);
    ASSERT_FALSE(spoilt.failure.has_value());
    const Eigen::VectorXd& q = step.end.body.displacement;
    EXPECT_LT((spoilt.end.body.displacement - q).norm(), 1e-8 * q.norm());
}

TEST(LoadStep, FailedStepIsCommittedUpToItsLastBalancedEquilibrium) {
    Workplace work(posed::two_bonded_blocks(4e6));
    const StageEnd end = commit_balanced_part(work.take(1.0), work.state, work.journal);
    ASSERT_TRUE(end.failure.has_value());
    EXPECT_EQ(end.step, 1);
    ASSERT_EQ(work.told.rows.size(), 1U);
    const StepRecord& row = work.told.rows.front();
    EXPECT_TRUE(row.balanced);
    EXPECT_EQ(row.load_factor, work.state.at.load_factor);
    EXPECT_NEAR(row.load_factor, 0.25, 0.02 * 0.25);
    EXPECT_EQ(row.cracks_tension, 1);
    EXPECT_EQ(work.told.cracks.size(), 1U);
    EXPECT_EQ(work.state.body.interfaces.front(), InterfaceStatus::tension_crack);
    EXPECT_FALSE(work.state.is_settled);
    EXPECT_EQ(work.state.at.step, 1);
    EXPECT_EQ(work.state.at.step_in_stage, 0); // the load step itself is still to be taken
    // Once more from there: the open joint carries nothing.
    const StageEnd again = commit_balanced_part(work.take(1.0), work.state, work.journal);
    EXPECT_TRUE(again.failure.has_value());
    EXPECT_EQ(work.told.rows.size(), 1U);
}

// What is committed of the first load step of a stage does not move the start of the stage, from which platens travel.
TEST(LoadStep, PartOfTheFirstLoadStepIsNotTheStartOfTheStage) {
    Workplace work(posed::two_bonded_blocks(4e6));
    (void)commit_balanced_part(work.take(1.0), work.state, work.journal);
    ASSERT_GT(work.state.body.displacement.norm(), 0.0);
    work.enter();
    EXPECT_EQ(work.state.stage_start.displacement.norm(), 0.0);
}

// A state that stands before its failed bonds were settled is settled at its own load first; the next event is where it
// would have been.
TEST(LoadStep, FromAnUnsettledStateFindsTheNextEvent) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Workplace work(posed::two_bonded_blocks(4e6, 1, kinematics));
        commit(work.take(0.1), {.regular = false}, work.state, work.journal);
        work.state.is_settled = false;
        const Step step = work.take(1.0);
        ASSERT_TRUE(step.failure.has_value());
        ASSERT_EQ(step.equilibria.size(), 2U);
        EXPECT_EQ(step.equilibria.front().load_factor, 0.1);
        EXPECT_NEAR(step.equilibria.back().load_factor, tensile_strength / 4e6, 0.02 * tensile_strength / 4e6);
        EXPECT_EQ(step.cracks.size(), 1U);
    }
}

// A step without length has no rate to predict the next one from.
TEST(LoadStep, StepToItsOwnLoadFactorLeavesNoPredictor) {
    Workplace work(posed::two_bonded_blocks(1e5));
    commit(work.take(0.5), {}, work.state, work.journal);
    const Step again = work.take(0.5);
    EXPECT_FALSE(again.failure.has_value());
    EXPECT_EQ(again.end.memory.rate.size(), 0);
}

TEST(LoadStep, PullIsTheStressOfBothBlocksWhileTheBondHolds) {
    Workplace work(posed::two_bonded_blocks(0.8 * tensile_strength));
    const Step step = work.take(1.0);
    ASSERT_FALSE(step.failure.has_value());
    EXPECT_TRUE(step.smooth && step.balanced);
    EXPECT_NEAR(step.row.axial_stress, -0.8 * tensile_strength, 1e-6 * tensile_strength);
    EXPECT_EQ(step.row.cracks_tension, 0);
}

// Theory: the failure index belongs to a load. Half the load, half the index, whatever was solved before.
TEST(LoadStep, FailureIndexIsThatOfTheLoadAskedFor) {
    Workplace work(posed::two_bonded_blocks(0.8 * tensile_strength));
    const StepGoal goal = goal_at(work.bench(), 1.0, true);
    StepInProgress p = begin_step(work.bench(), work.state, goal);
    const PlacedState placed = place_for_load_step(p);
    const Equilibrium whole = find_at(p, placed, 1.0, p.displacement());
    const Equilibrium half = find_at(p, placed, 0.5, p.displacement());
    EXPECT_NEAR(largest_failure_index(p, placed.placement, p.loads_at(1.0), whole.displacement), 0.8, 1e-6);
    EXPECT_NEAR(largest_failure_index(p, placed.placement, p.loads_at(0.5), half.displacement), 0.4, 1e-6);
}

TEST(LoadStep, StopsBetweenTwoSolvesWhenAsked) {
    Workplace work(posed::two_bonded_blocks(1e5));
    work.stop = true;
    EXPECT_THROW((void)work.take(1.0), Interrupted);
    EXPECT_EQ(work.state.at.load_factor, 0.0);
}

// Contacts that were kept are those of one body: whatever of it changes that detection looks at, they are detected anew.
TEST(LoadStep, KeptContactsAreOfNoOtherBody) {
    Workplace work(posed::block_on_a_plane(20.0 * posed::degree, 30.0 * posed::degree));
    const StepBench bench = work.bench();
    const StepGoal goal = goal_at(bench, 1.0, false);
    const auto is_detected = [&](StepInProgress& p) {
        const int before = work.journal.report().detections;
        keep_detected(p, detect(p));
        return work.journal.report().detections > before;
    };
    StepInProgress p = begin_step(bench, work.state, goal);
    BodyState& body = p.step.end.body;
    EXPECT_TRUE(is_detected(p));
    EXPECT_FALSE(is_detected(p));
    body.displacement(7) += 1e-15;
    EXPECT_TRUE(is_detected(p));
    body.contacts.push_back({.key = {}, .history = {.shear_trial = 1.0}});
    EXPECT_TRUE(is_detected(p));
    body.contacts.back().history.dilation = 1e-6;
    EXPECT_TRUE(is_detected(p));
    EXPECT_FALSE(is_detected(p));
    body.interfaces.front() = InterfaceStatus::potential_crack;
    EXPECT_TRUE(is_detected(p));
    EXPECT_FALSE(is_detected(p));
}

} // namespace
} // namespace kluft

// The ways to choose load steps, each on two blocks posed in code.
#include "kluft/simulation/fixed_steps.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/simulation/accurate_steps.hpp"
#include "support/posed_run.hpp"

namespace kluft {
namespace {

using posed::tensile_strength;
using posed::Workplace;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

std::vector<double> load_factors(const posed::Told& told) {
    std::vector<double> factors;
    for (const StepRecord& row : told.rows) factors.push_back(row.load_factor);
    return factors;
}

TEST(FixedSteps, AreAsManyAsTheStageSays) {
    Workplace work(posed::two_bonded_blocks(1e5, 4));
    const StageEnd end = run_fixed_steps(work.bench(), work.state);
    EXPECT_FALSE(end.failure.has_value());
    EXPECT_THAT(load_factors(work.told), ElementsAre(0.25, 0.5, 0.75, 1.0));
}

TEST(FixedSteps, GoOnInTheMiddleOfAStage) {
    Workplace work(posed::two_bonded_blocks(1e5, 4));
    commit(work.take(0.25), {}, work.state, work.journal);
    work.told.rows.clear();
    (void)run_fixed_steps(work.bench(), work.state);
    EXPECT_THAT(load_factors(work.told), ElementsAre(0.5, 0.75, 1.0));
}

// The bond fails at a quarter of the load, which no step of a third ends at.
TEST(FixedSteps, EndAtTheLastEquilibriumBeforeTheBodyParts) {
    Workplace work(posed::two_bonded_blocks(4.0 * tensile_strength, 3));
    const StageEnd end = run_fixed_steps(work.bench(), work.state);
    ASSERT_TRUE(end.failure.has_value());
    EXPECT_EQ(end.step, 1);
    EXPECT_THAT(load_factors(work.told), ElementsAre(DoubleNear(0.25, 0.02 * 0.25)));
}

TEST(AccurateSteps, OfALinearBodyGrowToTheWholeStage) {
    SolverOptions options = Workplace::tight();
    options.accuracy = 0.01;
    Workplace work(posed::two_bonded_blocks(0.5 * tensile_strength), options);
    work.state.control.size = 0.1;
    const StageEnd end = run_accurate_steps(work.bench(), work.state);
    EXPECT_FALSE(end.failure.has_value());
    EXPECT_EQ(work.state.at.load_factor, 1.0);
    EXPECT_LT(work.told.rows.size(), 8U); // 0.1, then twice as large each time
    EXPECT_LT(work.state.control.path_error, 0.01);
}

// The event is found to within the accuracy, whatever the size of the first step.
TEST(AccurateSteps, EndWhereTheBondReachesItsStrengthWhateverTheFirstSize) {
    for (const double size : {0.03, 0.2, 1.0}) {
        SolverOptions options = Workplace::tight();
        options.accuracy = 0.01;
        Workplace work(posed::two_bonded_blocks(4.0 * tensile_strength), options);
        work.state.control.size = size;
        const StageEnd end = run_accurate_steps(work.bench(), work.state);
        EXPECT_TRUE(end.failure.has_value());
        EXPECT_NEAR(work.state.at.load_factor, 0.25, 0.01 * 0.25) << size;
        ASSERT_EQ(work.told.cracks.size(), 1U) << size;
        EXPECT_NEAR(-work.told.cracks.front().p3, tensile_strength, 0.01 * tensile_strength) << size;
    }
}

// A stage that failed at its very end is not over: it is settled first.
TEST(AccurateSteps, AreNotDoneWhereBondsHaveFailedAtTheEndOfTheStage) {
    SolverOptions options = Workplace::tight();
    options.accuracy = 0.01;
    Workplace work(posed::two_bonded_blocks(4.0 * tensile_strength), options);
    work.state.at.load_factor = 1.0;
    work.state.is_settled = false;
    work.state.body.interfaces.front() = InterfaceStatus::tension_crack;
    EXPECT_TRUE(run_accurate_steps(work.bench(), work.state).failure.has_value());
}

} // namespace
} // namespace kluft

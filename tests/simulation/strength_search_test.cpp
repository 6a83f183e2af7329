#include "kluft/simulation/strength_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/posed_run.hpp"

namespace kluft {
namespace {

using posed::degree;
using posed::Workplace;

/// A block of friction angle 30 degrees on a plane of 20 degrees at the start of its reduction.
Workplace at_the_reduction(const StrengthReduction& reduction, int steps) {
    return Workplace(posed::block_on_a_plane(20.0 * degree, 30.0 * degree, reduction, steps));
}

void bring_up_the_weight(Workplace& work) {
    Step weight = work.take(1.0);
    ASSERT_FALSE(weight.failure.has_value());
    const Step kept = weight;
    commit(std::move(weight), {.last_of_stage = true}, work.state, work.journal);
    work.leave(kept);
}

// F = tan(phi)/tan(dip). From 1.2 to 2 in four steps the fifth-largest tried is known: the steps to 1.4 stand, that to 1.6
// fails; each halving of (1.4, 1.6) is one trial until the interval is F times the tolerance.
TEST(StrengthSearch, BlockOnAPlaneHasItsFactorOfSafetyAfterAKnownNumberOfTrials) {
    const StrengthReduction reduction{.from = 1.2, .to = 2.0, .tolerance = 1e-3, .interface_types = {}};
    Workplace work = at_the_reduction(reduction, 4);
    bring_up_the_weight(work);
    const std::size_t rows_before = work.told.rows.size();
    const StageEnd end = find_strength_limit(work.bench(), work.state);
    const double factor = std::tan(30.0 * degree) / std::tan(20.0 * degree);
    ASSERT_TRUE(end.factor_of_safety.has_value());
    EXPECT_LE(*end.factor_of_safety, factor * (1.0 + 1e-6));
    EXPECT_GE(*end.factor_of_safety, factor * (1.0 - 1e-3));
    EXPECT_TRUE(end.failure.has_value());

    double low = 1.4, high = 1.6;
    std::size_t kept = 1; // of the regular steps
    while (high - low > 1e-3 * low) {
        const double middle = 0.5 * (low + high);
        if (middle <= factor) {
            low = middle;
            ++kept;
        } else {
            high = middle;
        }
    }
    EXPECT_EQ(work.told.rows.size() - rows_before, kept); // trials that failed left no row
    EXPECT_EQ(work.state.at.step_in_stage, 1);
    EXPECT_NEAR(*end.factor_of_safety, low, 1e-12);
}

TEST(StrengthSearch, SaysThatTheFactorIsAboveTheLargestTried) {
    const StrengthReduction reduction{.from = 1.0, .to = 1.4, .tolerance = 1e-3, .interface_types = {}};
    Workplace work = at_the_reduction(reduction, 2);
    bring_up_the_weight(work);
    const StageEnd end = find_strength_limit(work.bench(), work.state);
    EXPECT_FALSE(end.failure.has_value());
    EXPECT_FALSE(end.factor_of_safety.has_value());
    ASSERT_EQ(work.journal.report().warnings.size(), 1U);
    EXPECT_NE(work.journal.report().warnings.front().find("above 1.4"), std::string::npos);
    EXPECT_EQ(work.state.at.load_factor, 1.0);
}

// F = 1.586 is what the plane carries. At 1.6 the block slides with 0.9 % of its shear: with a balance of a tenth the stage
// of the weight lets that pass, and the reduction looks closer.
TEST(StrengthSearch, FailsWhereTheStateBeforeItDoesNotStand) {
    const StrengthReduction reduction{.from = 1.6, .to = 2.0, .tolerance = 1e-3, .interface_types = {}};
    SolverOptions loose;
    loose.balance = 0.1;
    Workplace work(posed::block_on_a_plane(20.0 * degree, 30.0 * degree, reduction, 2), loose);
    bring_up_the_weight(work);
    const StageEnd end = find_strength_limit(work.bench(), work.state);
    EXPECT_TRUE(end.failure.has_value());
    EXPECT_FALSE(end.factor_of_safety.has_value());
    EXPECT_EQ(work.state.at.step_in_stage, 0);
}

TEST(StrengthSearch, AsksForAResidualWellBelowTheToleranceOfTheFactor) {
    StrengthReduction reduction;
    reduction.tolerance = 1e-4;
    SolverOptions solver;
    EXPECT_DOUBLE_EQ(reduction_tolerance(reduction, solver), 1e-6);
    solver.tolerance = 1e-8;
    EXPECT_DOUBLE_EQ(reduction_tolerance(reduction, solver), 1e-8);
}

} // namespace
} // namespace kluft

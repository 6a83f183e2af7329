#include "kluft/output/kept_states.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::ElementsAre;

StepRecord state_row(int step, double axial_stress, int cracks = 0, int stage = 1) {
    StepRecord record;
    record.step = step;
    record.stage = stage;
    record.axial_stress = axial_stress;
    record.cracks_shear = cracks;
    record.balanced = true;
    return record;
}

/// Rows whose stress rises and in each of which a crack fails, from a first one on.
std::vector<StepRecord> breaking(int n) {
    std::vector<StepRecord> rows{state_row(0, 0.0)};
    for (int step = 1; step <= n; ++step) rows.push_back(state_row(step, step, step));
    return rows;
}

std::vector<int> kept(KeptStates& states, const std::vector<StepRecord>& rows) {
    std::vector<int> steps;
    for (const StepRecord& each : rows) states.add(each);
    for (const StepRecord& each : rows)
        if (states.keeps(each.step)) steps.push_back(each.step);
    return steps;
}

TEST(KeptStates, AreTheFirstTheEndsOfStagesAndEveryNth) {
    KeptStates states({.every = 4});
    EXPECT_THAT(kept(states, {state_row(0, 0.0, 0, 0), state_row(1, 0.0, 0, 0), state_row(2, 0.0, 0, 0),
                              state_row(3, 0.0), state_row(4, 0.0), state_row(5, 0.0)}),
                ElementsAre(0, 2, 4));
    states.end_stage();
    EXPECT_TRUE(states.keeps(5));
}

/// Of a specimen that is pulled.
StepRecord pulled(int step, double stress) {
    StepRecord row = state_row(step, stress);
    row.axial_strain = -1e-4 * step;
    return row;
}

// Pulled under a lateral pressure the axial stress begins in compression: what counts is the sense of the platen.
TEST(KeptStates, LargestStressIsThatOfThePlatensStageInItsSenseAndBalanced) {
    KeptStates states({.platen_stage = 1});
    StepRecord unbalanced = pulled(4, -9.0);
    unbalanced.balanced = false;
    EXPECT_THAT(kept(states, {state_row(0, 8.0, 0, 0), state_row(1, 8.0, 0, 0), pulled(2, 7.0), pulled(3, -5.0),
                              unbalanced, pulled(5, -4.0)}),
                ElementsAre(0, 1, 3));
    EXPECT_EQ(states.for_its_stress(), 3);
    EXPECT_EQ(KeptStates({}).for_its_stress(), std::nullopt);
}

// A net 70 % of whose bonds have failed may have locked: what it carries then is no strength of the rock.
TEST(KeptStates, LargestStressIsNotOneOfABrokenNet) {
    KeptStates states({.platen_stage = 1});
    StepRecord locked = state_row(3, 7.0);
    locked.net_broken = 0.7;
    EXPECT_THAT(kept(states, {state_row(0, 0.0), state_row(1, 5.0), state_row(2, 4.0), locked}), ElementsAre(0, 1));
    EXPECT_EQ(step_of_peak({state_row(0, 0.0), state_row(1, 5.0), state_row(2, 4.0), locked}, 1), 1);
}

TEST(KeptStates, OfCracksAreEverySecondFourthWhereTheyAreMany) {
    for (const auto& [n, expected] : {std::pair{4, std::vector{0, 1, 2, 3, 4}}, std::pair{5, std::vector{0, 1, 3, 5}},
                                      std::pair{9, std::vector{0, 1, 5, 9}}, std::pair{17, std::vector{0, 1, 9, 17}}}) {
        KeptStates states({.at_cracks = 4});
        EXPECT_EQ(kept(states, breaking(n)), expected) << n;
    }
    KeptStates none({});
    EXPECT_THAT(kept(none, breaking(20)), ElementsAre(0));
}

// A run that goes on from a saved state is told the rows before it.
TEST(KeptStates, AreAFunctionOfTheRows) {
    KeptStates whole({.at_cracks = 3, .platen_stage = 1});
    const auto rows = breaking(50);
    for (std::size_t n = 1; n <= rows.size(); ++n) {
        whole.add(rows[n - 1]);
        KeptStates again({.at_cracks = 3, .platen_stage = 1});
        for (std::size_t i = 0; i < n; ++i) again.add(rows[i]);
        for (const StepRecord& each : rows) EXPECT_EQ(whole.keeps(each.step), again.keeps(each.step));
    }
}

} // namespace
} // namespace kluft

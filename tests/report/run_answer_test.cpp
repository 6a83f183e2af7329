#include "kluft/report/run_answer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// A test under a platen whose stress fell after 16 MPa.
RunFacts pressed() {
    RunFacts facts;
    facts.summary.emplace();
    facts.platen_stage = 1;
    facts.numbers.peak_stress = 16e6;
    facts.numbers.peak_strain = 0.0033;
    facts.numbers.peak_reached = true;
    facts.numbers.steps = 52;
    facts.peak.emplace();
    facts.peak->lateral_stress = 1e6;
    return facts;
}

RunFacts reduced() {
    RunFacts facts;
    facts.summary.emplace();
    facts.reduces_strength = true;
    facts.stood = 1.75;
    return facts;
}

TEST(RunAnswer, OfACurveThatFellIsTheStrength) {
    const RunAnswer answer = run_answer(pressed());
    EXPECT_EQ(answer.name, "Strength");
    EXPECT_EQ(answer.value, "16 MPa");
    EXPECT_THAT(answer.sentence, AllOf(HasSubstr("0.33 % axial strain"), HasSubstr("lateral stress of 1 MPa")));
    EXPECT_TRUE(answer.firm);
    EXPECT_THAT(answer.warnings, IsEmpty());
}

TEST(RunAnswer, OfATestThatPullsIsTheTensileStrengthAndPositive) {
    RunFacts facts = pressed();
    facts.sense = -1.0;
    facts.numbers.peak_stress = -250e3;
    facts.numbers.peak_strain = -0.0001;
    facts.peak->lateral_stress = 0.0;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.name, "Tensile strength");
    EXPECT_EQ(answer.value, "0.25 MPa");
    EXPECT_THAT(answer.sentence, HasSubstr("at 0.01 % axial strain;"));
}

TEST(RunAnswer, OfAReductionOfSomeStrengthsNamesThem) {
    RunFacts facts = reduced();
    facts.reduced_alone = {"seam", "joint"};
    EXPECT_EQ(run_answer(facts).name, "Factor of safety of seam, joint alone");
    EXPECT_THAT(run_answer(facts).sentence, AllOf(HasSubstr("with these strengths divided"), HasSubstr("keep theirs")));
    facts.summary->results.factor_of_safety = 1.5;
    EXPECT_EQ(run_answer(facts).value, "1.5");
    EXPECT_THAT(run_answer(facts).sentence, HasSubstr("All other interfaces keep theirs."));
    EXPECT_TRUE(run_answer(facts).firm);
    facts.summary->results.undoubted_factor = 1.25;
    EXPECT_FALSE(run_answer(facts).firm);
    EXPECT_THAT(run_answer(facts).sentence, HasSubstr("in doubt above 1.25"));
}

TEST(RunAnswer, HasTheEstimatedErrorAsItsBand) {
    RunFacts facts = pressed();
    facts.summary->results.estimated_error = 0.02;
    EXPECT_EQ(run_answer(facts).value, "16 MPa \u00b1 0.32 MPa");
}

TEST(RunAnswer, OfACurveThatStillRisesIsABound) {
    RunFacts facts = pressed();
    facts.numbers.peak_reached = false;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "at least 16 MPa");
    EXPECT_FALSE(answer.firm);
    EXPECT_THAT(answer.warnings, Contains(StartsWith("No peak yet")));
}

TEST(RunAnswer, OfACurveThatHasLevelledOffIsAStrength) {
    RunFacts facts = pressed();
    facts.numbers.peak_reached = false;
    facts.numbers.levelled_off = true;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "16 MPa");
    EXPECT_TRUE(answer.firm);
    EXPECT_THAT(answer.sentence, HasSubstr("gives way at this stress"));
    EXPECT_THAT(answer.warnings, Not(Contains(StartsWith("No peak yet"))));
}

TEST(RunAnswer, OfATestWhoseSidesWereUnloadedIsABound) {
    RunFacts facts = pressed();
    facts.numbers.sides_unloaded = true;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "at least 16 MPa");
    EXPECT_FALSE(answer.firm);
    EXPECT_THAT(answer.sentence, HasSubstr("under another lateral stress"));
}

TEST(RunAnswer, OfALockedNetIsNoStrengthOfTheRock) {
    RunFacts facts = pressed();
    facts.numbers.peak_reached = false;
    facts.numbers.net_locked = true;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "16 MPa before the net locked");
    EXPECT_FALSE(answer.firm);
    EXPECT_THAT(answer.warnings, Contains(StartsWith("The net locked")));
    EXPECT_THAT(answer.warnings, Not(Contains(StartsWith("No peak yet"))));
}

TEST(RunAnswer, OfAPlatenLoadedByStressIsTheLoadAboveWhichThereIsNoEquilibrium) {
    RunFacts facts = pressed();
    facts.numbers.peak_reached = false;
    facts.summary->status = RunStatus::collapsed;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "16 MPa");
    EXPECT_TRUE(answer.firm);
    EXPECT_THAT(answer.warnings, IsEmpty());
}

TEST(RunAnswer, NamesWhatLiesAgainstIt) {
    RunFacts facts = pressed();
    facts.numbers.jumps_to_peak = 2;
    facts.numbers.unbalanced_steps = 1;
    facts.n_merged = 3;
    facts.summary->warnings = {"stiffness of 'joint': larger than steel's"};
    const auto warnings = run_answer(facts).warnings;
    ASSERT_EQ(warnings.size(), 4U);
    EXPECT_THAT(warnings[0], StartsWith("2 jumps before the peak"));
    EXPECT_THAT(warnings[1], StartsWith("1 load step is not balanced"));
    EXPECT_THAT(warnings[2], StartsWith("3 slivers were merged"));
    EXPECT_EQ(warnings[3], facts.summary->warnings.front());
}

TEST(RunAnswer, OfAReductionIsTheFactorOfSafety) {
    RunFacts facts = reduced();
    facts.summary->results.factor_of_safety = 1.234567;
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.name, "Factor of safety");
    EXPECT_EQ(answer.value, "1.235");
    EXPECT_TRUE(answer.firm);
}

TEST(RunAnswer, OfAReductionThatFoundNoLimitIsTheLargestFactorThatStood) {
    RunFacts facts = reduced();
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "at least 1.75");
    EXPECT_FALSE(answer.firm);
    facts.stood.reset();
    EXPECT_EQ(run_answer(facts).value, "not found");
}

TEST(RunAnswer, WithoutAPlatenIsWhetherTheBodyStands) {
    RunFacts facts;
    facts.summary.emplace();
    facts.numbers.steps = 4;
    EXPECT_EQ(run_answer(facts).value, "found");
    EXPECT_TRUE(run_answer(facts).firm);
    facts.summary->status = RunStatus::no_equilibrium;
    facts.summary->message = "no equilibrium in stage 0 at load step 2";
    facts.summary->falling = {{"7", 0, 0.5, Vec2(0.0, -1.0), 0}};
    const RunAnswer answer = run_answer(facts);
    EXPECT_EQ(answer.value, "not found");
    EXPECT_FALSE(answer.firm);
    EXPECT_THAT(answer.warnings, Contains(HasSubstr("no equilibrium in stage 0 at load step 2")));
    EXPECT_THAT(answer.warnings,
                Contains(HasSubstr("Block 7 moves where the run has ended (stage 0, load factor 0.5)")));
}

TEST(RunAnswer, NamesManyBlocksThatMoveInOneLine) {
    RunFacts facts;
    facts.summary.emplace();
    facts.summary->status = RunStatus::no_equilibrium;
    for (int b = 0; b < 12; ++b) facts.summary->falling.push_back({std::to_string(b), 1, 0.25, Vec2(0.0, -1.0), 0});
    EXPECT_THAT(run_answer(facts).warnings,
                Contains("Blocks 0, 1, 2, 3, 4 and 7 more move where the run has ended (stage 1, load factor 0.25)."));
    facts.summary->falling.resize(2);
    for (FallingBlock& each : facts.summary->falling) each.share_of_body = 0.002;
    EXPECT_THAT(run_answer(facts).warnings, Contains(HasSubstr("Blocks 0 and 1, 0.4 % of the body, move where")));
}

TEST(RunAnswer, OfARunThatWasKilledOrStoppedSaysSo) {
    RunFacts facts = pressed();
    facts.summary->status = RunStatus::interrupted;
    EXPECT_THAT(run_answer(facts).warnings, Contains(HasSubstr("kluft run --resume")));
    facts.summary->motion = MotionReport{}; // of an explicit run, which does not go on
    EXPECT_THAT(run_answer(facts).warnings, Not(Contains(HasSubstr("--resume"))));
    EXPECT_THAT(run_answer(facts).warnings, Contains(HasSubstr("was stopped before its end")));
    facts.summary->status = RunStatus::out_of_resources;
    facts.summary->message = "disk full";
    EXPECT_THAT(run_answer(facts).warnings, Contains(HasSubstr("disk full")));
    facts.summary.reset();
    EXPECT_THAT(run_answer(facts).warnings, Contains(HasSubstr("has not ended")));
}

} // namespace
} // namespace kluft

#include "kluft/output/progress_line.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

/// A progress line with a clock that the test turns.
struct Shown {
    double now = 0.0;
    std::vector<std::string> writes;
    ProgressLine line;

    explicit Shown(bool terminal, int columns = 0)
        : line([this](std::string_view text) { writes.emplace_back(text); }, terminal, columns,
               [this] { return now; }) {}
};

Progress at_step(int step, int n_steps = 200) {
    Progress progress;
    progress.stage = 1;
    progress.n_stages = 2;
    progress.step = step;
    progress.n_steps = n_steps;
    progress.axial_strain = 0.0057;
    progress.axial_stress = 1.2134e6;
    progress.cracks = 43;
    progress.open_close_iterations = 412;
    return progress;
}

TEST(ProgressLine, SaysStageStepStrainStressCracksIterationsAndTimeLeft) {
    EXPECT_EQ(progress_text(at_step(57), 200.0), "stage 1  step 57/200 (28 %, 3 min 20 s left)  strain 0.570 %  "
                                                 "axial 1.213 MPa  cracks 43  iterations 412");
    EXPECT_THAT(progress_text(at_step(57), std::nullopt), EndsWith("iterations 412"));
}

TEST(ProgressLine, SaysTheStrengthFactorWhereStrengthsAreReduced) {
    Progress progress = at_step(57);
    progress.strength_factor = 1.25;
    EXPECT_EQ(progress_text(progress, std::nullopt),
              "stage 1  step 57/200 (28 %)  strengths divided by 1.2500  cracks 43  iterations 412");
}

TEST(ProgressLine, TellsTimesAsPeopleReadThem) {
    EXPECT_EQ(readable_time(7.6), "8 s");
    EXPECT_EQ(readable_time(200.0), "3 min 20 s");
    EXPECT_EQ(readable_time(7500.0), "2 h 05 min");
    EXPECT_EQ(readable_time(-1.0), "0 s");
    EXPECT_EQ(readable_time(1e9), "32 years");
}

TEST(ProgressLine, IsAPlainLineEveryFivePercentWhereThereIsNoTerminal) {
    Shown shown(false);
    for (int step = 0; step <= 200; ++step) shown.line.update(at_step(step));
    EXPECT_EQ(shown.writes.size(), 21U);
    for (const auto& text : shown.writes) {
        EXPECT_THAT(text, EndsWith("\n"));
        EXPECT_THAT(text, ::testing::Not(HasSubstr("\033")));
    }
    shown.line.clear();
    EXPECT_EQ(shown.writes.size(), 21U);
}

TEST(ProgressLine, IsAPlainLineEveryTenSecondsOfALongStep) {
    Shown shown(false);
    for (int second = 0; second <= 60; ++second) {
        shown.now = second;
        shown.line.update(at_step(3));
    }
    EXPECT_EQ(shown.writes.size(), 7U);
}

TEST(ProgressLine, IsRewrittenOnATerminalAtMostTenTimesASecondAndCutToItsWidth) {
    Shown shown(true, 40);
    for (int i = 0; i < 100; ++i) {
        shown.now = 0.01 * i;
        shown.line.update(at_step(3));
    }
    EXPECT_GE(shown.writes.size(), 9U);
    EXPECT_LE(shown.writes.size(), 11U);
    const std::string cut = progress_text(at_step(3), std::nullopt).substr(0, 39);
    EXPECT_EQ(shown.writes.front(), fmt::format("\r{}\033[K", cut));
    shown.line.clear();
    EXPECT_EQ(shown.writes.back(), "\r\033[K");
}

// 100 steps of 1 s, then steps of 3 s: after 100 more seconds the later half of the time tells 3 s per step.
TEST(ProgressLine, EstimatesTheTimeLeftFromTheLaterHalf) {
    Shown shown(false);
    for (int step = 0; step <= 100; ++step) {
        shown.now = step;
        shown.line.update(at_step(step, 400));
    }
    EXPECT_THAT(shown.writes.back(), HasSubstr("5 min 00 s left"));
    for (int step = 101; step <= 140; ++step) {
        shown.now = 100.0 + 3.0 * (step - 100);
        shown.line.update(at_step(step, 400));
    }
    EXPECT_THAT(shown.writes.back(), HasSubstr("13 min 00 s left")); // 260 steps of 3 s
}

// Two load steps of 1 s, and one of which 2 % are done after 20 s: 980 s and 7 more of 1000 s.
TEST(ProgressLine, EstimatesTheTimeLeftFromALongLoadStepInProgress) {
    Shown shown(false);
    for (int step = 0; step <= 2; ++step) {
        shown.now = step;
        shown.line.update(at_step(step, 10));
    }
    EXPECT_THAT(shown.writes.back(), HasSubstr("8 s left"));
    shown.now = 22.0;
    Progress progress = at_step(2, 10);
    progress.share_of_step = 0.02;
    shown.line.update(progress);
    EXPECT_THAT(shown.writes.back(), HasSubstr("2 h 13 min left"));
}

} // namespace
} // namespace kluft

#include "kluft/output/axis.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kluft {
namespace {

using ::testing::ElementsAre;

TEST(Axis, HasTicksAtRoundNumbersAroundTheValues) {
    const Axis axis = round_axis(0.0, 1.43, 3);
    EXPECT_DOUBLE_EQ(axis.step, 0.5);
    EXPECT_THAT(axis.ticks(), ElementsAre(0.0, 0.5, 1.0, 1.5));
    EXPECT_DOUBLE_EQ(round_axis(0.0, 1.43, 7).step, 0.2);
    EXPECT_DOUBLE_EQ(round_axis(0.0, 1.43, 7).high, 1.6);
    EXPECT_DOUBLE_EQ(round_axis(-30.0, 400.0, 5).low, -100.0);
}

TEST(Axis, LabelsHaveTheDecimalsOfTheStep) {
    EXPECT_EQ(round_axis(0.0, 1.4, 7).label(0.6000000000000001), "0.6");
    EXPECT_EQ(round_axis(0.0, 0.03, 3).label(0.02), "0.02");
    EXPECT_EQ(round_axis(0.0, 3000.0, 3).label(2000.0), "2000");
    EXPECT_EQ(round_axis(-1.0, 1.0, 4).label(-0.5), "\u22120.5");
    EXPECT_EQ(round_axis(-1.0, 1.0, 4).label(-1e-17), "0.0");
}

TEST(Axis, SurvivesRangesWithoutLength) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (const auto& axis : {round_axis(0.0, 0.0, 5), round_axis(2.0, 2.0, 5), round_axis(infinity, -infinity, 5)}) {
        EXPECT_GT(axis.high, axis.low);
        EXPECT_LE(axis.ticks().size(), 12U);
    }
}

TEST(Axis, LogarithmicHasTicksAtPowersOfTenOrAtFewOfThemBetween) {
    const Axis wide = round_log_axis(3e-7, 0.04);
    EXPECT_DOUBLE_EQ(wide.low, 2e-7);
    EXPECT_DOUBLE_EQ(wide.high, 0.05);
    EXPECT_THAT(wide.ticks(), ::testing::SizeIs(5)); // 1e-6 ... 1e-2
    const Axis narrow = round_log_axis(1.2, 15.0);
    EXPECT_THAT(narrow.ticks(), ::testing::Pointwise(::testing::DoubleEq(), {1.0, 2.0, 5.0, 10.0, 20.0}));
    EXPECT_DOUBLE_EQ(narrow.fraction(1.0), 0.0);
    EXPECT_NEAR(narrow.fraction(std::sqrt(20.0)), 0.5, 1e-12);
}

TEST(Axis, LogarithmicLabelsAreShort) {
    const Axis axis = round_log_axis(1e-7, 1e6);
    EXPECT_EQ(axis.label(0.002), "0.002");
    EXPECT_EQ(axis.label(100.0), "100");
    EXPECT_EQ(axis.label(1e-5), "10\u207b\u2075");
    EXPECT_EQ(axis.label(2e-6), "2\u00b710\u207b\u2076");
}

TEST(Axis, LogarithmicSurvivesValuesThatHaveNoLogarithm) {
    for (const auto& axis : {round_log_axis(0.0, 1.0), round_log_axis(-1.0, 2.0), round_log_axis(2.0, 2.0),
                             round_log_axis(std::numeric_limits<double>::infinity(), 1.0)}) {
        EXPECT_GT(axis.low, 0.0);
        EXPECT_GT(axis.high, axis.low);
    }
}

TEST(PlotFrame, PutsTheCornersOfTheAxesOnTheCornersOfTheFrame) {
    const PlotFrame frame{{10.0, 20.0}, {100.0, 50.0}, {0.0, 2.0, 1.0}, {-1.0, 1.0, 1.0}};
    EXPECT_EQ(frame.place({0.0, 1.0}), Vec2(10.0, 20.0));
    EXPECT_EQ(frame.place({2.0, -1.0}), Vec2(110.0, 70.0));
    EXPECT_EQ(frame.place({1.0, 0.0}), Vec2(60.0, 45.0));
}

} // namespace
} // namespace kluft

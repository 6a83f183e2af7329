#include "kluft/core/bracket.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace kluft {
namespace {

/// Narrows a bracket of g to [0, 1] until |g| is small; the number of values of g that it took.
template <class Function> int values_to_root(Function g, double margin, double enough, double& root) {
    Bracket bracket{.low = 0.0, .high = 1.0, .g_low = g(0.0), .g_high = g(1.0)};
    for (int n = 1; n < 200; ++n) {
        root = bracket.propose(margin);
        const double value = g(root);
        if (std::abs(value) < enough) return n;
        bracket.take(root, value);
    }
    return 200;
}

// A contact that closes at 0.7 and makes the body a thousand times stiffer: g = x - 0.71 before, and behind 0.7 the
// line from -0.01 with the slope 1000, which is zero at 0.70001.
double closing_contact(double x) { return x < 0.7 ? x - 0.71 : -0.01 + 1000.0 * (x - 0.7); }

TEST(Bracket, FindsTheRootOfAStraightLineAtOnce) {
    double root = 0.0;
    EXPECT_EQ(values_to_root([](double x) { return 3.0 * x - 0.75; }, 0.0, 1e-12, root), 1);
    EXPECT_DOUBLE_EQ(root, 0.25);
}

TEST(Bracket, FindsTheRootOfAFunctionWithAKink) {
    for (const double margin : {0.0, 0.01, 0.05}) {
        double root = 0.0;
        EXPECT_LT(values_to_root(closing_contact, margin, 1e-10, root), 80) << margin;
        EXPECT_NEAR(root, 0.70001, 1e-12) << margin; // an error of g over the slope
    }
}

// x^9 - 1/512 is flat in front of its root 1/2: with the values as they are, regula falsi keeps the end at 1.
TEST(Bracket, HalvedValuesPullALastingEndIn) {
    const auto power = [](double x) { return std::pow(x, 9) - 1.0 / 512.0; };
    double root = 0.0;
    EXPECT_LT(values_to_root(power, 0.0, 1e-10, root), 40);
    EXPECT_NEAR(root, 0.5, 1e-6);
    double low = 0.0; // without halving: the line through (low, g) and (1, 1 - 1/512)
    for (int n = 0; n < 40; ++n) low = 1.0 - power(1.0) * (1.0 - low) / (power(1.0) - power(low));
    EXPECT_LT(low, 0.4);
}

TEST(Bracket, StaysAMarginAwayFromItsEnds) {
    const Bracket steep{.low = 2.0, .high = 4.0, .g_low = -1.0, .g_high = 999.0}; // the line is zero at 2.002
    EXPECT_DOUBLE_EQ(steep.propose(0.0), 2.002);
    EXPECT_DOUBLE_EQ(steep.propose(0.01), 2.02);
    EXPECT_DOUBLE_EQ(steep.propose(0.05), 2.1);
    const Bracket flat{.low = 2.0, .high = 4.0, .g_low = -999.0, .g_high = 1.0};
    EXPECT_DOUBLE_EQ(flat.propose(0.05), 3.9);
}

// A jump has no root. With a margin m the width is at most 1 - m of the one before, whatever the values are.
TEST(Bracket, ClosesInOnAJump) {
    Bracket bracket{.low = 0.0, .high = 1.0, .g_low = -1e-6, .g_high = 1.0};
    for (int n = 0; n < 100; ++n) {
        const double before = bracket.width();
        const double x = bracket.propose(0.05);
        bracket.take(x, x < 0.3 ? -1e-6 : 1.0);
        EXPECT_LE(bracket.width(), 0.95 * before + 1e-15); // of the ends
    }
    EXPECT_LT(bracket.low, 0.3);
    EXPECT_GE(bracket.high, 0.3);
}

TEST(Bracket, TakesARootAsItsUpperEnd) {
    Bracket bracket{.low = 0.0, .high = 1.0, .g_low = -1.0, .g_high = 3.0};
    bracket.take(0.25, 0.0);
    EXPECT_EQ(bracket.low, 0.0);
    EXPECT_EQ(bracket.high, 0.25);
    EXPECT_EQ(bracket.width(), 0.25);
}

} // namespace
} // namespace kluft

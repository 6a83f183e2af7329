#include "kluft/equilibrium/line_search.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

/// Keeps where a function was evaluated.
template <class Function> auto recorded(Function f, std::vector<double>& at) {
    return [f, &at](double s) {
        at.push_back(s);
        return f(s);
    };
}

// Newton's increment of a linear problem ends where the work is zero.
TEST(LineSearch, TakesTheFullStepOfALinearProblem) {
    std::vector<double> at;
    EXPECT_EQ(step_to_root(-4.0, recorded([](double s) { return 4.0 * (s - 1.0); }, at)), 1.0);
    EXPECT_EQ(at, std::vector<double>{1.0});
}

TEST(LineSearch, TakesTheFullStepWhereTheWorkAtItsEndIsSmallOrNegative) {
    EXPECT_EQ(step_to_root(-10.0, [](double s) { return -10.0 + 12.9 * s; }), 1.0); // 0.29 of |g(0)|
    EXPECT_EQ(step_to_root(-10.0, [](double s) { return -10.0 + 5.0 * s; }), 1.0);  // the body still falls there
    EXPECT_LT(step_to_root(-10.0, [](double s) { return -10.0 + 13.1 * s; }), 1.0); // 0.31
}

// The work of a parabola of energy that is three times as stiff as its tangent: g(s) = 3 s - 1, zero at 1/3.
TEST(LineSearch, FindsTheRootOfALinearSlopeWithOneTrial) {
    std::vector<double> at;
    EXPECT_DOUBLE_EQ(step_to_root(-1.0, recorded([](double s) { return 3.0 * s - 1.0; }, at)), 1.0 / 3.0);
    EXPECT_EQ(at.size(), 2U);
}

// A contact closes at s = 0.4 and is n times as stiff as what closed it: g = s - 1, then -0.6 + n (s - 0.4), zero at
// 0.4 + 0.6/n.
TEST(LineSearch, StopsWhereAContactClosesAndCarries) {
    for (const double n : {3.0, 5.0, 10.0}) {
        std::vector<double> at;
        const auto slope = [n](double s) { return s < 0.4 ? s - 1.0 : -0.6 + n * (s - 0.4); };
        const double s = step_to_root(-1.0, recorded(slope, at));
        EXPECT_NEAR(s, 0.4 + 0.6 / n, 0.1 / n) << n; // |g| < 0.1 |g(0)|
        EXPECT_LE(at.size(), 1U + max_line_search_trials);
        EXPECT_EQ(at.front(), 1.0);
    }
}

TEST(LineSearch, GivesUpAfterItsTrialsWhereTheWorkJumps) {
    std::vector<double> at;
    const double s = step_to_root(-1.0, recorded([](double x) { return x < 0.25 ? -1.0 : 1.0; }, at));
    EXPECT_EQ(at.size(), 1U + max_line_search_trials);
    EXPECT_NEAR(s, 0.25, 0.05);
}

// |s - 0.3| is 0.3 before, 0.7 after the full step and 0.2 after half of it.
TEST(LineSearch, HalvesUntilTheNormFalls) {
    std::vector<double> at;
    const auto norm = recorded([](double s) { return std::abs(s - 0.3); }, at);
    EXPECT_EQ(step_by_halving(0.3, norm), 0.5);
    EXPECT_EQ(at, (std::vector<double>{1.0, 0.5}));
}

TEST(LineSearch, HalvingTakesAFullStepThatLowersTheNorm) {
    EXPECT_EQ(step_by_halving(1.0, [](double s) { return 1.0 - 0.01 * s; }), 1.0);
}

// The norm grows with any step; it grows least with 1/16.
TEST(LineSearch, HalvingReturnsTheSmallestNormWhereNoneFalls) {
    std::vector<double> at;
    const auto norm = [](double s) { return 1.0 + std::abs(std::log2(s) + 4.0); };
    EXPECT_EQ(step_by_halving(1.0, recorded(norm, at)), 1.0 / 16.0);
    EXPECT_EQ(at.size(), static_cast<std::size_t>(max_line_search_trials));
}

} // namespace
} // namespace kluft

#include "kluft/calibration/least_squares.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {
namespace {

/// Rosenbrock's function as residuals 10 (y - x^2), 1 - x: zero at (1, 1) only.
std::optional<ResidualRows> rosenbrock(const Eigen::VectorXd& x) {
    ResidualRows result{Eigen::VectorXd(2), Eigen::MatrixXd(2, 2)};
    result.values << 10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0];
    result.jacobian << -20.0 * x[0], 10.0, -1.0, 0.0;
    return result;
}

Eigen::VectorXd pair(double a, double b) { return Eigen::Vector2d(a, b); }

TEST(LeastSquares, FindsTheZeroOfRosenbrocksFunction) {
    const auto found = minimise_squares(rosenbrock, pair(-1.2, 1.0), pair(-5, -5), pair(5, 5));
    EXPECT_TRUE(found.converged);
    EXPECT_NEAR(found.x[0], 1.0, 1e-8);
    EXPECT_NEAR(found.x[1], 1.0, 1e-8);
}

// With x <= 1/2 the least squares are at the bound: y = 1/4, residual 1/2.
TEST(LeastSquares, StaysWithinTheBounds) {
    const auto found = minimise_squares(rosenbrock, pair(-1.2, 1.0), pair(-5, -5), pair(0.5, 5));
    EXPECT_NEAR(found.x[0], 0.5, 1e-6);
    EXPECT_NEAR(found.x[1], 0.25, 1e-6);
    EXPECT_LE(found.x[0], 0.5);
    EXPECT_NEAR(found.residuals.values.norm(), 0.5, 1e-6);
}

TEST(LeastSquares, WhatHasEqualBoundsDoesNotMove) {
    const auto found = minimise_squares(rosenbrock, pair(0.5, 1.0), pair(0.5, -5), pair(0.5, 5));
    EXPECT_EQ(found.x[0], 0.5);
    EXPECT_NEAR(found.x[1], 0.25, 1e-6);
    EXPECT_EQ(minimise_squares(rosenbrock, pair(2, 3), pair(2, 3), pair(2, 3)).evaluations, 1);
}

// log is not there for x <= 0: the first step from 5 goes to 5 - 5 log 5 < 0 and is made shorter.
TEST(LeastSquares, GoesShorterStepsWhereThereAreNoResiduals) {
    const auto logarithm = [](const Eigen::VectorXd& x) -> std::optional<ResidualRows> {
        if (x[0] <= 0.0) return std::nullopt;
        return ResidualRows{Eigen::VectorXd::Constant(1, std::log(x[0])), Eigen::MatrixXd::Constant(1, 1, 1.0 / x[0])};
    };
    const auto one = [](double value) { return Eigen::VectorXd(Eigen::VectorXd::Constant(1, value)); };
    EXPECT_NEAR(minimise_squares(logarithm, one(5.0), one(-100.0), one(100.0)).x[0], 1.0, 1e-8);
    EXPECT_THROW((void)minimise_squares(logarithm, one(-1.0), one(-100.0), one(100.0)), InputError);
}

} // namespace
} // namespace kluft

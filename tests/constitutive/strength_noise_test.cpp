#include "kluft/constitutive/strength_noise.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

std::vector<double> factors(const StrengthNoise& noise, int count) {
    std::vector<double> result;
    for (int i = 0; i < count; ++i) result.push_back(strength_factor(noise, i));
    return result;
}

TEST(StrengthNoise, IsExactlyOneWithoutDeviation) {
    for (const double factor : factors({.deviation = 0.0, .seed = 3}, 100)) EXPECT_EQ(factor, 1.0);
}

// By the hash with arbitrary integers and another inverse of the normal distribution (Wichura 1988, AS 241).
TEST(StrengthNoise, IsTheLogNormalQuantileOfTheHash) {
    EXPECT_NEAR(strength_factor({.deviation = 0.1, .seed = 1}, 0), 0.9621771627465959, 1e-13);
    EXPECT_NEAR(strength_factor({.deviation = 0.1, .seed = 1}, 1), 1.1402870762885313, 1e-13);
    EXPECT_NEAR(strength_factor({.deviation = 0.1, .seed = 1}, 2), 1.0602380557401658, 1e-13);
    EXPECT_NEAR(strength_factor({.deviation = 0.01, .seed = 5}, 1000), 1.0075192788455525, 1e-13);
}

// Four standard errors: of the mean s/sqrt(n), of the deviation about s/sqrt(2n) (more for the skew), of a share
// sqrt(p(1 - p)/n). P(X < median) = 1/2 and P(|ln X - ln median| < s) = 0.6827.
TEST(StrengthNoise, HasMeanOneAndTheDeviationAskedAndIsLogNormal) {
    constexpr int n = 200000;
    for (const double deviation : {0.01, 0.1, 0.29}) {
        const auto x = factors({.deviation = deviation, .seed = 77}, n);
        double mean = 0.0;
        for (const double f : x) mean += f / n;
        double variance = 0.0;
        for (const double f : x) variance += (f - mean) * (f - mean) / n;
        EXPECT_NEAR(mean, 1.0, 4.0 * deviation / std::sqrt(n));
        EXPECT_NEAR(std::sqrt(variance) / deviation, 1.0, 4.0 * 1.3 / std::sqrt(2.0 * n));
        EXPECT_GT(*std::ranges::min_element(x), 0.0);
        const double s = std::sqrt(std::log(1.0 + deviation * deviation));
        const auto share = [&](double from, double to) {
            const auto count = std::ranges::count_if(x, [&](double f) {
                const double z = (std::log(f) + 0.5 * s * s) / s;
                return z > from && z < to;
            });
            return static_cast<double>(count) / n;
        };
        EXPECT_NEAR(share(-10.0, 0.0), 0.5, 4.0 * 0.5 / std::sqrt(n));
        EXPECT_NEAR(share(-1.0, 1.0), 0.682689492, 4.0 * 0.466 / std::sqrt(n));
        EXPECT_NEAR(share(2.0, 10.0), 0.022750132, 4.0 * 0.149 / std::sqrt(n));
    }
}

// Successive interfaces and successive seeds are uncorrelated, to four standard errors 1/sqrt(n).
TEST(StrengthNoise, IsIndependentBetweenInterfacesAndSeeds) {
    constexpr int n = 100000;
    constexpr double deviation = 0.1;
    const auto x = factors({.deviation = deviation, .seed = 1}, n + 1);
    const auto y = factors({.deviation = deviation, .seed = 2}, n);
    double along = 0.0;
    double across = 0.0;
    for (int i = 0; i < n; ++i) {
        along += (x[i] - 1.0) * (x[i + 1] - 1.0) / (deviation * deviation * n);
        across += (x[i] - 1.0) * (y[i] - 1.0) / (deviation * deviation * n);
    }
    EXPECT_NEAR(along, 0.0, 4.0 / std::sqrt(n));
    EXPECT_NEAR(across, 0.0, 4.0 / std::sqrt(n));
}

TEST(StrengthNoise, ScalesCohesionAndTensileStrengthButNotTheAngle) {
    const Strength strength = scaled({.cohesion = 2e6, .friction_angle = 0.6, .tensile_strength = 1e6}, 1.25);
    EXPECT_EQ(strength.cohesion, 2.5e6);
    EXPECT_EQ(strength.friction_angle, 0.6);
    EXPECT_EQ(strength.tensile_strength, 1.25e6);
}

} // namespace
} // namespace kluft

#include "kluft/studies/ensemble.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace kluft {
namespace {

// Table of Student's t, two-sided 95 % (and 99 %), as printed in any textbook.
TEST(Ensemble, StudentQuantilesAreThoseOfTheTables) {
    EXPECT_NEAR(student_quantile(1, 0.95), 12.706, 5e-4);
    EXPECT_NEAR(student_quantile(2, 0.95), 4.303, 5e-4);
    EXPECT_NEAR(student_quantile(4, 0.95), 2.776, 5e-4);
    EXPECT_NEAR(student_quantile(9, 0.95), 2.262, 5e-4);
    EXPECT_NEAR(student_quantile(30, 0.95), 2.042, 5e-4);
    EXPECT_NEAR(student_quantile(1000000, 0.95), 1.960, 5e-4);
    EXPECT_NEAR(student_quantile(9, 0.99), 3.250, 5e-4);
}

// 2, 4, 4, 4, 5, 5, 7, 9: mean 5, sum of squares 32, s = sqrt(32/7); t(7) = 2.365.
TEST(Ensemble, MeanDeviationAndConfidenceFollowTheirFormulas) {
    const auto found = ensemble_statistics({2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0});
    EXPECT_EQ(found.n, 8);
    EXPECT_DOUBLE_EQ(found.mean, 5.0);
    EXPECT_DOUBLE_EQ(found.deviation, std::sqrt(32.0 / 7.0));
    ASSERT_TRUE(found.half_width);
    EXPECT_NEAR(*found.half_width, 2.365 * std::sqrt(32.0 / 7.0) / std::sqrt(8.0), 1e-3);
}

TEST(Ensemble, OneMemberHasNoConfidenceAndNoneHasNoMean) {
    EXPECT_FALSE(ensemble_statistics({3.0}).half_width);
    EXPECT_DOUBLE_EQ(ensemble_statistics({3.0}).mean, 3.0);
    EXPECT_EQ(ensemble_statistics({}).n, 0);
}

// Peaks of the triaxial model: 0.78 % by 1 % noise on strengths (5 members), 1.5 % by offsets of the mesh (12).
// By hand with t(n - 1): 2.776 * 0.78/sqrt(5) = 0.968 but 3.182 * 0.78/2 = 1.241; 2.201 * 1.5/sqrt(12) = 0.953 but
// 2.228 * 1.5/sqrt(11) = 1.008.
TEST(Ensemble, MembersForOnePercentAreThoseFoundByHand) {
    EXPECT_EQ(members_needed(0.0078, 0.01), 5);
    EXPECT_EQ(members_needed(0.015, 0.01), 12);
    EXPECT_EQ(members_needed(0.0, 0.01), 2);
    EXPECT_NEAR(members_needed(1.0, 0.01), 38417, 2); // (1.96/0.01)^2 = 38415, and t is a little larger than 1.96
}

TEST(Ensemble, MembersNeededIsTheFirstNumberThatIsEnough) {
    for (const double deviation : {0.004, 0.01, 0.02, 0.05, 0.2}) {
        const int n = members_needed(deviation, 0.01);
        const auto width = [&](int m) { return student_quantile(m - 1, 0.95) * deviation / std::sqrt(m); };
        EXPECT_LE(width(n), 0.01);
        EXPECT_TRUE(n == 2 || width(n - 1) > 0.01) << n;
    }
}

// y = x and y = 3x on different places: mean 2x, deviation sqrt(2) x.
TEST(Ensemble, BandOfTwoLinesIsTheirMeanAndHalfDistanceTimesRootTwo) {
    const CurveBand band = curve_band({{{0.0, 0.0}, {2.0, 2.0}}, {{0.0, 0.0}, {0.7, 2.1}, {1.5, 4.5}}}, 4);
    ASSERT_EQ(band.x.size(), 4U);
    EXPECT_DOUBLE_EQ(band.x.back(), 1.5); // where the first curve ends
    for (std::size_t i = 0; i < band.x.size(); ++i) {
        EXPECT_NEAR(band.mean[i], 2.0 * band.x[i], 1e-12);
        EXPECT_NEAR(band.deviation[i], std::sqrt(2.0) * band.x[i], 1e-12);
    }
}

TEST(Ensemble, NoBandOfOneCurveOrWithoutACommonRange) {
    EXPECT_TRUE(curve_band({{{0.0, 0.0}, {1.0, 1.0}}}, 5).x.empty());
    EXPECT_TRUE(curve_band({{{0.0, 0.0}, {1.0, 1.0}}, {{2.0, 0.0}, {3.0, 1.0}}}, 5).x.empty());
    EXPECT_TRUE(curve_band({{{0.0, 0.0}, {1.0, 1.0}}, {}}, 5).x.empty());
}

} // namespace
} // namespace kluft

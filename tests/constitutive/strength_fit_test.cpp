#include "kluft/constitutive/strength_fit.hpp"

#include <array>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double MPa = 1e6;

PeakPoint strength_at(double sigma_3, double sigma_1) { return {.run = "t", .sigma_3 = sigma_3, .sigma_1 = sigma_1}; }

std::vector<PeakPoint> on_line(const Envelope& line, const std::vector<double>& lateral) {
    std::vector<PeakPoint> points;
    for (const double sigma_3 : lateral) points.push_back(strength_at(sigma_3, line.sigma_1(sigma_3)));
    return points;
}

std::string message_of(const std::vector<PeakPoint>& points) {
    try {
        (void)fit_envelope(points);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// ---- Mohr-Coulomb --------------------------------------------------------------------------------------------------

// c = 0.16 MPa, phi = 36.2 deg: uniaxial strength 2 c cos/(1 - sin) = 0.6308 MPa.
TEST(Envelope, GivesTheUniaxialStrengthOfTheTests) {
    const Envelope tests{0.16e6, 36.2 * degree};
    EXPECT_NEAR(tests.sigma_1(0.0), 0.6308e6, 50.0);
    EXPECT_NEAR(tests.sigma_1(0.2e6), 1.4078e6, 50.0);
}

TEST(Envelope, FindsCohesionAndFrictionAngleOfPointsOnALine) {
    for (const Envelope& exact :
         {Envelope{0.16e6, 36.2 * degree}, Envelope{0.118e6, 39.6 * degree}, Envelope{0.0, 0.0}}) {
        const Envelope fit = fit_envelope(on_line(exact, {0.0, 0.2e6, 0.55e6, 1.0e6}));
        EXPECT_NEAR(fit.cohesion, exact.cohesion, 1e-6);
        EXPECT_NEAR(fit.friction_angle, exact.friction_angle, 1e-12);
        EXPECT_NEAR(fit.residuals.rms, 0.0, 1e-6);
        EXPECT_NEAR(fit.residuals.r_squared, 1.0, 1e-12);
        ASSERT_TRUE(fit.cohesion_error());
        EXPECT_NEAR(*fit.cohesion_error(), 0.0, 1e-6);
    }
}

// "Evaluation of failure behavior and strength of fractured rock sample using in-situ triaxial compression tests and
// expanded distinct element method": the peaks of its cases 5, 3, 4, 6 and its c = 0.118 MPa, phi = 39.6 deg.
TEST(Envelope, OfThePublishedPeaksIsThePublishedOne) {
    const Envelope fit = fit_envelope({strength_at(0.0, 0.502 * MPa), strength_at(0.2 * MPa, 1.405 * MPa),
                                       strength_at(0.55 * MPa, 2.985 * MPa), strength_at(1.0 * MPa, 5.018 * MPa)});
    EXPECT_NEAR(fit.cohesion, 0.118 * MPa, 0.0005 * MPa);
    EXPECT_NEAR(fit.friction_angle, 39.6 * degree, 0.05 * degree);
}

// Least squares by hand: sigma_1 on sigma_3 of (0, 1), (1, 5), (2, 6) MPa is b + q sigma_3 with q = 2.5, b = 1.5;
// residuals -0.5, 1, -0.5, so s^2 = 1.5/1, var q = s^2/2 = 0.75, var b = s^2 (1/3 + 1/2) = 1.25, cov = -s^2/2 = -0.75.
// dc/db = 1/(2 sqrt q) = 0.316228, dc/dq = -b/(4 q^1.5) = -0.0948683:
// var c = 0.1 * 1.25 + 0.009 * 0.75 + 2 * 0.316228 * 0.0948683 * 0.75 = 0.17675;
// dphi/dq = 1/((q + 1) sqrt q) = 0.180702, times sqrt 0.75: 0.156492. R^2 = 1 - 1.5/14.
TEST(Envelope, HasTheStandardErrorsOfARegressionByHand) {
    const Envelope fit =
        fit_envelope({strength_at(0.0, 1 * MPa), strength_at(1 * MPa, 5 * MPa), strength_at(2 * MPa, 6 * MPa)});
    EXPECT_NEAR(fit.sigma_1(0.0), 1.5 * MPa, 1e-6);
    EXPECT_NEAR(fit.sigma_1(1 * MPa), 4.0 * MPa, 1e-6);
    ASSERT_TRUE(fit.cohesion_error());
    EXPECT_NEAR(*fit.cohesion_error(), std::sqrt(0.17675) * MPa, 1e-6 * MPa);
    EXPECT_NEAR(*fit.friction_angle_error(), std::sqrt(0.75) / (3.5 * std::sqrt(2.5)), 1e-12);
    EXPECT_NEAR(fit.residuals.r_squared, 1.0 - 1.5 / 14.0, 1e-12);
    EXPECT_NEAR(fit.residuals.rms, std::sqrt(0.5) * MPa, 1e-6);
    EXPECT_EQ(fit.residuals.n_points, 3U);
    // Student's t of one degree of freedom at 97.5 %: tan(0.475 pi) = 12.706; at sigma = 0 the strength is c.
    ASSERT_TRUE(fit.confidence(0.0));
    EXPECT_NEAR(*fit.confidence(0.0), std::tan(0.475 * std::numbers::pi) * std::sqrt(0.17675) * MPa, 1e-3);
}

/// Tests of a rock of c = 0.16 MPa, phi = 36.2 deg at six lateral stresses, sigma_1 with normal scatter.
class ScatteredTests {
public:
    std::vector<PeakPoint> next() {
        auto points = on_line(rock, {0.0, 0.1e6, 0.2e6, 0.4e6, 0.7e6, 1.0e6});
        for (PeakPoint& point : points) point.sigma_1 += scatter_(engine_);
        return points;
    }
    const Envelope rock{0.16e6, 36.2 * degree};

private:
    std::mt19937_64 engine_{20190701};
    std::normal_distribution<double> scatter_{0.0, 0.02e6};
};

struct Spread {
    double sum = 0.0;
    double squares = 0.0;
    double variances = 0.0; // as the fits tell them
    int n = 0;

    void add(double value, double error) {
        sum += value;
        squares += value * value;
        variances += error * error;
        ++n;
    }
    [[nodiscard]] double found() const { return (squares - sum * sum / n) / (n - 1); }
    [[nodiscard]] double told() const { return variances / n; }
};

// Monte Carlo with a fixed seed: the variance that the fits tell is in the mean that of the fitted parameters. A variance from
// 20 000 samples has a standard error of sqrt(2/20 000) = 1 %, its mean estimate of 4 degrees of freedom one of 0.5 %; scatter
// this small leaves the delta method a bias of (error of q/q)^2, 1e-4.
TEST(Envelope, TellsTheScatterThatRepeatedTestsHave) {
    ScatteredTests tests;
    Spread cohesion;
    Spread angle;
    for (int i = 0; i < 20000; ++i) {
        const Envelope fit = fit_envelope(tests.next());
        cohesion.add(fit.cohesion / MPa, *fit.cohesion_error() / MPa);
        angle.add(fit.friction_angle, *fit.friction_angle_error());
    }
    EXPECT_NEAR(cohesion.told() / cohesion.found(), 1.0, 0.04);
    EXPECT_NEAR(angle.told() / angle.found(), 1.0, 0.04);
}

// The band of 95 % holds the shear strength of the rock in 95 % of the fits; of 20 000 the share has a standard error of 0.15 %.
TEST(Envelope, HasItsRockInTheConfidenceBandInNinetyFiveOfAHundredCases) {
    ScatteredTests tests;
    for (const double sigma : {0.0, 1.5e6}) {
        int n_inside = 0;
        constexpr int n = 20000;
        for (int i = 0; i < n; ++i) {
            const Envelope fit = fit_envelope(tests.next());
            const double miss = fit.shear_strength(sigma) - tests.rock.shear_strength(sigma);
            if (std::abs(miss) <= *fit.confidence(sigma)) ++n_inside;
        }
        EXPECT_NEAR(static_cast<double>(n_inside) / n, 0.95, 0.008) << sigma;
    }
}

TEST(Envelope, OfTwoPointsHasNoErrors) {
    const Envelope fit = fit_envelope(on_line({0.16e6, 36.2 * degree}, {0.0, 1e6}));
    EXPECT_FALSE(fit.covariance);
    EXPECT_FALSE(fit.cohesion_error());
    EXPECT_FALSE(fit.friction_angle_error());
    EXPECT_FALSE(fit.confidence(0.0));
}

TEST(Envelope, NeedsTwoLateralStressesAndARisingLine) {
    EXPECT_THROW((void)fit_envelope({}), InputError);
    EXPECT_THROW((void)fit_envelope({strength_at(0.2e6, 1e6)}), InputError);
    EXPECT_THROW((void)fit_envelope({strength_at(0.2e6, 1e6), strength_at(0.2e6, 1.1e6)}), InputError);
    EXPECT_THROW((void)fit_envelope({strength_at(0.0, 1e6), strength_at(0.2e6, 0.5e6)}), InputError);
    EXPECT_THAT(message_of({strength_at(0.0, 1e-300), strength_at(1e-300, 2e-300)}), HasSubstr("different lateral"));
}

// ---- bounds --------------------------------------------------------------------------------------------------------

TEST(Envelope, LeavesBoundsAndTensionTestsOut) {
    const Envelope exact{0.16e6, 36.2 * degree};
    auto points = on_line(exact, {0.0, 0.2e6, 1.0e6});
    points.push_back({.run = "rising", .sigma_3 = 0.5e6, .sigma_1 = 9e6, .peak_reached = false});
    points.push_back({.run = "loose", .sigma_3 = 0.5e6, .sigma_1 = 0.1e6, .balanced = false});
    points.push_back({.run = "locked", .sigma_3 = 0.5e6, .sigma_1 = 9e6, .net_locked = true});
    points.push_back({.run = "pulled", .sigma_3 = -0.1e6});
    const StrengthFit fit = fit_strength(points);
    EXPECT_NEAR(fit.envelope.cohesion, exact.cohesion, 1e-6);
    EXPECT_NEAR(fit.envelope.friction_angle, exact.friction_angle, 1e-12);
    EXPECT_EQ(fit.envelope.residuals.n_points, 3U);
    // What was carried without a peak is above the line; what was carried less is not, nor is masonry's load the rock's.
    EXPECT_TRUE(contradicts(points[3], fit));
    EXPECT_FALSE(contradicts(points[4], fit));
    EXPECT_FALSE(contradicts(points[5], fit));
    EXPECT_FALSE(contradicts({.run = "s", .sigma_3 = 0.5e6, .sigma_1 = 9e6}, fit));
    EXPECT_EQ(bound_reason(points[3]), "not yet falling");
    EXPECT_EQ(bound_reason(points[4]), "unbalanced");
    EXPECT_EQ(bound_reason(points[5]), "net locked");
    EXPECT_EQ(bound_reason(points[6]), "");
}

TEST(Envelope, SaysWhatIsMissingWhereTheRestAreBounds) {
    EXPECT_THAT(message_of({strength_at(0.0, 1e6), {"rising", 0.5e6, 9e6, false}, {"pulled", -0.1e6, 0.0}}),
                AllOf(HasSubstr("at least two runs with different lateral stresses that reached their peaks"),
                      HasSubstr("found 1"), HasSubstr("rising: not yet falling"), HasSubstr("pulled: in tension")));
    EXPECT_THAT(message_of({strength_at(0.0, 1e6)}), Not(HasSubstr("found")));
}

// ---- tension -------------------------------------------------------------------------------------------------------

// Mean of 1, 2, 3, 6 is 3; squares of the deviations 4 + 1 + 0 + 9 = 14; s^2 = 14/3, standard error sqrt(14/3/4).
TEST(TensileStrength, IsTheMeanOfTensionTestsWithItsStandardError) {
    std::vector<PeakPoint> points{strength_at(0.0, 8 * MPa)};
    for (const double strength : {1.0, 2.0, 3.0, 6.0})
        points.push_back({.run = "t", .sigma_3 = -strength * MPa, .sigma_1 = 0.0});
    points.push_back({.run = "rising", .sigma_3 = -9 * MPa, .peak_reached = false});
    const auto strength = fit_tensile_strength(points);
    ASSERT_TRUE(strength && strength->error);
    EXPECT_NEAR(strength->value, 3 * MPa, 1e-6);
    EXPECT_NEAR(*strength->error, std::sqrt(14.0 / 12.0) * MPa, 1e-6);
    EXPECT_TRUE(contradicts(points.back(), {.envelope = {}, .tensile_strength = strength, .hoek_brown = {}}));
}

TEST(TensileStrength, OfOneTestHasNoErrorAndOfNoneIsNotKnown) {
    const auto strength = fit_tensile_strength({{.run = "t", .sigma_3 = -2e6}});
    ASSERT_TRUE(strength);
    EXPECT_EQ(strength->value, 2e6);
    EXPECT_FALSE(strength->error);
    EXPECT_FALSE(fit_tensile_strength({strength_at(0.0, 1e6)}));
    EXPECT_FALSE(fit_tensile_strength({{"t", -2e6, 0.0, false}}));
}

// ---- Hoek-Brown ----------------------------------------------------------------------------------------------------

std::vector<PeakPoint> on_hoek_brown(double sigma_ci, double m_i, const std::vector<double>& lateral) {
    std::vector<PeakPoint> points;
    for (const double sigma_3 : lateral)
        points.push_back(strength_at(sigma_3, sigma_3 + sigma_ci * std::pow(m_i * sigma_3 / sigma_ci + 1.0, 0.5)));
    return points;
}

TEST(HoekBrown, FindsTheParametersOfPointsOnItsCurve) {
    for (const auto& [sigma_ci, m_i] : {std::pair{100e6, 10.0}, {27.6e6, 25.3}, {0.5e6, 4.0}}) {
        const auto fit =
            fit_hoek_brown(on_hoek_brown(sigma_ci, m_i, {0.0, 0.05 * sigma_ci, 0.2 * sigma_ci, 0.5 * sigma_ci}));
        ASSERT_TRUE(fit.curve) << fit.problem;
        EXPECT_NEAR(fit.curve->sigma_ci.value / sigma_ci, 1.0, 1e-12);
        EXPECT_NEAR(fit.curve->m_i.value / m_i, 1.0, 1e-12);
        EXPECT_NEAR(*fit.curve->m_i.error, 0.0, 1e-6);
        EXPECT_NEAR(fit.curve->residuals.rms / sigma_ci, 0.0, 1e-12);
    }
}

// By hand: sigma_3 = 0, 1, 2 MPa with (sigma_1 - sigma_3)^2 = 9, 18, 21 MPa^2 is 10 + 6 sigma_3, residuals -1, 2, -1;
// s^2 = 6, var slope = 3, var intercept = 6 (1/3 + 1/2) = 5, cov = -3. sigma_ci = sqrt 10, its variance 5/(4 * 10);
// m = 6/sqrt 10, dm/dslope = 1/sqrt 10, dm/dintercept = -6/(2 * 10^1.5) = -0.0948683:
// var m = 3/10 + 0.009 * 5 + 2 * 0.316228 * 0.0948683 * 3 = 0.525.
TEST(HoekBrown, HasTheStandardErrorsOfARegressionByHand) {
    const auto fit = fit_hoek_brown({strength_at(0.0, 3 * MPa), strength_at(1 * MPa, (1 + std::sqrt(18.0)) * MPa),
                                     strength_at(2 * MPa, (2 + std::sqrt(21.0)) * MPa)});
    ASSERT_TRUE(fit.curve);
    EXPECT_NEAR(fit.curve->sigma_ci.value, std::sqrt(10.0) * MPa, 1e-6 * MPa);
    EXPECT_NEAR(*fit.curve->sigma_ci.error, std::sqrt(0.125) * MPa, 1e-6 * MPa);
    EXPECT_NEAR(fit.curve->m_i.value, 6.0 / std::sqrt(10.0), 1e-9);
    EXPECT_NEAR(*fit.curve->m_i.error, std::sqrt(0.525), 1e-9);
    EXPECT_NEAR(fit.curve->residuals.r_squared, 1.0 - 6.0 / 78.0, 1e-9);
}

TEST(HoekBrown, IsNotFittedToFewLateralStressesOrImpossibleParameters) {
    // 0.2 and 0.2001 MPa of a range of 0.2 MPa are one lateral stress.
    const auto few = on_hoek_brown(1e6, 10.0, {0.0, 0.2e6, 0.2001e6});
    EXPECT_THAT(fit_hoek_brown(few).problem, HasSubstr("2 different sigma_3, at least 3 are needed"));
    EXPECT_FALSE(fit_hoek_brown(few).curve);
    EXPECT_FALSE(fit_hoek_brown({}).curve);
    // A curve that bends upwards: (sigma_1 - sigma_3)^2 = 0, 1, 16 MPa^2 has a negative intercept.
    EXPECT_THAT(
        fit_hoek_brown({strength_at(0, 0), strength_at(1 * MPa, 2 * MPa), strength_at(2 * MPa, 6 * MPa)}).problem,
        HasSubstr("sigma_ci^2"));
    EXPECT_THAT(
        fit_hoek_brown({strength_at(0, 2 * MPa), strength_at(1 * MPa, 3 * MPa), strength_at(2 * MPa, 4 * MPa)}).problem,
        HasSubstr("m_i"));
    EXPECT_THAT(fit_hoek_brown({strength_at(0, 9 * MPa), {"b", 1e6, 1e7, false}, strength_at(2e6, 2e7)}).problem,
                HasSubstr("2 different"));
}

// Mohr's circle of a line touches it where tau = c + sigma tan(phi): of a straight line at sigma = (sigma_1 + sigma_3)/2
// - (sigma_1 - sigma_3)/2 sin(phi), whatever the circle.
TEST(PointOfContact, OfALineLiesOnTheLineOfShearStrength) {
    const Envelope line{0.16e6, 36.2 * degree};
    const double sine = std::sin(line.friction_angle);
    for (const double sigma_3 : {-0.05e6, 0.0, 0.3e6, 2e6}) {
        const double sigma_1 = line.sigma_1(sigma_3);
        const Vec2 contact = point_of_contact(sigma_3, sigma_1, (1.0 + sine) / (1.0 - sine));
        EXPECT_NEAR(contact.x(), 0.5 * (sigma_1 + sigma_3) - 0.5 * (sigma_1 - sigma_3) * sine, 1e-6);
        EXPECT_NEAR(contact.y(), line.shear_strength(contact.x()), 1e-6);
    }
}

} // namespace
} // namespace kluft

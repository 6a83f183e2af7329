#include "kluft/output/envelope.hpp"

#include <cmath>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryDirectory;

/// Points, from the first line of an SVG.
double height_of_picture(const std::string& svg) {
    std::smatch found;
    const bool has_height = std::regex_search(svg, found, std::regex("height=\"([0-9.]+)"));
    EXPECT_TRUE(has_height);
    return has_height ? std::stod(found[1]) : 0.0;
}

TEST(Envelope, TakesTheLateralStressAtThePeak) {
    std::vector<StepRecord> rows(3);
    rows[1].axial_stress = 1.4e6;
    rows[1].lateral_stress = 0.21e6;
    rows[2].axial_stress = 1.0e6;
    rows[2].lateral_stress = 0.2e6;
    const PeakPoint point = peak_point("c", rows, 0);
    EXPECT_EQ(point.sigma_1, 1.4e6);
    EXPECT_EQ(point.sigma_3, 0.21e6);
    EXPECT_TRUE(point.peak_reached);
    rows[2].axial_stress = 1.39e6;
    EXPECT_FALSE(peak_point("c", rows, 0).peak_reached);
    rows[2].axial_stress = 1.0e6;
    EXPECT_FALSE(peak_point("c", rows).peak_reached); // without a platen nothing is tested
    EXPECT_THROW((void)peak_point("c", {}), InputError);
}

// Triaxial extension: the axial stress is the smaller one; its peak is the lowest.
TEST(Envelope, TakesTheSmallerStressAtThePeakOfAPulledRunAsSigma3) {
    std::vector<StepRecord> rows(3);
    for (StepRecord& row : rows) row.lateral_stress = 1e6;
    rows[0].axial_stress = 1e6;
    rows[1].axial_stress = 0.2e6;
    rows[2].axial_stress = 0.4e6;
    for (std::size_t i = 1; i < 3; ++i) {
        rows[i].stage = 1;
        rows[i].axial_strain = -0.001 * static_cast<double>(i);
    }
    const PeakPoint point = peak_point("extension", rows, 1);
    EXPECT_EQ(point.sigma_1, 1e6);
    EXPECT_EQ(point.sigma_3, 0.2e6);
    EXPECT_TRUE(point.peak_reached);
}

// Pressed to 20 MPa under 5 MPa, held there while the sides are unloaded, and broken under 3.3 MPa: no strength under 5 MPa.
TEST(Envelope, TakesNoPeakThatStoodWhileItsSidesWereUnloaded) {
    const std::vector<Vec2> stresses{{0.0, 0.0}, {20e6, 5e6}, {19.999e6, 4e6}, {19.998e6, 3.3e6}, {10e6, 3.2e6}};
    std::vector<StepRecord> rows(stresses.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].axial_stress = stresses[i].x();
        rows[i].lateral_stress = stresses[i].y();
    }
    const PeakPoint unloaded = peak_point("unloaded", rows, 0);
    EXPECT_EQ(use_of(unloaded), PeakUse::bound);
    EXPECT_EQ(bound_reason(unloaded), "sides unloaded");
    for (StepRecord& row : rows) row.lateral_stress = 5e6;
    EXPECT_EQ(use_of(peak_point("triaxial", rows, 0)), PeakUse::strength);
}

const Envelope tested_rock{0.16e6, 36.2 * degree};

std::vector<PeakPoint> two_points() {
    return {{"c0", 0.0, tested_rock.sigma_1(0.0)}, {"c1", 1e6, tested_rock.sigma_1(1e6)}};
}

/// Four strengths, a run above their line that was still rising, a locked net and two tension tests. By hand, in MPa:
/// sigma_1 = 1.271366 + 3.185022 sigma_3, so c = 0.356192 and phi = 31.473 deg; (sigma_1 - sigma_3)^2 = 1.422467 +
/// 9.747137 sigma_3, so sigma_ci = 1.192672 and m_i = 8.172520. R^2 of the line = 1 - 0.190573/5.9475.
std::vector<PeakPoint> many_points() {
    std::vector<PeakPoint> points{{"c0", 0.0, 1e6}, {"c1", 0.2e6, 2.1e6}, {"c2", 0.5e6, 3.1e6}, {"c3", 1e6, 4.3e6}};
    points.push_back({"rising", 0.3e6, 3e6, false});
    points.push_back({"locked", 0.3e6, 4e6, true, true, true});
    points.push_back({"t1", -0.09e6, 0.0});
    points.push_back({"t2", -0.11e6, 0.0});
    return points;
}

TEST(EnvelopeText, OfTwoPointsSaysThatErrorsAreUnknown) {
    const auto points = two_points();
    const std::string text = envelope_text(points, fit_strength(points));
    EXPECT_THAT(text, HasSubstr("cohesion 0.1600 MPa, friction angle 36.20 deg\n  standard errors unknown"));
    EXPECT_THAT(text, HasSubstr("Hoek-Brown: not fitted: 2 different sigma_3"));
    EXPECT_THAT(text, Not(HasSubstr("+-")));
    EXPECT_THAT(text, Not(HasSubstr("bound")));
}

TEST(EnvelopeText, TellsErrorsTensionBoundsAndWhatContradicts) {
    const auto points = many_points();
    const std::string text = envelope_text(points, fit_strength(points));
    EXPECT_THAT(text, ContainsRegex("cohesion 0.3562 \\+- 0.0[0-9]* MPa, friction angle 31.47 \\+- [0-9.]* deg"));
    EXPECT_THAT(text, HasSubstr("4 points, R^2 0.9680"));
    EXPECT_THAT(text, HasSubstr("tensile strength 0.1000 +- 0.0100 MPa (mean of 2 tests), c/sigma_t 3.562"));
    EXPECT_THAT(text, ContainsRegex("Hoek-Brown: sigma_ci 1.1927 \\+- 0.[0-9]* MPa, m_i 8.173 \\+- "));
    EXPECT_THAT(text, HasSubstr("2 bounds, left out of the fit: rising (not yet falling), locked (net locked)"));
    EXPECT_THAT(text, HasSubstr("the fit is contradicted: it lies below what was carried by rising\n"));
}

// sigma_1 = 1 + 0.5 sigma_3: sin(phi) = (0.5 - 1)/(0.5 + 1) = -1/3; a soft rock under the higher pressure.
TEST(EnvelopeText, WarnsWhereTheStrengthFallsWithTheLateralStress) {
    const std::vector<PeakPoint> points{{"a", 0.0, 1e6}, {"b", 1e6, 1.5e6}};
    EXPECT_THAT(envelope_text(points, fit_strength(points)),
                AllOf(HasSubstr("friction angle -19.47 deg"),
                      HasSubstr("\nwarning: the friction angle is below zero: "),
                      HasSubstr("falls as the lateral stress rises; these tests are not of one material")));
}

// sigma_1 = 4 (sigma_3 - 0.1): c = -0.4/(2 sqrt(4)); a stronger rock under the higher pressure.
TEST(EnvelopeText, WarnsOfACohesionBelowZero) {
    const std::vector<PeakPoint> points{{"a", 0.2e6, 0.4e6}, {"b", 1e6, 3.6e6}};
    EXPECT_THAT(envelope_text(points, fit_strength(points)),
                AllOf(HasSubstr("cohesion -0.1000 MPa"), HasSubstr("\nwarning: the cohesion is below zero: ")));
    EXPECT_THAT(envelope_text(two_points(), fit_strength(two_points())), Not(HasSubstr("warning")));
}

// sigma_t = 0.3 MPa is beyond c cot(phi) = 0.16/tan(36.2 deg) = 0.2186 MPa.
TEST(EnvelopeText, SaysWhereTheCutOffIsBeyondTheApex) {
    auto points = two_points();
    points.push_back({"t", -0.3e6, 0.0});
    const std::string text = envelope_text(points, fit_strength(points));
    EXPECT_THAT(text, HasSubstr("tensile strength 0.3000 MPa (one test, standard error unknown)"));
    EXPECT_THAT(text, HasSubstr("c cot(phi) = 0.2186 MPa"));
}

// A body that is cut through holds nothing; what is left over in its balance is no stress.
TEST(EnvelopeText, OfABodyThatHoldsNoTensionHasNoRatioToIt) {
    auto points = two_points();
    points.push_back({"cut through", -7.4e-8, 0.0});
    const StrengthFit fit = fit_strength(points);
    EXPECT_THAT(envelope_text(points, fit), AllOf(HasSubstr("tensile strength 0.0000 MPa (one test"),
                                                  Not(HasSubstr("c/sigma_t")), Not(HasSubstr("-0.0000"))));
    const auto json = nlohmann::json::parse(envelope_json(points, fit));
    EXPECT_EQ(json["tensile_strength"], 0.0);
    EXPECT_TRUE(json["cohesion_over_tensile_strength"].is_null());
}

TEST(EnvelopeText, WarnsOfStressesThatSeemToBeWithoutUnits) {
    const std::vector<PeakPoint> bare{{"a", 0.0, 30.0}, {"b", 5.0, 60.0}, {"c", 10.0, 85.0}};
    EXPECT_THAT(
        envelope_text(bare, fit_strength(bare)),
        HasSubstr("warning: all stresses are below 1 kPa (the largest is 85 Pa); a table without units is read in "
                  "Pa, its first line names others, as in 'sigma_3 (MPa),sigma_1 (MPa)'\n"));
    EXPECT_THAT(envelope_text(two_points(), fit_strength(two_points())), Not(HasSubstr("warning")));
}

TEST(EnvelopeTable, HasAColumnForEachThingThatIsKnownOfATest) {
    const auto points = many_points();
    const std::string text = envelope_csv(points, fit_strength(points));
    EXPECT_THAT(text, ::testing::StartsWith("run,sigma_3,sigma_1,fitted_sigma_1,"
                                            "peak_reached,balanced,net_locked,unloaded,moves_platen,use\nc0,0,"));
    EXPECT_THAT(text, ContainsRegex("\nrising,[^\n]*,0,1,0,0,1,bound\n"));
    EXPECT_THAT(text, ContainsRegex("\nlocked,[^\n]*,1,1,1,0,1,bound\n"));
    EXPECT_THAT(text, ContainsRegex("\nt1,[^\n]*,1,1,0,0,1,tension\n"));
}

TEST(EnvelopeDocument, HoldsEveryNumberAndNullForWhatIsNotKnown) {
    const auto points = many_points();
    const StrengthFit fit = fit_strength(points);
    const auto json = nlohmann::json::parse(envelope_json(points, fit));
    EXPECT_EQ(json["cohesion"], fit.envelope.cohesion);
    EXPECT_EQ(json["cohesion_error"], *fit.envelope.cohesion_error());
    EXPECT_DOUBLE_EQ(json["friction_angle"].get<double>() * degree, fit.envelope.friction_angle);
    EXPECT_DOUBLE_EQ(json["friction_angle_error"].get<double>() * degree, *fit.envelope.friction_angle_error());
    EXPECT_DOUBLE_EQ(json["tensile_strength"], 0.1e6);
    EXPECT_NEAR(json["tensile_strength_error"].get<double>(), 0.01e6, 1e-6);
    ASSERT_TRUE(fit.hoek_brown.curve);
    EXPECT_EQ(json["hoek_brown"]["sigma_ci"], fit.hoek_brown.curve->sigma_ci.value);
    EXPECT_EQ(json["hoek_brown"]["m_i_error"], *fit.hoek_brown.curve->m_i.error);
    EXPECT_EQ(json["n_points"], 4);
    EXPECT_EQ(json["n_tension"], 2);
    EXPECT_EQ(json["n_bounds"], 2);
    EXPECT_EQ(json["contradicted_by"], nlohmann::json::array({"rising"}));
    EXPECT_EQ(json["points"][5]["reason"], "net locked");

    const auto two = two_points();
    const auto bare = nlohmann::json::parse(envelope_json(two, fit_strength(two)));
    for (const char* key : {"cohesion_error", "friction_angle_error", "tensile_strength", "tensile_strength_error"})
        EXPECT_TRUE(bare.at(key).is_null()) << key;
    EXPECT_TRUE(bare["hoek_brown"]["m_i"].is_null());
    EXPECT_THAT(bare["hoek_brown"]["problem"].get<std::string>(), HasSubstr("2 different"));
}

TEST(EnvelopePicture, IsDrawnInBothFormatsForFewAndManyTests) {
    const TemporaryDirectory directory;
    auto points = many_points();
    const NamedEnvelope published{"published", {0.118e6, 39.6 * degree}};
    write_envelope(directory / "e.png", "Envelope", points, fit_strength(points), {published});
    EXPECT_THAT(read_file(directory / "e.png"), ::testing::StartsWith("\x89PNG"));
    write_envelope(directory / "e.svg", "Envelope", points, fit_strength(points));
    const std::string few = read_file(directory / "e.svg");
    EXPECT_THAT(few, HasSubstr("</svg>"));
    // One entry more than tests that are named makes the legend shorter, not longer.
    while (points.size() <= 12) points.push_back(points.front());
    write_envelope(directory / "many.svg", "Envelope", points, fit_strength(points));
    EXPECT_LT(height_of_picture(read_file(directory / "many.svg")), height_of_picture(few));
}

} // namespace
} // namespace kluft

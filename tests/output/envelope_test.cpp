#include "kluft/output/envelope.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "output/temporary_directory.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;

// The published tests: c = 0.16 MPa, phi = 36.2 deg; uniaxial strength 2 c cos/(1 - sin) = 0.6308 MPa.
TEST(Envelope, GivesTheUniaxialStrengthOfTheTests) {
    const Envelope tests{0.16e6, 36.2 * degree};
    EXPECT_NEAR(tests.sigma_1(0.0), 0.6308e6, 50.0);
    EXPECT_NEAR(tests.sigma_1(0.2e6), 1.4078e6, 50.0);
}

TEST(Envelope, FindsCohesionAndFrictionAngleOfPointsOnALine) {
    for (const Envelope& exact :
         {Envelope{0.16e6, 36.2 * degree}, Envelope{0.118e6, 39.6 * degree}, Envelope{0.0, 0.0}}) {
        std::vector<PeakPoint> points;
        for (const double sigma_3 : {0.0, 0.2e6, 0.55e6, 1.0e6})
            points.push_back({"", sigma_3, exact.sigma_1(sigma_3)});
        const Envelope fit = fit_envelope(points);
        EXPECT_NEAR(fit.cohesion, exact.cohesion, 1e-6);
        EXPECT_NEAR(fit.friction_angle, exact.friction_angle, 1e-12);
    }
}

// Least squares by hand: sigma_1 on sigma_3 of (0, 1), (1, 5), (2, 6) MPa is 1.5 + 2.5 sigma_3.
TEST(Envelope, IsTheLeastSquaresLineOfSigma1OnSigma3) {
    const Envelope fit = fit_envelope({{"a", 0.0, 1e6}, {"b", 1e6, 5e6}, {"c", 2e6, 6e6}});
    EXPECT_NEAR(fit.sigma_1(0.0), 1.5e6, 1e-6);
    EXPECT_NEAR(fit.sigma_1(1e6), 4.0e6, 1e-6);
}

TEST(Envelope, NeedsTwoLateralStressesAndARisingLine) {
    EXPECT_THROW((void)fit_envelope({}), InputError);
    EXPECT_THROW((void)fit_envelope({{"a", 0.2e6, 1e6}}), InputError);
    EXPECT_THROW((void)fit_envelope({{"a", 0.2e6, 1e6}, {"b", 0.2e6, 1.1e6}}), InputError);
    EXPECT_THROW((void)fit_envelope({{"a", 0.0, 1e6}, {"b", 0.2e6, 0.5e6}}), InputError);
}

TEST(Envelope, TakesTheLateralStressAtThePeak) {
    std::vector<StepRecord> rows(3);
    rows[1].axial_stress = 1.4e6;
    rows[1].lateral_stress = 0.21e6;
    rows[2].axial_stress = 1.0e6;
    rows[2].lateral_stress = 0.2e6;
    const PeakPoint point = peak_point("c", rows);
    EXPECT_EQ(point.sigma_1, 1.4e6);
    EXPECT_EQ(point.sigma_3, 0.21e6);
    EXPECT_TRUE(point.peak_reached);
    rows[2].axial_stress = 1.39e6;
    EXPECT_FALSE(peak_point("c", rows).peak_reached);
    EXPECT_EQ(peak_point("c", rows).remark, "still rising");
    rows[1].net_broken = rows[2].net_broken = 1.0;
    rows[2].axial_stress = 1.48e6; // by more than 5 % above what it carried when its bonds had failed
    EXPECT_EQ(peak_point("c", rows).sigma_1, 1.4e6);
    EXPECT_EQ(peak_point("c", rows).remark, "net locked");
    EXPECT_THROW((void)peak_point("c", {}), InputError);
}

TEST(Envelope, IsWrittenAsTextTableAndPictures) {
    const TemporaryDirectory directory;
    const Envelope exact{0.16e6, 36.2 * degree};
    const std::vector<PeakPoint> points{{"c0", 0.0, exact.sigma_1(0.0)},
                                        {"c1", 1e6, exact.sigma_1(1e6), false, "net locked"}};
    EXPECT_THAT(envelope_text(points, exact), HasSubstr("cohesion 0.1600 MPa, friction angle 36.20 deg"));
    EXPECT_THAT(envelope_text(points, exact), HasSubstr("  net locked\n"));
    EXPECT_THAT(envelope_csv(points, exact),
                ::testing::StartsWith("run,sigma_3,sigma_1,fitted_sigma_1,peak_reached\nc0,0,"));
    write_envelope(directory / "e.png", "Envelope", points, exact, {{"published", {0.118e6, 39.6 * degree}}});
    write_envelope(directory / "e.svg", "Envelope", points, exact);
    EXPECT_THAT(read_file(directory / "e.png"), ::testing::StartsWith("\x89PNG"));
    EXPECT_THAT(read_file(directory / "e.svg"), HasSubstr("</svg>"));
}

} // namespace
} // namespace kluft

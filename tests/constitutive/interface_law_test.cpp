#include "kluft/constitutive/interface_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace kluft {
namespace {

InterfaceLaw joint() {
    InterfaceLaw law;
    law.normal_stiffness = 4e9;
    law.shear_stiffness = 2e9;
    law.tan_friction = std::tan(30.0 * std::numbers::pi / 180.0);
    law.cohesion = 0.1e6;
    law.cohesion_onset = 0.04e6;
    law.contact_rounding = 0.004e6;
    law.friction_rounding = 0.05;
    return law;
}

InterfaceLaw sharp_joint() {
    InterfaceLaw law = joint();
    law.cohesion = 0.0;
    law.cohesion_onset = 0.0;
    law.contact_rounding = 0.0;
    law.friction_rounding = 0.0;
    return law;
}

void expect_tangent_matches_differences(const InterfaceLaw& law, const PointHistory& start, double gap, double slip) {
    const double step = 1e-11;
    const auto at = [&](double g, double s) { return fracture_traction(law, start, g, s); };
    const auto exact = at(gap, slip);
    const double scale = law.normal_stiffness;
    EXPECT_NEAR(exact.tangent(0, 0), (at(gap + step, slip).normal - at(gap - step, slip).normal) / (2 * step),
                2e-4 * scale);
    EXPECT_NEAR(exact.tangent(0, 1), (at(gap, slip + step).normal - at(gap, slip - step).normal) / (2 * step),
                2e-4 * scale);
    EXPECT_NEAR(exact.tangent(1, 0), (at(gap + step, slip).shear - at(gap - step, slip).shear) / (2 * step),
                2e-4 * scale);
    EXPECT_NEAR(exact.tangent(1, 1), (at(gap, slip + step).shear - at(gap, slip - step).shear) / (2 * step),
                2e-4 * scale);
}

TEST(InterfaceLaw, TangentIsTheDerivativeInEveryRegimeOfTheFractureLaw) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> gap(-6e-5, 1e-5);
    std::uniform_real_distribution<double> slip(-2e-4, 2e-4);
    std::uniform_real_distribution<double> shear(-0.2e6, 0.2e6);
    for (const double dilation : {0.0, 0.1}) {
        InterfaceLaw law = joint();
        law.tan_dilation = dilation;
        for (int i = 0; i < 300; ++i) {
            const PointHistory start{shear(generator), 0.0};
            expect_tangent_matches_differences(law, start, gap(generator), slip(generator));
        }
    }
}

TEST(InterfaceLaw, OpenPointCarriesNothingAndForgetsItsShear) {
    const auto traction = fracture_traction(joint(), {0.05e6, 0.0}, 1e-9, 1e-4);
    EXPECT_EQ(traction.state, ContactState::open);
    EXPECT_EQ(traction.normal, 0.0);
    EXPECT_EQ(traction.shear, 0.0);
    EXPECT_EQ(traction.history.shear_trial, 0.0);
}

// The body as it was cut is free of stress: no pressure at gap 0, also with rounding.
// Friction of a given size has an energy: the shear traction does not know the gap, and the tangent is symmetric.
TEST(InterfaceLaw, AHeldLimitBoundsTheShearWhateverThePressure) {
    const InterfaceLaw law = joint();
    const double limit = 0.3e6;
    for (const double gap : {1e-4, 0.0, -1e-7, -1e-3}) {
        for (const double slip : {-1.0, -1e-5, 1e-5, 1.0}) {
            const auto held = fracture_traction(law, {}, gap, slip, {}, limit);
            EXPECT_NEAR(held.shear, std::clamp(law.shear_stiffness * slip, -limit, limit), 1e-9 * limit) << gap;
            EXPECT_DOUBLE_EQ(held.normal, fracture_traction(law, {}, gap, slip).normal);
            EXPECT_EQ(held.tangent(0, 1), 0.0);
            EXPECT_EQ(held.tangent(1, 0), 0.0);
        }
    }
}

TEST(InterfaceLaw, PressureIsContinuousAndVanishesWithTheGap) {
    const InterfaceLaw law = joint();
    const double g0 = law.contact_rounding / law.normal_stiffness;
    EXPECT_EQ(contact_pressure(law, 0.0).value, 0.0);
    EXPECT_NEAR(contact_pressure(law, -2.0 * g0).value, law.normal_stiffness * g0, 1e-6);
    EXPECT_NEAR(contact_pressure(law, -2.0 * g0 - 1e-15).slope, -law.normal_stiffness, 1.0);
    EXPECT_NEAR(contact_pressure(law, -2.0 * g0 + 1e-15).slope, -law.normal_stiffness, 10.0);
}

// Direct shear at 1 MPa, phi 30 deg, no cohesion: slope k_s, then tan 30 deg MPa = 0.57735 MPa.
TEST(InterfaceLaw, DirectShearRisesWithTheShearStiffnessToCoulombsLimit) {
    const InterfaceLaw law = sharp_joint();
    const double gap = -1e6 / law.normal_stiffness;
    EXPECT_NEAR(fracture_traction(law, {}, gap, 1e-5).shear, law.shear_stiffness * 1e-5, 1e-6);
    const auto sliding = fracture_traction(law, {}, gap, 1e-2);
    EXPECT_NEAR(sliding.shear, 1e6 / std::sqrt(3.0), 1e-6);
    EXPECT_EQ(sliding.state, ContactState::sliding);
    EXPECT_NEAR(sliding.history.shear_trial, 1e6 / std::sqrt(3.0), 1e-6);
}

TEST(InterfaceLaw, CohesionVanishesContinuouslyAtOpening) {
    const InterfaceLaw law = joint();
    const auto limit_at = [&](double p) {
        return shear_limit(law, -(p + law.contact_rounding) / law.normal_stiffness);
    };
    EXPECT_NEAR(shear_limit(law, -1e-15).value, 0.0, 1e-2);
    EXPECT_NEAR(limit_at(law.cohesion_onset).value, law.cohesion + law.cohesion_onset * law.tan_friction, 1e-6);
    EXPECT_NEAR(limit_at(1e6).value, law.cohesion + 1e6 * law.tan_friction, 1e-6);
}

// The mean of c min(1, p/t_r) over the piece, by the midpoint rule on 10^5 parts; p linear between the pressures at its ends.
TEST(InterfaceLaw, CohesionIsTheMeanOverThePieceAsFarAsItIsClosed) {
    InterfaceLaw law = joint();
    law.contact_rounding = 0.0;
    const double gap = -1e-5; // p = 0.04 MPa = t_r
    for (const double tilt : {-8e-5, -3e-5, -1e-6, 0.0, 1e-9, 2e-5, 6e-5, 1e-3}) {
        const ContactPiece piece{.from = -1.0 / 3.0, .to = 0.5, .tilt = tilt};
        constexpr int n_parts = 100000;
        double mean = 0.0;
        for (int i = 0; i < n_parts; ++i) {
            const double along = piece.from + (piece.to - piece.from) * (i + 0.5) / n_parts;
            const double pressure = std::max(0.0, -law.normal_stiffness * (gap + along * tilt));
            mean += law.cohesion * std::min(1.0, pressure / law.cohesion_onset) / n_parts;
        }
        const double friction = -law.normal_stiffness * gap * law.tan_friction;
        EXPECT_NEAR(shear_limit(law, gap, piece).value, mean + friction, 1e-7 * law.cohesion) << tilt;
    }
}

TEST(InterfaceLaw, AnOpenPointCarriesTheCohesionOfTheClosedPartOfItsPiece) {
    const InterfaceLaw law = joint();
    const ContactPiece piece{.from = -0.5, .to = 0.0, .tilt = 1e-3}; // closed by half a millimetre at its other end
    const auto traction = fracture_traction(law, {}, 0.0, 1e-2, piece);
    EXPECT_EQ(traction.normal, 0.0);
    EXPECT_EQ(traction.state, ContactState::sliding);
    EXPECT_NEAR(traction.shear, law.cohesion, 0.02 * law.cohesion);
    const auto away = fracture_traction(law, {}, 1e-3, 1e-2, piece);
    EXPECT_EQ(away.state, ContactState::open);
    EXPECT_EQ(away.shear, 0.0);
}

TEST(InterfaceLaw, TangentOfAPieceMatchesDifferences) {
    InterfaceLaw law = joint();
    law.tan_dilation = 0.1;
    const double step = 1e-11;
    for (const double tilt : {-8e-5, 1e-6, 5e-5}) {
        for (const double gap : {-3e-5, -1.5e-5}) {
            const ContactPiece piece{.from = -1.0 / 6.0, .to = 0.5, .tilt = tilt};
            const auto at = [&](double g, double t) {
                return fracture_traction(law, {2e4, 1e-7}, g, 2e-4, {.from = piece.from, .to = piece.to, .tilt = t});
            };
            const auto exact = at(gap, tilt);
            const double scale = 2e-4 * law.normal_stiffness;
            EXPECT_EQ(exact.state, ContactState::sliding);
            EXPECT_NEAR(exact.tangent(0, 0), (at(gap + step, tilt).normal - at(gap - step, tilt).normal) / (2 * step),
                        scale);
            EXPECT_NEAR(exact.tangent(1, 0), (at(gap + step, tilt).shear - at(gap - step, tilt).shear) / (2 * step),
                        scale);
            EXPECT_NEAR(exact.by_tilt(0), (at(gap, tilt + step).normal - at(gap, tilt - step).normal) / (2 * step),
                        scale);
            EXPECT_NEAR(exact.by_tilt(1), (at(gap, tilt + step).shear - at(gap, tilt - step).shear) / (2 * step),
                        scale);
        }
    }
}

// Dilatant shear at constant normal stiffness K, here infinite: the gap is fixed, so
// d sigma_n = u_s,plastic tan(psi) k_n. With u_s,plastic = u_s - t_s/k_s and t_s = p tan(phi).
TEST(InterfaceLaw, DilationAtFixedGapRaisesTheNormalStress) {
    InterfaceLaw law = sharp_joint();
    law.tan_dilation = std::tan(5.0 * std::numbers::pi / 180.0);
    const double p0 = 1e6;
    const double slip = 1e-3;
    const auto traction = fracture_traction(law, {}, -p0 / law.normal_stiffness, slip);
    const double plastic = slip - traction.shear / law.shear_stiffness;
    EXPECT_NEAR(-traction.normal, p0 + law.normal_stiffness * law.tan_dilation * plastic, 1e-3);
    EXPECT_NEAR(traction.shear, -traction.normal * law.tan_friction, 1e-3);
    EXPECT_NEAR(traction.history.dilation, law.tan_dilation * plastic, 1e-15);
}

TEST(InterfaceLaw, BondIsElasticInTensionAndShear) {
    const InterfaceLaw law = joint();
    const auto traction = bond_traction(law, 1e3, 2e-6, -3e-6);
    EXPECT_DOUBLE_EQ(traction.normal, law.normal_stiffness * 2e-6);
    EXPECT_DOUBLE_EQ(traction.shear, 1e3 - law.shear_stiffness * 3e-6);
}

} // namespace
} // namespace kluft

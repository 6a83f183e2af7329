#include "kluft/constitutive/strength_envelope.hpp"
#include "support/units.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace kluft {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Of the reference test: c 0.16 MPa, phi 36.2 deg, sigma_t 0.1 MPa.
constexpr Strength sandstone{.cohesion = 0.16e6, .friction_angle = 36.2 * degree, .tensile_strength = 0.1e6};

TEST(PrincipalStresses, AreThoseOfTheRotatedDiagonal) {
    // By construction: Q(a) diag(-3, 1) Q(a)^T, positive in tension, so compression 3 and -1.
    for (const double angle : {0.0, 0.4, 1.2, 2.9}) {
        Mat2 q;
        q << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
        const Mat2 cauchy = q * Vec2(-3.0, 1.0).asDiagonal() * q.transpose();
        const PrincipalStresses principal = principal_stresses(cauchy);
        EXPECT_NEAR(principal.p1, 3.0, 1e-14);
        EXPECT_NEAR(principal.p3, -1.0, 1e-14);
    }
}

TEST(PrincipalStresses, OfHydrostaticPressureAreEqual) {
    const PrincipalStresses principal = principal_stresses(-2.0 * Mat2::Identity());
    EXPECT_EQ(principal.p1, 2.0);
    EXPECT_EQ(principal.p3, 2.0);
}

// 2 c cos(phi)/(1 - sin(phi)) = 0.6308 MPa.
TEST(FailureIndex, ReachesOneAtTheUniaxialCompressiveStrength) {
    EXPECT_NEAR(uniaxial_compressive_strength(sandstone), 0.6308e6, 50.0);
    const FailureIndex index = failure_index(uniaxial_compressive_strength(sandstone), 0.0, sandstone);
    EXPECT_NEAR(index.f, 1.0, 1e-14);
    EXPECT_FALSE(index.tension_governs);
}

// p1 = UCS + p3 (1 + sin phi)/(1 - sin phi) = 1.4078 MPa at p3 = 0.2 MPa.
TEST(FailureIndex, ReachesOneOnTheCoulombLineUnderConfinement) {
    EXPECT_NEAR(failure_index(1.4078e6, 0.2e6, sandstone).f, 1.0, 5e-5);
    EXPECT_FALSE(failure_index(1.4078e6, 0.2e6, sandstone).tension_governs);
}

TEST(FailureIndex, ReachesOneAtTheTensileStrengthInPureTension) {
    const FailureIndex index = failure_index(0.0, -0.1e6, sandstone);
    EXPECT_NEAR(index.f, 1.0, 1e-14);
    EXPECT_TRUE(index.tension_governs);
}

// At p3 = -0.1 MPa the Coulomb line is at p1 = UCS - 0.1 (1 + sin phi)/(1 - sin phi) = 0.2423 MPa.
TEST(FailureIndex, IsTensionOnTheCornerOfCoulombLineAndCutOff) {
    const FailureIndex index = failure_index(0.2423e6, -0.1e6, sandstone);
    EXPECT_NEAR(index.shear, 1.0, 3e-4);
    EXPECT_NEAR(index.tension, 1.0, 1e-14);
    EXPECT_FALSE(failure_index(0.25e6, -0.1e6, sandstone).tension_governs);
    EXPECT_TRUE(failure_index(0.23e6, -0.1e6, sandstone).tension_governs);
}

TEST(FailureIndex, IsTensionOnATie) {
    // phi = 0, sigma_t = 2 c: under p1 = 0 both indices are -p3/(2 c).
    const FailureIndex index =
        failure_index(0.0, -0.7, {.cohesion = 1.0, .friction_angle = 0.0, .tensile_strength = 2.0});
    EXPECT_EQ(index.shear, index.tension);
    EXPECT_TRUE(index.tension_governs);
}

TEST(FailureIndex, NeverReachesOneUnderHydrostaticPressure) {
    for (const double p : {0.0, 1e5, 1e7, 1e12}) EXPECT_LT(failure_index(p, p, sandstone).f, 1.0);
}

TEST(FailureIndex, IsInfiniteAtAnyLoadOfAStrengthOfZero) {
    const Strength none{};
    EXPECT_EQ(failure_index(1.0, 0.0, none).shear, infinity);
    EXPECT_EQ(failure_index(0.0, -1.0, none).tension, infinity);
    EXPECT_EQ(failure_index(1.0, 1.0, none).f, 0.0);
    // Coulomb without cohesion: the ratio p1/p3 decides.
    const Strength sand{.cohesion = 0.0, .friction_angle = 30.0 * degree, .tensile_strength = 0.0};
    EXPECT_EQ(failure_index(2.9, 1.0, sand).f, 0.0);
    EXPECT_EQ(failure_index(3.1, 1.0, sand).f, infinity);
}

TEST(CappedStrength, LimitsTensionToTheApexOfTheCoulombLine) {
    const Strength strength{.cohesion = 1.0, .friction_angle = 45.0 * degree, .tensile_strength = 3.0};
    EXPECT_TRUE(capped(strength).was_capped);
    EXPECT_NEAR(capped(strength).strength.tensile_strength, 1.0, 1e-14);
    EXPECT_EQ(capped(strength).strength.cohesion, 1.0);
    EXPECT_NEAR(failure_index(-0.5, -0.5, strength).tension, 0.5, 1e-14);
    EXPECT_FALSE(capped(sandstone).was_capped);
    EXPECT_EQ(capped(sandstone).strength.tensile_strength, 0.1e6);
}

TEST(CappedStrength, LeavesTensionAloneWithoutFriction) {
    const Strength clay{.cohesion = 0.0, .friction_angle = 0.0, .tensile_strength = 3.0};
    EXPECT_FALSE(capped(clay).was_capped);
    EXPECT_EQ(capped(clay).strength.tensile_strength, 3.0);
}

// Direct shear, c 1 MPa, phi 30 deg, pressure 1 MPa: c + tan(30 deg) = 1.5774 MPa.
TEST(FailureIndexOfTraction, ReachesOneAtThePeakOfDirectShear) {
    const Strength strength{.cohesion = 1e6, .friction_angle = 30.0 * degree, .tensile_strength = 1e6};
    for (const double shear : {1.57735e6, -1.57735e6}) {
        const FailureIndex index = failure_index_traction(-1e6, shear, strength);
        EXPECT_NEAR(index.f, 1.0, 1e-6);
        EXPECT_FALSE(index.tension_governs);
    }
    EXPECT_NEAR(failure_index_traction(1e6, 0.0, strength).tension, 1.0, 1e-14);
    EXPECT_TRUE(failure_index_traction(1e6, 0.0, strength).tension_governs);
}

TEST(FailureIndexOfTraction, TouchesTheMohrCircleAtFailureByPrincipalStresses) {
    // On the plane at 45 deg + phi/2 from the major principal plane both criteria agree (Mohr's circle).
    const double p3 = 0.2e6;
    const double p1 = uniaxial_compressive_strength(sandstone) +
                      p3 * (1.0 + std::sin(sandstone.friction_angle)) / (1.0 - std::sin(sandstone.friction_angle));
    const double twice = 90.0 * degree + sandstone.friction_angle;
    const double pressure = (p1 + p3) / 2.0 + (p1 - p3) / 2.0 * std::cos(twice);
    const double shear = (p1 - p3) / 2.0 * std::sin(twice);
    EXPECT_NEAR(failure_index_traction(-pressure, shear, sandstone).shear, 1.0, 1e-12);
}

TEST(Weaker, HasTheSmallerUniaxialStrengthThenTheSmallerTensileStrength) {
    Strength harder = sandstone;
    harder.cohesion *= 2.0;
    EXPECT_EQ(&weaker(sandstone, harder), &sandstone);
    EXPECT_EQ(&weaker(harder, sandstone), &sandstone);
    Strength cut = sandstone;
    cut.tensile_strength = 0.01e6;
    EXPECT_EQ(&weaker(sandstone, cut), &cut);
    EXPECT_EQ(&weaker(cut, sandstone), &cut);
}

} // namespace
} // namespace kluft

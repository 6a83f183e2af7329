#include "kluft/constitutive/block_elasticity.hpp"
#include "kluft/core/dense_decompositions.hpp"

#include <cmath>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace kluft {
namespace {

constexpr ElasticModuli moduli{4.0e9, 6.0e9};

Mat2 random_deformation(std::mt19937& generator) {
    std::uniform_real_distribution<double> value(-0.3, 0.3);
    Mat2 f = Mat2::Identity();
    for (int i = 0; i < 4; ++i) f(i / 2, i % 2) += value(generator);
    return f;
}

Mat2 rotation(double angle) {
    Mat2 r;
    r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return r;
}

// Central differences of the energy are an independent way to the stress.
TEST(BlockElasticity, StressIsTheGradientOfTheStrainEnergy) {
    std::mt19937 generator(1);
    for (int round = 0; round < 50; ++round) {
        const Mat2 f = random_deformation(generator);
        const Mat2 stress = first_piola_stress(f, moduli);
        for (int i = 0; i < 4; ++i) {
            const double step = 1e-6;
            Mat2 plus = f, minus = f;
            plus(i / 2, i % 2) += step;
            minus(i / 2, i % 2) -= step;
            const double slope =
                (strain_energy_density(plus, moduli) - strain_energy_density(minus, moduli)) / (2.0 * step);
            EXPECT_NEAR(stress(i / 2, i % 2), slope, 1e-8 * moduli.mu);
        }
    }
}

TEST(BlockElasticity, StressOfTheGradientAgreesAndKeepsTheDigitsOfSmallStrains) {
    std::mt19937 generator(8);
    for (int round = 0; round < 50; ++round) {
        const Mat2 f = random_deformation(generator);
        EXPECT_LT((stress_of_gradient(f - Mat2::Identity(), moduli) - first_piola_stress(f, moduli)).norm(),
                  1e-13 * 6e9);
    }
    // Hooke for a strain of 1e-12, of which 1 + 1e-12 would keep four digits
    const Mat2 h = (Mat2() << 1e-12, 0.0, 0.0, 0.0).finished();
    EXPECT_NEAR(stress_of_gradient(h, moduli)(0, 0), (moduli.lambda + 2.0 * moduli.mu) * 1e-12, 1e-11 * 16e-3);
}

TEST(BlockElasticity, TangentIsTheDerivativeOfTheStress) {
    std::mt19937 generator(2);
    for (int round = 0; round < 50; ++round) {
        const Mat2 f = random_deformation(generator);
        const Mat4 tangent = elastic_tangent(f, moduli, false);
        for (int j = 0; j < 4; ++j) {
            const double step = 1e-6;
            Mat2 plus = f, minus = f;
            plus(j % 2, j / 2) += step;
            minus(j % 2, j / 2) -= step;
            const Mat2 slope = (first_piola_stress(plus, moduli) - first_piola_stress(minus, moduli)) / (2.0 * step);
            for (int i = 0; i < 4; ++i) EXPECT_NEAR(tangent(i, j), slope(i % 2, i / 2), 1e-7 * moduli.mu);
        }
    }
}

TEST(BlockElasticity, RotationIsFreeOfStressAndTurnsTheStressWithTheBlock) {
    const Mat2 strained = (Mat2() << 1.001, 0.0005, 0.0005, 0.998).finished();
    for (const double angle : {0.1, 1.0, 3.0, -2.0}) {
        const Mat2 r = rotation(angle);
        EXPECT_LT(first_piola_stress(r, moduli).norm(), 1e-15 * moduli.mu * 10.0);
        const Mat2 turned = cauchy_stress(r * strained, moduli);
        EXPECT_LT((turned - r * cauchy_stress(strained, moduli) * r.transpose()).norm(), 1e-9 * turned.norm());
    }
}

// Plane strain Hooke: sigma_xx = (lambda + 2 mu) e for a small uniaxial strain e.
TEST(BlockElasticity, SmallStrainFollowsHookesLaw) {
    const double e = 1e-7;
    const Mat2 stress = cauchy_stress((Mat2() << 1.0 + e, 0.0, 0.0, 1.0).finished(), moduli);
    EXPECT_NEAR(stress(0, 0), (moduli.lambda + 2.0 * moduli.mu) * e, 1e-6 * moduli.mu * e * 10.0);
    EXPECT_NEAR(stress(1, 1), moduli.lambda * e, 1e-6 * moduli.mu * e * 10.0);
}

TEST(BlockElasticity, ClampedTangentHasNoNegativeEigenvalueUnderCompression) {
    const Mat2 compressed = (Mat2() << 0.95, 0.01, -0.02, 0.9).finished();
    const auto smallest = [&](bool positive) {
        return symmetric_eigenvalues(elastic_tangent(compressed, moduli, positive))[0];
    };
    EXPECT_LT(smallest(false), -1e-3 * moduli.mu);
    EXPECT_GT(smallest(true), -1e-9 * moduli.mu);
}

} // namespace
} // namespace kluft

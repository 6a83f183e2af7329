#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/reference/block_inertia.hpp"
#include "support/lattice_body.hpp"

namespace kluft {
namespace {

struct BondedHexagons {
    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.25, Plane::strain)};
    BlockSystem system = cut_blocks(hexagon_spec(0.5, 0.4, 0.1, {0.03, 0.04})).system;
    Placement placement;
    Loads loads;
    LoadedBody body;

    BondedHexagons() {
        body.system = &system;
        body.moduli = &moduli;
        body.laws = &laws;
        placement.bonds = bonds_at(system, {1}, at_rest(system));
        body.placement = &placement;
        body.loads = &loads;
    }
    [[nodiscard]] Eigen::VectorXd forces(const Eigen::VectorXd& q) const {
        BodyForces result;
        body_forces(body, q, result);
        return result.forces;
    }
};

/// The largest natural frequency by central differences of the forces and a dense eigenvalue problem.
double dense_frequency(const BondedHexagons& hexagons, const std::vector<Mat6>& masses) {
    const Eigen::VectorXd rest = at_rest(hexagons.system);
    const Eigen::Index n = rest.size();
    Eigen::MatrixXd stiffness(n, n);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
    const double h = 1e-7;
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::VectorXd dq = h * Eigen::VectorXd::Unit(n, i);
        stiffness.col(i) = (hexagons.forces(rest + dq) - hexagons.forces(rest - dq)) / (2 * h);
    }
    for (std::size_t b = 0; b < masses.size(); ++b) mass.block<6, 6>(6 * b, 6 * b) = masses[b];
    const Eigen::MatrixXd symmetric = 0.5 * (stiffness + stiffness.transpose());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric, mass, Eigen::EigenvaluesOnly);
    return std::sqrt(eigen.eigenvalues().maxCoeff());
}

Model model_of(const BondedHexagons& hexagons) {
    Model model;
    model.system = hexagons.system;
    model.moduli = hexagons.moduli;
    model.laws = hexagons.laws;
    model.densities = {2500.0};
    model.effective_modulus = 5e9;
    return model;
}

TEST(BlockInertia, FrequencyBoundLiesAboveTheLargestNaturalFrequencyAndNotFarAbove) {
    const BondedHexagons hexagons;
    for (const auto scaling : {DensityScaling::none, DensityScaling::uniform_step}) {
        const auto masses = block_masses(model_of(hexagons), scaling);
        const double bound = largest_frequency(stiffness_bounds(hexagons.body), masses);
        const double exact = dense_frequency(hexagons, masses);
        EXPECT_GE(bound, exact);
        EXPECT_LE(bound, 1.5 * exact);
    }
}

// Density times area; translation and deformation of a block are without inertia for each other about its centroid.
TEST(BlockInertia, WithoutScalingABlockHasItsOwnMass) {
    const BondedHexagons hexagons;
    const auto masses = block_masses(model_of(hexagons), DensityScaling::none);
    for (int b = 0; b < hexagons.system.n_blocks(); ++b) {
        const double mass = 2500.0 * hexagons.system.blocks[b].area;
        EXPECT_NEAR(masses[b](0, 0), mass, 1e-12 * mass);
        EXPECT_NEAR(masses[b](1, 1), mass, 1e-12 * mass);
        EXPECT_EQ((masses[b].block<2, 4>(0, 2).norm()), 0.0);
    }
}

TEST(BlockInertia, UniformStepGivesAllBlocksOneFrequencyAndKeepsTheMassOfTheBody) {
    const BondedHexagons hexagons;
    const auto masses = block_masses(model_of(hexagons), DensityScaling::uniform_step);
    const auto stiffness = stiffness_bounds(hexagons.body);
    double total = 0.0;
    const double common = largest_frequency({stiffness[0]}, {masses[0]});
    for (std::size_t b = 0; b < masses.size(); ++b) {
        EXPECT_NEAR(largest_frequency({stiffness[b]}, {masses[b]}), common, 1e-9 * common);
        total += masses[b](0, 0);
    }
    EXPECT_NEAR(total, 2500.0 * 0.5 * 0.4, 1e-9 * total);
}

TEST(BlockInertia, DampingShortensTheStableTimeStepByTheRootOfOnePlusAlpha) {
    EXPECT_DOUBLE_EQ(stable_time_step(100.0, 0.0), 0.016);
    EXPECT_DOUBLE_EQ(stable_time_step(100.0, 3.0), 0.008);
}

} // namespace
} // namespace kluft

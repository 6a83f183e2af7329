#include "kluft/constitutive/lattice_stiffness.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {
namespace {

constexpr double youngs_modulus = 10e9;
constexpr double poissons_ratio = 0.25;
constexpr double spacing = 0.03;

// E' = E/(1 - nu^2), nu' = nu/(1 - nu) in plane strain; E' = E, nu' = nu in plane stress.
double in_plane_youngs_modulus(const LatticeModuli& moduli) {
    return 4.0 * moduli.bulk_modulus * moduli.shear_modulus / (moduli.bulk_modulus + moduli.shear_modulus);
}
double in_plane_poissons_ratio(const LatticeModuli& moduli) {
    return (moduli.bulk_modulus - moduli.shear_modulus) / (moduli.bulk_modulus + moduli.shear_modulus);
}

std::string input_error_of(const auto& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(PlaneModuli, GiveHookesLawOfUniaxialStressInPlaneStress) {
    // s_xx = s, s_yy = 0: e_xx = s/E, e_yy = -nu s/E.
    const ElasticModuli moduli = plane_moduli(youngs_modulus, poissons_ratio, Plane::stress);
    const double e_xx = 1.0 / youngs_modulus;
    const double e_yy = -poissons_ratio / youngs_modulus;
    EXPECT_NEAR(2.0 * moduli.mu * e_xx + moduli.lambda * (e_xx + e_yy), 1.0, 1e-14);
    EXPECT_NEAR(2.0 * moduli.mu * e_yy + moduli.lambda * (e_xx + e_yy), 0.0, 1e-14);
}

TEST(PlaneModuli, GiveHookesLawWithoutThicknessStrainInPlaneStrain) {
    // s_zz = nu s: e_xx = (1 - nu^2) s/E, e_yy = -nu (1 + nu) s/E.
    const ElasticModuli moduli = plane_moduli(youngs_modulus, poissons_ratio, Plane::strain);
    const double e_xx = (1.0 - poissons_ratio * poissons_ratio) / youngs_modulus;
    const double e_yy = -poissons_ratio * (1.0 + poissons_ratio) / youngs_modulus;
    EXPECT_NEAR(2.0 * moduli.mu * e_xx + moduli.lambda * (e_xx + e_yy), 1.0, 1e-14);
    EXPECT_NEAR(2.0 * moduli.mu * e_yy + moduli.lambda * (e_xx + e_yy), 0.0, 1e-14);
}

TEST(PlaneModuli, AreUndoneByEngineeringModuli) {
    for (const Plane plane : {Plane::strain, Plane::stress})
        for (const double nu : {-0.5, 0.0, 0.139, 0.25, 0.49}) {
            const LatticeModuli moduli = engineering_moduli(plane_moduli(1500e6, nu, plane), plane);
            EXPECT_NEAR(moduli.youngs_modulus, 1500e6, 1e-3);
            EXPECT_NEAR(moduli.poissons_ratio, nu, 1e-14);
        }
}

TEST(PlaneModuli, RejectWhatNoMaterialHas) {
    EXPECT_THROW((void)plane_moduli(0.0, 0.25, Plane::strain), InputError);
    EXPECT_THROW((void)plane_moduli(-1.0, 0.25, Plane::strain), InputError);
    EXPECT_THROW((void)plane_moduli(std::nan(""), 0.25, Plane::strain), InputError);
    EXPECT_THROW((void)plane_moduli(1e9, 0.5, Plane::strain), InputError);
    EXPECT_THROW((void)plane_moduli(1e9, -1.0, Plane::stress), InputError);
    EXPECT_THROW((void)plane_moduli(1e9, std::nan(""), Plane::stress), InputError);
}

// 1/(2K_eff) = (1 - nu)/E + 1/(d k_n), 1/(2G_eff) = (1 + nu)/E + 2/(1.4 d k_n), by hand.
TEST(LatticeModuliFormula, MeetsTheTableInPlaneStress) {
    const ElasticModuli blocks = plane_moduli(youngs_modulus, poissons_ratio, Plane::stress);
    const LatticeModuli moduli =
        lattice_moduli(blocks, {.normal = 1e11, .shear = 0.4e11}, hexagon_net(spacing), Plane::stress);
    EXPECT_NEAR(moduli.youngs_modulus, 1.98113e9, 5e3);
    EXPECT_NEAR(moduli.poissons_ratio, 0.19104, 5e-6);
    EXPECT_NEAR(moduli.shear_modulus, 0.83168e9, 5e3);
}

TEST(LatticeModuliFormula, MeetsTheTableInPlaneStrain) {
    const ElasticModuli blocks = plane_moduli(youngs_modulus, poissons_ratio, Plane::strain);
    const LatticeModuli moduli =
        lattice_moduli(blocks, {.normal = 1e12, .shear = 0.4e12}, hexagon_net(spacing), Plane::strain);
    EXPECT_NEAR(in_plane_youngs_modulus(moduli), 7.45011e9, 5e3);
    EXPECT_NEAR(in_plane_poissons_ratio(moduli), 0.28603, 5e-6);
    EXPECT_NEAR(moduli.shear_modulus, 2.89655e9, 5e3);
}

TEST(LatticeModuliFormula, GivesTheModuliOfTheReferenceSet) {
    // E 1500 MPa, nu 0.25 with k_n d = 200 MPa, k_s = k_n/2 is a body of E 152 MPa and nu 0.139 in plane strain.
    const ElasticModuli blocks = plane_moduli(1500e6, 0.25, Plane::strain);
    const LatticeModuli moduli =
        lattice_moduli(blocks, {.normal = 4000e6, .shear = 2000e6}, hexagon_net(0.05), Plane::strain);
    EXPECT_NEAR(moduli.youngs_modulus, 152e6, 0.5e6);
    EXPECT_NEAR(moduli.poissons_ratio, 0.139, 5e-4);
}

TEST(LatticeModuliFormula, AddsTheEnergyOfTheFacesOfAHexagonToThatOfTheBlock) {
    // Uniaxial stress s at angle a to a face normal loads the face by t_n = s (1/2 + cos 2a/(1+r)) and
    // t_s = s sin 2a r/(1+r). A cell of area sqrt(3)/2 d^2 owns three faces of length d/sqrt(3). Equal work:
    // s^2/E'_eff = s^2/E'_block + sum of length (t_n^2/k_n + t_s^2/k_s)/area.
    const double k_n = 2e11;
    const double r = 0.4;
    const ElasticModuli blocks = plane_moduli(youngs_modulus, poissons_ratio, Plane::stress);
    const LatticeModuli moduli =
        lattice_moduli(blocks, {.normal = k_n, .shear = r * k_n}, hexagon_net(spacing), Plane::stress);
    const double area = std::numbers::sqrt3 / 2.0 * spacing * spacing;
    for (const double direction : {0.0, 0.3, std::numbers::pi / 6.0}) {
        double compliance = 1.0 / youngs_modulus;
        for (int face = 0; face < 3; ++face) {
            const double a = direction + face * std::numbers::pi / 3.0;
            const double t_n = 0.5 + std::cos(2.0 * a) / (1.0 + r);
            const double t_s = std::sin(2.0 * a) * r / (1.0 + r);
            compliance += spacing / std::numbers::sqrt3 * (t_n * t_n / k_n + t_s * t_s / (r * k_n)) / area;
        }
        EXPECT_NEAR(compliance * moduli.youngs_modulus, 1.0, 1e-12) << "direction " << direction;
    }
    // The same sum in closed form: (3 + r)/(2 d k_n (1 + r)).
    EXPECT_NEAR(1.0 / moduli.youngs_modulus, 1.0 / youngs_modulus + (3.0 + r) / (2.0 * spacing * k_n * (1.0 + r)),
                1e-12 / youngs_modulus);
}

TEST(LatticeModuliFormula, ApproachesTheBlocksForStiffInterfaces) {
    const ElasticModuli blocks = plane_moduli(youngs_modulus, poissons_ratio, Plane::strain);
    const LatticeModuli moduli =
        lattice_moduli(blocks, {.normal = 1e20, .shear = 1e20}, hexagon_net(spacing), Plane::strain);
    EXPECT_NEAR(moduli.youngs_modulus / youngs_modulus, 1.0, 1e-7);
    EXPECT_NEAR(moduli.poissons_ratio, poissons_ratio, 1e-7);
}

TEST(BlockModuli, MakeTheTessellatedBodyAsStiffAsTheRock) {
    for (const Plane plane : {Plane::strain, Plane::stress})
        for (const double nu : {0.0, 0.1, 0.25, 0.35})
            for (const double ratio : {5.0, 10.0, 20.0})
                for (const double shear_ratio : {0.2, 0.5, 1.0}) {
                    const ElasticModuli blocks = block_moduli(5e9, nu, plane, ratio, shear_ratio, hexagon_net(0.05));
                    const double k_n = ratio * 5e9 / spacing;
                    const LatticeModuli body = lattice_moduli(blocks, {.normal = k_n, .shear = shear_ratio * k_n},
                                                              hexagon_net(spacing), plane);
                    EXPECT_NEAR(body.youngs_modulus / 5e9, 1.0, 1e-12);
                    EXPECT_NEAR(body.poissons_ratio, nu, 1e-12);
                }
}

TEST(BlockModuli, NameTheSmallestAdmissibleRatio) {
    // Plane strain, nu 0.25: 2K/E = 1/((1+nu)(1-2nu)) = 1.6; 2*2G/(E(1+r)) = 2/(1.25*1.5) = 1.0667.
    EXPECT_NEAR(smallest_stiffness_ratio(0.25, Plane::strain, 0.5, hexagon_net(0.05)), 1.6, 1e-14);
    // Plane stress, nu 0: 2K/E = 1; with r = 0: 4G/E = 2 governs.
    EXPECT_NEAR(smallest_stiffness_ratio(0.0, Plane::stress, 0.0, hexagon_net(0.05)), 2.0, 1e-14);
    const auto too_soft = [] { (void)block_moduli(5e9, 0.25, Plane::strain, 1.5, 0.5, hexagon_net(0.05)); };
    EXPECT_THAT(input_error_of(too_soft), testing::HasSubstr("smallest admissible ratio is 1.6001"));
    EXPECT_NO_THROW((void)block_moduli(5e9, 0.25, Plane::strain, 1.6001, 0.5, hexagon_net(0.05)));
    EXPECT_THROW((void)block_moduli(5e9, 0.25, Plane::strain, std::nan(""), 0.5, hexagon_net(0.05)), InputError);
}

// The body of rigid blocks has the moduli of the body of elastic ones: both by the formula of the lattice.
TEST(ComplianceOfBlocks, InTheInterfacesOfRigidBlocksLeavesTheBodyAsStiffAsIt) {
    for (const Plane plane : {Plane::strain, Plane::stress})
        for (const double nu : {0.0, 0.1, 0.2})
            for (const double k_n : {1e8, 1e11, 1e14})
                for (const double shear_ratio : {0.2, 1.0, 3.0}) {
                    const ElasticModuli blocks = plane_moduli(10e9, nu, plane);
                    const InterfaceStiffness interfaces{.normal = k_n, .shear = shear_ratio * k_n};
                    const auto elastic = lattice_moduli(blocks, interfaces, hexagon_net(spacing), plane);
                    const auto rigid =
                        rigid_lattice_moduli(with_compliance_of_blocks(interfaces, blocks, plane, hexagon_net(spacing)),
                                             hexagon_net(spacing), plane);
                    EXPECT_NEAR(rigid.youngs_modulus / elastic.youngs_modulus, 1.0, 1e-13);
                    EXPECT_NEAR(rigid.poissons_ratio, elastic.poissons_ratio, 1e-13);
                }
}

// E 1500 MPa, nu 0.25 in plane strain: 2K = 2400, 4G = 2400 MPa. 1/k_n' d = 1/200 + 1/2400, 1/(k_n' + k_s') d = 1/300 +
// 1/2400 per MPa.
TEST(ComplianceOfBlocks, OfTheReferenceSetByHand) {
    const auto taken =
        with_compliance_of_blocks({.normal = 200e6 / spacing, .shear = 100e6 / spacing},
                                  plane_moduli(1500e6, 0.25, Plane::strain), Plane::strain, hexagon_net(spacing));
    EXPECT_NEAR(taken.normal * spacing, 2400e6 / 13.0, 1.0);
    EXPECT_NEAR(taken.shear * spacing, 2400e6 / 9.0 - 2400e6 / 13.0, 1.0);
}

// k_s' = 0 at nu = 1/4 and 1/3 where the interfaces are very stiff, later for softer ones.
TEST(ComplianceOfBlocks, NamesTheLargestAdmissiblePoissonsRatio) {
    const InterfaceStiffness stiff{.normal = 1e24, .shear = 1e24};
    EXPECT_NEAR(largest_poissons_ratio(stiff, 10e9, Plane::strain, spacing), 0.25, 1e-9);
    EXPECT_NEAR(largest_poissons_ratio(stiff, 10e9, Plane::stress, spacing), 1.0 / 3.0, 1e-9);
    const InterfaceStiffness interfaces{.normal = 1e13, .shear = 0.4e13};
    for (const Plane plane : {Plane::strain, Plane::stress}) {
        const double largest = largest_poissons_ratio(interfaces, 10e9, plane, spacing);
        const auto below = with_compliance_of_blocks(interfaces, plane_moduli(10e9, largest - 1e-4, plane), plane,
                                                     hexagon_net(spacing));
        EXPECT_GT(below.shear, 0.0);
        EXPECT_LT(below.shear, 1e-3 * below.normal);
        const auto too_large = [&] {
            (void)with_compliance_of_blocks(interfaces, plane_moduli(10e9, largest + 1e-4, plane), plane,
                                            hexagon_net(spacing));
        };
        EXPECT_THAT(input_error_of(too_large),
                    testing::HasSubstr(plane == Plane::strain ? "one is 0.2537" : "one is 0.3396"));
    }
}

TEST(ResolveStiffness, TakesPascalPerMetreAsTheyAre) {
    InterfaceType type{.name = "joint"};
    type.normal_stiffness = 4e9;
    type.shear_stiffness = 1e9;
    const InterfaceStiffness stiffness = resolve_stiffness(type, {.spacing = 0.0}, 0.0);
    EXPECT_EQ(stiffness.normal, 4e9);
    EXPECT_EQ(stiffness.shear, 1e9);
    EXPECT_FALSE(stiffness_from_ratio(type));
}

TEST(ResolveStiffness, DividesStiffnessTimesSpacingByTheSpacing) {
    InterfaceType type{.name = "joint"};
    type.normal_stiffness_times_spacing = 200e6;
    type.shear_stiffness_times_spacing = 50e6;
    const InterfaceStiffness stiffness = resolve_stiffness(type, {.spacing = 0.05}, 0.0);
    EXPECT_DOUBLE_EQ(stiffness.normal, 4000e6);
    EXPECT_DOUBLE_EQ(stiffness.shear, 1000e6);
    EXPECT_FALSE(stiffness_from_ratio(type));
}

TEST(ResolveStiffness, ScalesWithTheRockByDefault) {
    const InterfaceType type{.name = "bond"};
    const InterfaceStiffness stiffness = resolve_stiffness(type, {.spacing = 0.05}, 1e9);
    EXPECT_DOUBLE_EQ(stiffness.normal, 10.0 * 1e9 / 0.05);
    EXPECT_DOUBLE_EQ(stiffness.shear, 0.5 * stiffness.normal);
    EXPECT_TRUE(stiffness_from_ratio(type));
}

TEST(ResolveStiffness, AppliesTheShearRatioToEveryWay) {
    InterfaceType type{.name = "joint"};
    type.normal_stiffness = 4e9;
    type.shear_ratio = 0.25;
    EXPECT_DOUBLE_EQ(resolve_stiffness(type, {.spacing = 0.0}, 0.0).shear, 1e9);
    type.shear_ratio.reset();
    EXPECT_DOUBLE_EQ(resolve_stiffness(type, {.spacing = 0.0}, 0.0).shear, 2e9);
}

TEST(ResolveStiffness, RejectsWhatIsMissingOrContradictory) {
    const auto error = [](InterfaceType type, double d, double youngs) {
        type.name = "joint";
        return input_error_of([&] { (void)resolve_stiffness(type, {.spacing = d}, youngs); });
    };
    EXPECT_THAT(error({.stiffness_ratio = 10.0}, 0.0, 1e9), testing::HasSubstr("reference_spacing"));
    EXPECT_THAT(error({.stiffness_ratio = 10.0}, 0.05, 0.0), testing::HasSubstr("youngs_modulus"));
    EXPECT_THAT(error({.normal_stiffness_times_spacing = 1e6}, 0.0, 1e9), testing::HasSubstr("interfaces.joint"));
    EXPECT_THAT(error({.normal_stiffness = 1e9, .stiffness_ratio = 10.0}, 0.05, 1e9), testing::HasSubstr("several"));
    EXPECT_THAT(error({.shear_stiffness = 1e9}, 0.05, 1e9), testing::HasSubstr("needs normal_stiffness"));
    EXPECT_THAT(error({.normal_stiffness = 1e9, .shear_stiffness = 1e9, .shear_ratio = 0.5}, 0.05, 1e9),
                testing::HasSubstr("found both"));
    EXPECT_THAT(error({.normal_stiffness = 0.0}, 0.05, 1e9), testing::HasSubstr("> 0"));
    EXPECT_THAT(error({.normal_stiffness = 1e9, .shear_stiffness = -1.0}, 0.05, 1e9), testing::HasSubstr(">= 0"));
}

// Nets of triangles.

TEST(TriangleModuliFormula, HasTheMeasuredModuliOfTheLiterature) {
    // Equilateral triangles of 0.7 m between interfaces of 300 and 150 GPa/m, E 15 GPa, nu 0.25: by hand
    // 1/(2 K) = 1.25 x 0.5/15 = 4.16667e-11, Lambda = 4.94872/m, Lambda/(2 k_n) = 8.24786e-12;
    // 1/(2 G) = 1.25/15 = 8.33333e-11, Lambda/4 (1/k_n + 1/k_s) = 1.23718e-11.
    const LatticeModuli moduli = lattice_moduli(plane_moduli(15e9, 0.25, Plane::strain),
                                                {.normal = 3e11, .shear = 1.5e11}, equilateral_net(0.7), Plane::strain);
    EXPECT_NEAR(1.0 / (2.0 * moduli.bulk_modulus), 4.16667e-11 + 8.24786e-12, 1e-16);
    EXPECT_NEAR(1.0 / (2.0 * moduli.shear_modulus), 8.33333e-11 + 1.23718e-11, 1e-16);
}

TEST(TriangleModuliFormula, IsInvertedByTheModuliOfTheBlocksAndByRigidOnes) {
    for (const Plane plane : {Plane::strain, Plane::stress}) {
        for (const double nu : {0.0, 0.25, 0.4}) {
            const Net net = triangle_net_of(0.5, 6.6);
            const double ratio = 1.01 * smallest_stiffness_ratio(nu, plane, 0.5, net);
            const double k_n = ratio * 20e9 / 0.5;
            const InterfaceStiffness interfaces{.normal = k_n, .shear = 0.5 * k_n};
            const ElasticModuli blocks = block_moduli(20e9, nu, plane, ratio, 0.5, net);
            EXPECT_GT(blocks.mu, 0.0);
            const LatticeModuli affine = lattice_moduli(blocks, interfaces, net, plane);
            const LatticeModuli rigid =
                rigid_lattice_moduli(with_compliance_of_blocks(interfaces, blocks, plane, net), net, plane);
            const LatticeModuli rock = rigid_lattice_moduli(rigid_lattice_stiffness(20e9, nu, plane, net), net, plane);
            for (const LatticeModuli& body : {affine, rigid, rock}) {
                EXPECT_NEAR(body.youngs_modulus, 20e9, 1e-3);
                EXPECT_NEAR(body.poissons_ratio, nu, 1e-12);
            }
            EXPECT_THROW((void)block_moduli(20e9, nu, plane, ratio / 1.02, 0.5, net), InputError);
        }
    }
    EXPECT_NEAR(smallest_stiffness_ratio(0.25, Plane::strain, 0.5, equilateral_net(0.3)), 1.6 * std::sqrt(3.0), 1e-12);
    EXPECT_THROW((void)block_moduli(20e9, 0.25, Plane::strain, 10.0, 0.0, equilateral_net(0.3)), InputError);
    EXPECT_THROW((void)rigid_lattice_stiffness(20e9, -0.4, Plane::stress, equilateral_net(0.3)), InputError);
}

TEST(ResolveStiffness, DefaultRatioIsThatOfTheKindOfNet) {
    const InterfaceType type{};
    EXPECT_DOUBLE_EQ(resolve_stiffness(type, hexagon_net(0.5), 1e9).normal, 10.0 * 1e9 / 0.5);
    EXPECT_DOUBLE_EQ(resolve_stiffness(type, equilateral_net(0.5), 1e9).normal, 30.0 * 1e9 / 0.5);
}

} // namespace
} // namespace kluft

// The elastic stage: derivatives by keys of a scene, and E and nu recovered from stiffnesses a factor of ten off.
#include "kluft/calibration/elastic_scene.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include <gtest/gtest.h>

#include "calibration/calibration_scenes.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using namespace kluft::testing;

const std::string elastic_targets = "targets:\n"
                                    "  youngs_modulus: {value: 10 GPa, tolerance: 0.1 %}\n"
                                    "  poissons_ratio: {value: 0.25, tolerance: 0.1 %}\n";

/// k_n and k_s of the net from starts (Pa/m).
std::string stiffnesses(double normal, double shear) {
    return "parameters:\n  kn: {keys: [interfaces.bond.normal_stiffness], start: " + std::to_string(normal) +
           ", from: 1 GPa/m, to: 900 TPa/m}\n  ks: {keys: [interfaces.bond.shear_stiffness], start: " +
           std::to_string(shear) + ", from: 1 GPa/m, to: 900 TPa/m}\n";
}

class ElasticStage : public ::testing::Test {
protected:
    Calibration calibration(const std::string& scene, const std::string& parameters) const {
        write_text(directory_ / "scene.yaml", scene);
        return read_calibration_text("kluft_calibration: 1\nscene: scene.yaml\n" + parameters + elastic_targets,
                                     directory_ / "target.yaml");
    }

    static ElasticFit fit(const Calibration& calibration) {
        ElasticTargets targets(calibration, start_of(calibration));
        return fit_elastic(calibration, targets, start_of(calibration));
    }

    TemporaryDirectory directory_;
};

// The interfaces that give hexagons with these blocks E 10 GPa and nu 0.25, from (20) of docs/theory.md:
// d k_n = 1/(1/(2 K_eff) - 1/(2 K)), d (k_n + k_s) = 2/(1/(2 G_eff) - 1/(2 G)). The border of the specimen costs some
// per cent of k_n.
TEST_F(ElasticStage, RecoversTheModuliOfHexagonsFromAFactorOfTenOff) {
    const ElasticModuli blocks = plane_moduli(15e9, 0.25, Plane::strain);
    const ElasticModuli rock = plane_moduli(10e9, 0.25, Plane::strain);
    const double normal = 1.0 / (0.5 / (rock.lambda + rock.mu) - 0.5 / (blocks.lambda + blocks.mu)) / 0.01;
    for (const double off : {0.1, 10.0}) {
        const Calibration wanted =
            calibration(specimen("hexagons: {spacing: 0.01}"), stiffnesses(off * normal, off * normal / 2));
        const ElasticFit found = fit(wanted);
        const auto values = ElasticTargets(wanted, found.x).values_at(found.x);
        ASSERT_TRUE(values);
        EXPECT_NEAR(values->values[0] / 10e9, 1.0, 1e-6) << off;
        EXPECT_NEAR(values->values[1] / 0.25, 1.0, 1e-6) << off;
        EXPECT_LT(found.evaluations, 20) << off;
        EXPECT_NEAR(std::exp(found.x[0]) / normal, 1.0, 0.03) << off;
        EXPECT_TRUE(found.is_determined);
    }
}

TEST_F(ElasticStage, RecoversTheModuliOfAnyNetAndOfFracturedBodies) {
    for (const std::string& scene :
         {specimen(jittered_hexagons), specimen(voronoi), specimen(voronoi, two_fractures), specimen(triangles),
          specimen(triangles, two_fractures), specimen(hexagons, two_fractures, "stress")}) {
        for (const double start : {200e9, 20e12}) {
            const Calibration wanted = calibration(scene, stiffnesses(start, 0.1 * start));
            const ElasticFit found = fit(wanted);
            ElasticTargets targets(wanted, found.x);
            EXPECT_EQ(targets.have_fractures(), scene.find(two_fractures) != std::string::npos) << scene;
            const auto values = targets.values_at(found.x);
            ASSERT_TRUE(values);
            EXPECT_NEAR(values->values[0] / 10e9, 1.0, 1e-6) << start << scene;
            EXPECT_NEAR(values->values[1] / 0.25, 1.0, 1e-6) << start << scene;
            EXPECT_LT(found.evaluations, 20) << start << scene;
        }
    }
}

/// Largest error of the derivatives of E and nu by x against central differences of order 4, relative to E and nu.
double largest_error(const Calibration& calibration) {
    const Eigen::VectorXd x = start_of(calibration);
    ElasticTargets targets(calibration, x);
    const auto exact = targets.values_at(x);
    double largest = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        constexpr double step = 2e-3; // another one than that of the chain from the keys
        const auto moved = [&](double steps) {
            Eigen::VectorXd beside = x;
            beside[i] += steps * step;
            return targets.values_at(beside)->values;
        };
        const Eigen::VectorXd difference = (8.0 * (moved(1) - moved(-1)) - (moved(2) - moved(-2))) / (12.0 * step);
        largest =
            std::max(largest, ((difference - exact->jacobian.col(i)).array() / exact->values.array()).abs().maxCoeff());
    }
    return largest;
}

// Through every way to give stiffnesses: build_model resolves them, with the moduli of the blocks where E and nu are the
// rock's.
TEST_F(ElasticStage, DerivativesByKeysOfTheSceneAreThoseOfDifferences) {
    std::string by_ratio = specimen(hexagons, two_fractures);
    const std::string given = "normal_stiffness: 3 TPa/m, shear_stiffness: 1.5 TPa/m";
    by_ratio.replace(by_ratio.find(given), given.size(), "stiffness_ratio: 8, shear_ratio: 0.6");
    EXPECT_LT(largest_error(calibration(
                  by_ratio, "parameters:\n"
                            "  r: {keys: [interfaces.bond.stiffness_ratio], start: 8, from: 4, to: 20}\n"
                            "  s: {keys: [interfaces.bond.shear_ratio], start: 0.6, from: 0.1, to: 1}\n"
                            "  E: {keys: [materials.rock.youngs_modulus], start: 12 GPa, from: 1 GPa, to: 90 GPa}\n"
                            "  nu: {keys: [materials.rock.poissons_ratio], start: 0.2, from: 0.1, to: 0.3}\n"
                            "  j: {keys: [interfaces.joint.normal_stiffness], start: 1 TPa/m, from: 0.1 TPa/m, to: 9 "
                            "TPa/m}\n")),
              1e-7);
    EXPECT_LT(largest_error(calibration(specimen(voronoi, two_fractures, "stress"), stiffnesses(2e12, 1e12))), 1e-7);
}

TEST_F(ElasticStage, TakesTheNearestOfManySolutions) {
    const Calibration wanted = calibration(
        specimen(hexagons), stiffnesses(2e12, 1e12) +
                                "  E: {keys: [materials.rock.youngs_modulus], start: 15 GPa, from: 1 GPa, to: 90 GPa}\n"
                                "  c: {keys: [materials.rock.cohesion], start: 5 MPa, from: 1 MPa, to: 9 MPa}\n");
    const ElasticFit found = fit(wanted);
    EXPECT_FALSE(found.is_determined); // three stiffnesses, two targets
    EXPECT_EQ(found.influences, (std::vector<char>{1, 1, 1, 0}));
    EXPECT_EQ(found.x[3], start_of(wanted)[3]);
    // At the nearest one the step from the start has no part that E and nu do not feel.
    ElasticTargets targets(wanted, found.x);
    const Eigen::MatrixXd jacobian = targets.residuals_at(found.x)->jacobian.leftCols(3);
    const Eigen::VectorXd step = (found.x - start_of(wanted)).head(3);
    const Eigen::VectorXd felt = jacobian.transpose() * (jacobian * jacobian.transpose()).ldlt().solve(jacobian * step);
    EXPECT_LT((step - felt).norm(), 2e-2 * step.norm());
}

} // namespace
} // namespace kluft

// E and nu of a body: the closed form of the lattice, the run of the same body, derivatives against differences.
#include "kluft/calibration/elastic_body.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibration/calibration_scenes.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using namespace kluft::testing;

Model model_of(const std::string& scene, const std::vector<std::string>& overrides = {}) {
    return build_scene_model(read_scene_text(scene, overrides)).model;
}

ElasticResponse response_of(const Model& model) { return ElasticBody(model).response(elastic_properties(model)); }

/// Central differences of order 4 with a relative step; the largest error of the gradients, relative to E and nu per unit
/// of the logarithm of a property.
double largest_gradient_error(const Model& model) {
    ElasticBody body(model);
    const Eigen::VectorXd properties = elastic_properties(model);
    const ElasticResponse exact = body.response(properties);
    double largest = 0.0;
    for (Eigen::Index i = 0; i < properties.size(); ++i) {
        const auto moved = [&](double steps) {
            Eigen::VectorXd beside = properties;
            beside[i] *= 1.0 + 1e-3 * steps;
            return body.response(beside);
        };
        const auto p2 = moved(2), p1 = moved(1), m1 = moved(-1), m2 = moved(-2);
        const auto difference = [&](double ElasticResponse::*value) {
            return (8.0 * (p1.*value - m1.*value) - (p2.*value - m2.*value)) / (12.0 * 1e-3);
        };
        largest = std::max(largest, std::abs(difference(&ElasticResponse::youngs_modulus) -
                                             properties[i] * exact.modulus_gradient[i]) /
                                        exact.youngs_modulus);
        largest = std::max(
            largest, std::abs(difference(&ElasticResponse::poissons_ratio) - properties[i] * exact.ratio_gradient[i]) /
                         exact.poissons_ratio);
    }
    return largest;
}

// A net without a border would have them exactly; halves of hexagons at the outline are not those of a lattice.
TEST(ElasticBody, HexagonsHaveTheModuliOfTheLattice) {
    for (const std::string plane : {"strain", "stress"}) {
        const Model model = model_of(specimen("hexagons: {spacing: 0.01}", "", plane));
        const auto lattice =
            lattice_moduli(model.moduli[0], {.normal = 3e12, .shear = 1.5e12}, hexagon_net(0.01), model.plane);
        const ElasticResponse found = response_of(model);
        EXPECT_NEAR(found.youngs_modulus / lattice.youngs_modulus, 1.0, 2e-3) << plane;
        EXPECT_NEAR(found.poissons_ratio, lattice.poissons_ratio, 2e-3) << plane;
    }
}

TEST(ElasticBody, AgreesWithARunOfTheSameBodyAtSmallStrain) {
    for (const std::string& net : {hexagons, jittered_hexagons, voronoi, triangles}) {
        const std::string scene = specimen(net, two_fractures);
        // Little strain, and so much friction that nothing slides.
        const SceneRun run =
            run_scene(scene, {"stages.1.strain.value=1e-7", "stages.1.steps=4", "interfaces.joint.friction_angle=89.9",
                              "solver.tolerance=1e-10", "interfaces.joint.contact_rounding=1e-6",
                              "stages.0.pressure.left=100 Pa", "stages.0.pressure.right=100 Pa"});
        const CurveNumbers numbers =
            curve_numbers(run.equilibria, run.history, 1, Plane::strain, run.model.compliance_across.value_or(0.0));
        const ElasticResponse found = response_of(run.model);
        ASSERT_TRUE(numbers.youngs_modulus) << net;
        EXPECT_NEAR(found.youngs_modulus / *numbers.youngs_modulus, 1.0, 1e-4) << net;
        EXPECT_NEAR(found.poissons_ratio, *numbers.poissons_ratio, 1e-4) << net;
    }
}

// A joint at an angle b to the platens, from side to side, carries sigma cos^2 b across and sigma sin b cos b along itself. It moves what
// lies above it down by u = sigma cos b (cos^2 b/k_n + sin^2 b/k_s) and aside by w = sigma sin b cos^2 b (1/k_s - 1/k_n), and the mean
// places of the sides apart by the share tan b W/H of w. Over the length H and the width W that adds to 1/E and nu/E of the rock.
TEST(ElasticBody, OneJointFromSideToSideAddsItsOwnComplianceInEitherPlane) {
    for (const double angle : {30.0, 50.0, 60.0}) {
        const double b = angle * std::numbers::pi / 180.0, c = std::cos(b), s = std::sin(b), rise = std::tan(b);
        const double axial = 1.0 / 10e9 + c * (c * c / 100e9 + s * s / 10e9) / 0.2;
        const double lateral = 0.25 / 10e9 + s * c * c * (1.0 / 10e9 - 1.0 / 100e9) / 0.1 * (rise * 0.1 / 0.2);
        for (const std::string plane : {"strain", "stress"}) {
            const SceneRun run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: {}}}
materials:
  rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 30, cohesion: 5 MPa}}
geometry:
  domain: {{rectangle: {{width: 0.1, height: 0.2}}}}
  fractures: [{{trace: [[-0.05, {}], [0.15, {}]], interface: joint}}]
boundaries:
  bottom: {{support: pinned}}
stages: [{{name: axial, strain: {{boundary: top, value: 0.001 %}}, steps: 4}}]
)",
                                                       plane, 0.1 - 0.1 * rise, 0.1 + 0.1 * rise));
            const CurveNumbers numbers =
                curve_numbers(run.equilibria, run.history, 0, run.model.plane, run.model.compliance_across.value());
            const ElasticResponse found = response_of(run.model);
            EXPECT_NEAR(found.youngs_modulus * axial, 1.0, 1e-6) << plane << angle;
            EXPECT_NEAR(found.poissons_ratio, lateral / axial, 1e-6) << plane << angle;
            EXPECT_NEAR(numbers.youngs_modulus.value_or(0.0) * axial, 1.0, 1e-3) << plane << angle;
            if (lateral > 0.5 * axial) // no rock has this ratio
                EXPECT_FALSE(numbers.poissons_ratio) << plane << angle;
            else
                EXPECT_NEAR(numbers.poissons_ratio.value_or(0.0), lateral / axial, 1e-3) << plane << angle;
        }
    }
}

TEST(ElasticBody, DerivativesAreThoseOfDifferences) {
    EXPECT_LT(largest_gradient_error(model_of(specimen(hexagons))), 1e-8);
    EXPECT_LT(largest_gradient_error(model_of(specimen(voronoi))), 1e-8);
    EXPECT_LT(largest_gradient_error(model_of(specimen(triangles, two_fractures))), 1e-8);
    EXPECT_LT(largest_gradient_error(model_of(specimen(jittered_hexagons, two_fractures))), 1e-8);
    EXPECT_LT(largest_gradient_error(model_of(specimen(hexagons, two_fractures, "stress"))), 1e-8);
    EXPECT_LT(largest_gradient_error(model_of(specimen(hexagons, two_fractures),
                                              {"analysis.kinematics=rigid", "materials.rock.poissons_ratio=0.2"})),
              1e-8);
}

TEST(ElasticBody, BodyWithoutSidesIsRefused) {
    Model model = model_of(specimen(hexagons));
    for (Boundary& boundary : model.system.boundaries)
        if (boundary.name == "left") boundary.edges.clear();
    EXPECT_THROW(ElasticBody{model}, InputError);
}

} // namespace
} // namespace kluft

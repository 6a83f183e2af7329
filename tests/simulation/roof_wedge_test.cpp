// A wedge in a roof between a fixed abutment and one that a given force pushes: a closed form that does not know how large
// the abutments are, or what else there is.
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

constexpr double height = 4.0;
constexpr double half_top = 1.5;
constexpr double unit_weight = 27e3;       // N/m3
constexpr double horizontal = 0.3e6 * 4.0; // force H on the abutment (N/m)
constexpr double inclination = 20.0 * std::numbers::pi / 180.0;
const double half_base = half_top + height * std::tan(inclination);

struct Joint {
    double friction_angle; // degrees
    double cohesion;       // Pa
};

/// The largest weight that the two faces carry with strengths divided by F: N cos a + S sin a = H on either face, whatever
/// the stiffness of rock and joints, S = (N tan(phi) + c L)/F.
double carried(const Joint& joint, double factor) {
    const double face = height / std::cos(inclination);
    const double mu = std::tan(joint.friction_angle * std::numbers::pi / 180.0) / factor;
    const double c = joint.cohesion / factor;
    const double sine = std::sin(inclination);
    const double cosine = std::cos(inclination);
    const double normal = (horizontal - c * face * sine) / (cosine + mu * sine);
    return 2.0 * (normal * (mu * cosine - sine) + c * face * cosine);
}

double closed_form(const Joint& joint) {
    const double weight = unit_weight * (half_top + half_base) * height;
    double low = 0.1;
    double high = 10.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (carried(joint, middle) > weight ? low : high) = middle;
    }
    return low;
}

/// `ratio`: size of the abutments over the wedge's height. The right one slides between smooth guides. Beside them stands a
/// free block of `neighbour` times that height, which touches nothing but its base; 0: none.
std::string roof_wedge(const Joint& joint, double ratio, double neighbour) {
    const double size = height * ratio;
    const std::string beyond = // of a corner of the wedge, mirrored for the left abutment
        ratio > 1.0 ? fmt::format("[S{1}, 0], [S{1}, {0}], [S4.5, {0}], [S4.5, 6]", size, half_top + size)
                    : fmt::format("[S{1}, 0], [S{1}, {0}]", size, half_top + size);
    const auto side = [&](const char* sign) {
        std::string text = beyond;
        for (std::size_t at = text.find('S'); at != std::string::npos; at = text.find('S')) text.replace(at, 1, sign);
        return text;
    };
    const double width = height * neighbour;
    const double at = half_top + 2.0 * size;
    const std::string beside =
        neighbour == 0.0
            ? ""
            : fmt::format("    - {{name: base, polygon: [[{0}, -4], [{1}, -4], [{1}, 0], [{0}, 0]], support: fixed}}\n"
                          "    - {{name: neighbour, polygon: [[{0}, 0], [{1}, 0], [{1}, {2}], [{0}, {2}]]}}",
                          at, at + width, width);
    return fmt::format(R"(
kluft: 1
analysis: {{plane: strain, gravity: 10}}
materials: {{rock: {{youngs_modulus: 50 GPa, poissons_ratio: 0.25, density: 2700}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 2e10, shear_stiffness: 1e10, friction_angle: {0}, cohesion: {1}}}}}
geometry:
  blocks:
    - {{name: wedge, polygon: [[-{2}, 0], [{2}, 0], [1.5, 4], [-1.5, 4]]}}
    - {{name: left, polygon: [[-{2}, 0], {3}, [-1.5, 4]], support: fixed}}
    - {{name: right, polygon: [[{2}, 0], {4}, [1.5, 4]]}}
{6}
boundaries:
  floor: {{block: right, sides: [0], support: smooth}}
  roof: {{block: right, sides: [2], support: smooth}}
  push: {{block: right, sides: [1]}}
stages:
  - {{pressure: {{push: {5}}}}}
  - {{strength_reduction: {{from: 1, to: 2}}, steps: 10}}
)",
                       joint.friction_angle, joint.cohesion, half_base, side("-"), side(""), horizontal / size, beside);
}

class RoofWedge : public testing::TestWithParam<std::tuple<Joint, double, double>> {};

TEST_P(RoofWedge, HasTheSameFactorBesideBlocksOfAnySize) {
    const auto& [joint, ratio, neighbour] = GetParam();
    const SceneRun run = run_scene(roof_wedge(joint, ratio, neighbour));
    ASSERT_TRUE(run.report.results.factor_of_safety.has_value()) << run.report.diagnosis;
    EXPECT_NEAR(*run.report.results.factor_of_safety, closed_form(joint), 1e-3 * closed_form(joint));
}

INSTANTIATE_TEST_SUITE_P(SlowStrengths, RoofWedge,
                         testing::Values(std::tuple(Joint{40, 0}, 1.0, 0.0), std::tuple(Joint{40, 0}, 1000.0, 0.0),
                                         std::tuple(Joint{40, 0}, 1.0, 1000.0), std::tuple(Joint{30, 40e3}, 100.0, 0.0),
                                         std::tuple(Joint{20, 90e3}, 1000.0, 0.0),
                                         std::tuple(Joint{10, 125e3}, 1000.0, 0.0),
                                         std::tuple(Joint{0, 165e3}, 1.0, 1000.0),
                                         std::tuple(Joint{0, 165e3}, 1000.0, 0.0)),
                         [](const auto& info) { return fmt::format("case_{}", info.index); });

} // namespace
} // namespace kluft

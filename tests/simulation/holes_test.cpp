// Bodies with holes whose walls are boundaries.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string plate = R"(kluft: 1
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.25, cohesion: 100 MPa, friction_angle: 30, tensile_strength: 100 MPa}}
interfaces:
  bond: {kind: potential_crack, fails_to: crack}
  crack: {kind: fracture, friction_angle: 30}
geometry:
  domain: {rectangle: {width: 2, height: 2}, holes: [{polygon: [[0.7, 0.8], [1.2, 0.7], [1.3, 1.2], [0.9, 1.3]]}]}
  tessellation: {triangles: {spacing: 0.3}, interface: bond}
boundaries: {wall: {hole: 0}}
stages: [{pressure: {left: 1 MPa, right: 1 MPa, bottom: 1 MPa, top: 1 MPa, wall: 1 MPa}}]
)";

// The same pressure on the outline and on the wall: -p in all directions, as in a body without a hole. That is the mean over the
// rock of any stress in equilibrium with it (the integral of x times the traction along all sides, Gauss); single blocks differ, since
// the gaps of an irregular net under it do not close, by no more than these gaps have of the deformation, E/(k_n d) = 1/30.
TEST(Holes, UnderOnePressureAllAroundAndInsideTheStressIsThatPressure) {
    const SceneRun run = run_scene(read_scene_text(plate));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    Mat2 mean = Mat2::Zero();
    double area = 0.0;
    const std::vector<Block>& blocks = run.model.system.blocks;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const Mat2& stress = run.fields.back().stress[b];
        EXPECT_LT((stress + 1e6 * Mat2::Identity()).norm(), 1e6 / 30.0) << stress;
        mean += blocks[b].area * stress;
        area += blocks[b].area;
    }
    EXPECT_LT((mean / area + 1e6 * Mat2::Identity()).norm(), 2e-4 * 1e6) << mean / area;
}

std::string regular_polygon(double radius, int n) {
    std::string points;
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / n;
        points +=
            fmt::format("{}[{:.9f}, {:.9f}]", i > 0 ? ", " : "", radius * std::cos(angle), radius * std::sin(angle));
    }
    return "[" + points + "]";
}

// Lame 1852, plane strain: u(a) = (1 + nu)/E (A (1 - 2 nu) a + B/a) with A = p a2/(b2 - a2), B = p a2 b2/(b2 - a2).
TEST(Holes, RingUnderInnerPressureWidensAsLameSays) {
    constexpr double a = 1.0, b = 4.0, p = 1e6, modulus = 10e9, ratio = 0.25;
    const SceneRun run =
        run_scene(read_scene_text(plate, {"geometry.domain={rectangle: null, polygon: " + regular_polygon(b, 48) +
                                              ", holes: [{polygon: " + regular_polygon(a, 48) + "}]}",
                                          "geometry.tessellation.triangles={spacing: 0.4, grading: {openings: 0.12}}",
                                          "stages=[{pressure: {wall: 1 MPa}}]"}));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const BlockSystem& system = run.model.system;
    double outward = 0.0;
    int n_vertices = 0;
    std::size_t next = 0;
    for (const Block& block : system.blocks) {
        for (const Edge& edge : block.edges) {
            const Vec2 place = system.origin + edge_start(system, edge);
            const Vec2 moved = run.fields.back().displacement[next++];
            if (place.norm() > 1.0001 * a) continue;
            outward += moved.dot(place.normalized());
            ++n_vertices;
        }
    }
    const double share = p * a * a / (b * b - a * a);
    const double expected = (1.0 + ratio) / modulus * (share * (1.0 - 2.0 * ratio) * a + share * b * b / a);
    ASSERT_GT(n_vertices, 48);
    EXPECT_NEAR(outward / n_vertices, expected, 0.02 * expected);
}

TEST(Holes, AWallThatIsABoundaryChangesNoGauge) {
    const std::vector<std::string> pressed = {"boundaries.bottom.support=pinned",
                                              "stages=[{strain: {boundary: top, value: 0.01 %}, steps: 2}]"};
    std::vector<std::string> without_wall = pressed;
    without_wall.emplace_back("boundaries.wall=null");
    const SceneRun named = run_scene(read_scene_text(plate, pressed));
    const SceneRun unnamed = run_scene(read_scene_text(plate, without_wall));
    ASSERT_TRUE(stands(named)) << named.report.diagnosis;
    EXPECT_GT(named.history.back().axial_stress, 0.1e6);
    EXPECT_EQ(named.history.back().axial_stress, unnamed.history.back().axial_stress);
    EXPECT_EQ(named.history.back().lateral_strain, unnamed.history.back().lateral_strain);
}

TEST(Holes, AWallThatFacesAllWaysIsFixedOrFree) {
    const auto run_with = [](const std::vector<std::string>& changes) {
        return [changes] { (void)run_scene(read_scene_text(plate, changes)); };
    };
    EXPECT_THAT(run_with({"boundaries.wall.support=smooth"}),
                ThrowsMessage<InputError>(HasSubstr("boundaries.wall.support: expected none or fixed")));
    EXPECT_THAT(
        run_with({"stages=[{strain: {boundary: wall, value: 1 %}}]"}),
        ThrowsMessage<InputError>(HasSubstr("expected a boundary for the platen that faces one way, found 'wall'")));
    const SceneRun fixed =
        run_scene(read_scene_text(plate, {"boundaries.wall.support=fixed", "stages.0.pressure.wall=null"}));
    EXPECT_TRUE(stands(fixed)) << fixed.report.diagnosis;
}

} // namespace
} // namespace kluft

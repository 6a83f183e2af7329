// A wedge without weight that slides out from under a lid, beside a column that carries much more, which it does not touch.
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// The top of the wedge falls by 5 degrees; its joints hold 1 degree. Stages: the column is pressed with 100 MPa, and then with
/// `column`; the lid on the wedge with `lid`. Both stand on fixed bases, or on one.
std::string wedge_beside_a_column(const std::string& column, const std::string& lid, bool on_one_base) {
    const std::string bases =
        on_one_base ? "{name: base, polygon: [[0, 0], [12, 0], [12, 1], [0, 1]], support: fixed}"
                    : "{name: base, polygon: [[0, 0], [9, 0], [9, 1], [0, 1]], support: fixed}\n"
                      "    - {name: other base, polygon: [[9.5, 0], [12, 0], [12, 1], [9.5, 1]], support: fixed}";
    return fmt::format(R"(
kluft: 1
materials:
  rock: {{density: 0 kg/m3, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 100 GPa/m, shear_stiffness: 50 GPa/m, friction_angle: 1 deg, contact_rounding: 0 Pa}}
geometry:
  blocks:
    - {2}
    - {{name: wedge, polygon: [[2, 1], [8, 1], [8, 2], [2, 2.524931981155544]]}}
    - {{name: wall, polygon: [[5, 2.7], [6, 2.7], [6, 4], [5, 4]], support: fixed}}
    - {{name: lid, polygon: [[4.9, 2.2712148569303645], [5, 2.262465990577772], [5, 4], [4.9, 4]]}}
    - {{name: column, polygon: [[10, 1], [11, 1], [11, 5], [10, 5]]}}
boundaries:
  up: {{facing: top, block: column}}
  down: {{facing: bottom, block: {3}}}
  lid: {{facing: top, block: lid}}
stages:
  - {{name: press, stress: {{boundary: up, value: 100 MPa}}, steps: 2}}
  - {{name: back, stress: {{boundary: up, value: {0}}}, steps: 2}}
  - {{name: lid, stress: {{boundary: up, value: {0}}}, pressure: {{lid: {1}}}, steps: 4}}
)",
                       column, lid, bases, on_one_base ? "base" : "other base");
}

class LightWedge : public testing::TestWithParam<std::tuple<std::string, std::string, bool>> {};

// 5 degrees are more than its two joints hold (1 degree each), whatever the column carries or has carried.
TEST_P(LightWedge, SlidesBesideAColumnThatCarriesMuch) {
    const auto& [column, lid, on_one_base] = GetParam();
    const SceneRun run = run_scene(wedge_beside_a_column(column, lid, on_one_base), {});
    EXPECT_TRUE(run.report.status == RunStatus::collapsed || run.report.status == RunStatus::no_equilibrium)
        << run.report.diagnosis;
    for (const StepRecord& row : run.history) EXPECT_TRUE(row.stage < 2 || !row.balanced) << row.load_factor;
}

INSTANTIATE_TEST_SUITE_P(, LightWedge,
                         testing::Combine(testing::Values("100 MPa", "5 MPa", "1 kPa"),
                                          testing::Values("1 kPa", "100 kPa"), testing::Bool()));

} // namespace
} // namespace kluft

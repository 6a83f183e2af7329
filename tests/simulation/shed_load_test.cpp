// A body that has fallen apart between its platens and carries nothing any more (docs/theory.md, eq. 27c and 29e).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/simulation/over_damped_motion.hpp"
#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

using posed::Workplace;

/// Bonded triangles without lateral pressure, pressed until nothing is left of them but loose pieces, and on.
std::string loose_triangles(int seed) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: strain}}
materials:
  rock: {{density: 2600, youngs_modulus: 15e9, poissons_ratio: 0.25, cohesion: 8e6, friction_angle: 40, tensile_strength: 2.5e6}}
interfaces:
  bond: {{kind: potential_crack, normal_stiffness: 300e9, shear_stiffness: 150e9, fails_to: joint}}
  joint: {{kind: fracture, normal_stiffness: 300e9, shear_stiffness: 150e9, friction_angle: 35}}
geometry:
  domain: {{rectangle: {{width: 2.5, height: 5}}}}
  tessellation: {{triangles: {{spacing: 0.7, seed: {}}}, interface: bond}}
boundaries: {{bottom: {{support: pinned}}}}
stages: [{{strain: {{boundary: top, value: 0.5 %}}, platens: smooth, steps: 25}}]
)",
                       seed);
}

/// The run and what it tells.
struct Collapse {
    explicit Collapse(const std::string& text) : scene(read_scene_text(text)), model(build_scene_model(scene).model) {
        State state = initial_state(model);
        const std::atomic<bool> stop{false};
        report = run_simulation(model, scene.cracks, scene.solver, state, told, stop);
    }

    /// The rows behind the first one that carries a hundredth of the peak or less.
    [[nodiscard]] std::vector<StepRecord> loose_rows() const {
        const auto at_peak = std::ranges::max_element(told.rows, {}, &StepRecord::axial_stress);
        const auto first = std::find_if(at_peak, told.rows.end(), [&](const StepRecord& row) {
            return row.axial_stress <= 0.01 * at_peak->axial_stress;
        });
        return {first == told.rows.end() ? first : std::next(first), told.rows.end()};
    }

    Scene scene;
    Model model;
    posed::Told told;
    RunReport report;
};

class ShedLoad : public testing::TestWithParam<int> {};

// Pieces that carry nothing get out of the way of the platen without rubbing on each other. With friction on the way a load step
// took 497 linear solves on the average of these bodies, and 1 400 with 276 triangles.
TEST_P(ShedLoad, PiecesThatCarryNothingComeToStand) {
    const Collapse run(loose_triangles(GetParam()));
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    const std::vector<StepRecord> loose = run.loose_rows();
    ASSERT_GT(loose.size(), 5U);
    int n_solves = 0;
    for (const StepRecord& row : loose) {
        EXPECT_TRUE(row.balanced) << row.axial_strain;
        n_solves += row.open_close_iterations;
    }
    EXPECT_LT(n_solves, 400 * static_cast<int>(loose.size()));
}

INSTANTIATE_TEST_SUITE_P(Seeds, ShedLoad, testing::Values(1, 2));

/// Two blocks on each other between platens, pressed to the end of a load step.
constexpr const char* two_pressed_blocks = R"(
kluft: 1
analysis: {plane: strain}
materials: {rock: {density: 0, youngs_modulus: 1e10, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30}}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  reference_spacing: 1
  fractures: [{trace: [[-1, 1], [2, 1]], interface: joint}]
boundaries: {bottom: {support: pinned}}
stages: [{strain: {boundary: top, value: 0.01 %}, platens: smooth, steps: 2}]
)";

// Either block gets the stress over 1 m from the other one. That is no load any more where it is in all below a hundredth of the
// stress that the body has carried over the root of its area, 2 m2 (27c): where it is 1/sqrt(2) of a hundredth.
TEST(ShedLoad, ContactsRubWhileTheBodyCarriesALoad) {
    const double of_a_load = 100.0 * std::sqrt(2.0);
    for (const double carried_before : {1.0, 0.99 * of_a_load, 1.01 * of_a_load}) {
        Workplace work(build_scene_model(read_scene_text(two_pressed_blocks)).model);
        const Step step = work.take(0.5);
        ASSERT_TRUE(step.balanced);
        State pressed = step.end;
        pressed.stresses.largest_axial *= carried_before;
        const StepBench bench = work.bench();
        StepInProgress p = begin_step(bench, pressed, goal_at(bench, 1.0, false));
        PlacedState placed = place_for_load_step(p);
        ASSERT_FALSE(placed.placement.contacts.empty());
        const Motion motion = begin_motion(p, placed, 1.0, {});
        EXPECT_EQ(motion.rubs, carried_before < of_a_load);
        for (const ContactPoint& point : placed.placement.contacts)
            EXPECT_EQ(point.held_limit.has_value(), carried_before > of_a_load);
        set_friction(true, placed);
        EXPECT_FALSE(placed.placement.contacts.front().held_limit.has_value());
    }
}

} // namespace
} // namespace kluft

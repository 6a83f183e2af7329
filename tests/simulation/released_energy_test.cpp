// Where the energy of a jump comes from: what the body has stored (docs/theory.md, Jumps).
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/loading/stored_energy.hpp"
#include "kluft/simulation/placement.hpp"
#include "support/scene_run.hpp"

namespace kluft {
namespace {

/// Bonded triangles with a mapped joint that sticks, pressed between smooth platens.
std::string pressed_triangles(int steps, double strain) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: strain}}
materials:
  rock: {{density: 2600, youngs_modulus: 15e9, poissons_ratio: 0.25, cohesion: 8e6, friction_angle: 40, tensile_strength: 2.5e6}}
interfaces:
  bond: {{kind: potential_crack, normal_stiffness: 300e9, shear_stiffness: 150e9, fails_to: joint}}
  joint: {{kind: fracture, normal_stiffness: 300e9, shear_stiffness: 150e9, friction_angle: 35}}
geometry:
  domain: {{rectangle: {{width: 5, height: 10}}}}
  fractures: [{{name: flat, trace: [[0, 5], [5, 5.5]], interface: joint}}]
  tessellation: {{triangles: {{spacing: 1.2}}, interface: bond}}
boundaries: {{bottom: {{support: pinned}}}}
stages: [{{strain: {{boundary: top, value: {}}}, platens: smooth, steps: {}}}]
)",
                       strain, steps);
}

// The forces of blocks, bonds and contacts that do not slide are those of a potential.
TEST(StoredEnergy, IsThePotentialOfTheForces) {
    const SceneRun run = run_scene(pressed_triangles(2, 1e-3));
    const Placement placement{placed_bonds(run.model, run.state.body),
                              detected_contacts(run.model, run.state.body, true).points};
    ASSERT_FALSE(placement.bonds.empty());
    ASSERT_FALSE(placement.contacts.empty());
    LoadsAt without_loads;
    without_loads.laws = run.model.laws;
    const LoadedBody body = loaded_body(run.model, placement, without_loads);
    const Eigen::VectorXd& q = run.state.body.displacement;
    BodyForces forces;
    body_forces(body, q, forces);
    for (int k = 0; k < 5; ++k) {
        Eigen::VectorXd along(q.size());
        for (int i = 0; i < q.size(); ++i) along[i] = std::sin(1.0 + (k + 1.0) * i);
        along *= 1e-7 / along.lpNorm<Eigen::Infinity>(); // m, beside closures of 1e-4 m
        const double change = stored_energy(body, q + along) - stored_energy(body, q - along);
        const double expected = 2.0 * forces.forces.dot(along);
        EXPECT_NEAR(change, expected, 1e-4 * forces.magnitudes.dot(along.cwiseAbs())) << k;
    }
}

// Springs in series: half of force times shortening.
TEST(StoredEnergy, IsTheWorkOfThePlatenWhileNothingBreaks) {
    const SceneRun run = run_scene(pressed_triangles(2, 1e-3));
    const Placement placement{placed_bonds(run.model, run.state.body),
                              detected_contacts(run.model, run.state.body, true).points};
    LoadsAt without_loads;
    without_loads.laws = run.model.laws;
    const double stored = stored_energy(loaded_body(run.model, placement, without_loads), run.state.body.displacement);
    const double work = 0.5 * run.history.back().axial_stress * 5.0 * 1e-3 * 10.0;
    EXPECT_NEAR(stored, work, 0.01 * work);
}

double work_of_platen(const SceneRun& run) {
    double work = 0.0;
    const StepRecord* before = &run.history.front();
    for (const StepRecord& row : run.equilibria) {
        work += 0.5 * (before->axial_stress + row.axial_stress) * (row.axial_strain - before->axial_strain);
        before = &row;
    }
    return work * 5.0 * 10.0;
}

class ReleasedEnergy : public testing::TestWithParam<int> {};

// In large load steps a platen squeezes loose pieces within a short pseudo-time, against the mass-like forces; what it put in so
// was counted as released: six times the work of the whole test.
TEST_P(ReleasedEnergy, IsNoMoreThanThePlatenHasPutIn) {
    const SceneRun run = run_scene(pressed_triangles(GetParam(), 6e-3));
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_FALSE(run.jumps.empty());
    double released = 0.0;
    double largest = 0.0;
    for (const JumpRecord& jump : run.jumps) {
        released += jump.released_energy;
        largest = std::max(largest, jump.released_energy);
    }
    const double work = work_of_platen(run);
    EXPECT_LT(released, work);
    EXPECT_GT(largest, 0.1 * work) << "the collapse releases much of what was stored";
}

INSTANTIATE_TEST_SUITE_P(SlowSteps, ReleasedEnergy, testing::Values(3, 6));

} // namespace
} // namespace kluft

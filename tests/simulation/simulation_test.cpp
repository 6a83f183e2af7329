#include "kluft/simulation/simulation.hpp"

#include <cmath>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/placement.hpp"
#include "support/scene_run.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

const char* const single_block = R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.25}}
geometry: {domain: {rectangle: {width: 1.0, height: 2.0}}, reference_spacing: 1.0}
boundaries: {bottom: {support: smooth}}
stages: [{name: platen, strain: {boundary: top, value: 1e-6}, platens: smooth, steps: 2}]
solver: {tolerance: 1e-10, balance: 1e-9}
)";

// sigma = E e in uniaxial plane stress; second order in the strain of 1e-6.
TEST(Simulation, SingleBlockBetweenSmoothPlatensHasTheRocksModuli) {
    const auto run = run_scene(single_block);
    ASSERT_EQ(run.report.status, RunStatus::done);
    const StepRecord& last = run.history.back();
    EXPECT_NEAR(last.axial_strain, 1e-6, 1e-15);
    EXPECT_NEAR(last.axial_stress, 10e9 * 1e-6, 1e-5 * 10e3);
    EXPECT_NEAR(last.lateral_strain, -0.25e-6, 1e-11);
}

TEST(Simulation, RunsOnlyWhatTheSceneRequires) {
    const auto run = run_scene(single_block);
    EXPECT_EQ(run.report.detections, 0);
    EXPECT_EQ(run.report.crack_checks, 0);
}

// Hexagons with k_s = k_n, cut through the centres of the lowest and uppermost row: the uniform stress is exact there.
// Plane stress, so 1/E = (1/(2K) + 1/(2G))/2 with the lattice formula of docs/theory.md.
TEST(Simulation, TessellatedBodyHasTheModulusOfTheLatticeFormula) {
    const double e = 10e9, nu = 0.25, d = 0.1, kn = 1e12;
    const std::string scene = fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: {}, poissons_ratio: {}, cohesion: 1e12, friction_angle: 30, tensile_strength: 1e11}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: {}, shear_stiffness: {}}}
  bond: {{kind: potential_crack, normal_stiffness: {}, shear_stiffness: {}, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: {}, height: {:.17g}}}}}
  tessellation: {{hexagons: {{spacing: {}, offset: [{}, 0]}}, interface: bond}}
boundaries: {{bottom: {{support: smooth}}}}
stages: [{{name: platen, strain: {{boundary: top, value: 1e-7}}, platens: smooth, steps: 1}}]
solver: {{tolerance: 1e-10, balance: 1e-9}}
)",
                                          e, nu, kn, kn, kn, kn, 5 * d, 6 * std::sqrt(0.75) * d, d, d / 2);
    const auto run = run_scene(scene);
    ASSERT_EQ(run.report.status, RunStatus::done);
    const double compliance_k = (1 - nu) / e + 1 / (d * kn);        // 1/(2K), plane stress: 2K = E/(1 - nu)
    const double compliance_g = (1 + nu) / e + 2 / (d * (kn + kn)); // 1/(2G)
    const double modulus = 2 / (compliance_k + compliance_g);
    const StepRecord& last = run.history.back();
    EXPECT_NEAR(last.axial_stress / last.axial_strain, modulus, 1e-6 * modulus);
    EXPECT_EQ(run.report.detections, 0);
}

// Touching blocks that no load has closed yet have no stiffness. The load of the first step closes them: within the
// rounding the lateral pressure arrives at the blocks as it is (equilibrium).
TEST(Simulation, LooseHexagonsCloseUnderTheirFirstLoad) {
    const auto run = run_scene(R"(
kluft: 1
materials: {rock: {youngs_modulus: 1500 MPa, poissons_ratio: 0.25}}
interfaces: {joint: {kind: fracture, normal_stiffness: 6.7e9, shear_stiffness: 3.3e9, friction_angle: 27, contact_rounding: 4e3, friction_rounding: 0.05}}
geometry:
  domain: {rectangle: {width: 0.38, height: 0.6}}
  tessellation: {hexagons: {spacing: 0.03, rotation: 20, offset: [0.0166667, 0.0166667]}, interface: joint}
boundaries: {bottom: {support: pinned}}
stages: [{name: pressure, pressure: {left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}, steps: 4}]
)");
    ASSERT_EQ(run.report.status, RunStatus::done);
    EXPECT_EQ(run.report.unbalanced_steps, 0);
    EXPECT_EQ(run.report.costs.relaxations, 0);
    EXPECT_NEAR(run.history.back().lateral_stress, 0.2e6, 1e2);
    EXPECT_NEAR(run.history.back().axial_stress, 0.2e6, 2e3);
}

// A rigid platen shortens both columns alike, whatever their stiffness: u (w/(L/E + 1/k_n) + w/(L/E)) = stress 2 w, with
// a bond of stiffness k_n across the left column, no friction between the columns and no lateral strain (nu = 0).
TEST(Simulation, PlatenUnderAGivenStressStaysFlat) {
    const double e = 10e9, kn = 5e9, length = 2.0, stress = 1e4;
    for (const char* platens : {"smooth", "rough"}) {
        const auto run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: {}, poissons_ratio: 0, cohesion: 1e9, friction_angle: 30, tensile_strength: 1e9}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 0}}
  soft: {{kind: potential_crack, normal_stiffness: {}, shear_stiffness: 1e9, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: 1.0, height: {}}}}}
  fractures:
    - {{name: between, trace: [[0.5, -1], [0.5, 3]], interface: joint}}
    - {{name: across, trace: [[-1, 0.8], [0.5, 0.8]], interface: soft}}
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: platen, stress: {{boundary: top, value: {}}}, platens: {}, steps: 2}}]
solver: {{tolerance: 1e-10, balance: 1e-8}}
)",
                                               e, kn, length, stress, platens));
        ASSERT_EQ(run.report.status, RunStatus::done);
        const double shortening = 2 * stress / (1 / (length / e + 1 / kn) + 1 / (length / e));
        const StepRecord& last = run.history.back();
        EXPECT_NEAR(last.axial_strain, shortening / length, 1e-4 * shortening / length) << platens;
        EXPECT_NEAR(last.axial_stress, stress, 1e-6 * stress) << platens;
    }
}

std::string incline(double slope_degrees) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: [{:.17g}, {:.17g}]}}
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30, contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: 4.0, height: 1.5}}}}
  fractures: [{{name: plane, trace: [[-1, 0.5], [5, 0.5]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: weight, steps: 2}}]
solver: {{tolerance: 1e-10, balance: 1e-6, max_unbalanced_steps: 1}}
)",
                       10.0 * std::sin(slope_degrees * degree), -10.0 * std::cos(slope_degrees * degree));
}

// Coulomb: a block on an incline slips for slopes above phi = 30 degrees.
TEST(Simulation, BlockOnInclineStaysBelowTheFrictionAngleAndSlipsAboveIt) {
    const auto stays = run_scene(incline(29.99));
    EXPECT_EQ(stays.report.status, RunStatus::done);
    EXPECT_EQ(stays.report.unbalanced_steps, 0);
    const auto slips = run_scene(incline(30.01));
    EXPECT_TRUE(slips.report.status != RunStatus::done || slips.report.unbalanced_steps > 0);
}

// A plane with c = 0.1 MPa and phi = 30 degrees at 0.2 MPa lateral pressure; its normal makes `beta` with p1.
std::string plane_of_weakness(double beta, const char* platen) {
    const double rise = 1.4 * std::tan(beta) / 2;
    return fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 50 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30, cohesion: 0.1 MPa, cohesion_onset: 10, contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: 1.0, height: 3.0}}}}
  fractures: [{{name: plane, trace: [[-0.2, {:.17g}], [1.2, {:.17g}]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{name: pressure, pressure: {{left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}}, steps: 1}}
  - {{name: platen, {}, platens: smooth, steps: 20}}
)",
                       1.5 - rise, 1.5 + rise, platen);
}

// Jaeger: p1 - p3 = 2 (c + p3 tan phi)/((1 - tan phi cot beta) sin 2 beta).
double jaegers_stress(double beta) {
    const double c = 0.1e6, tan_phi = std::tan(30 * degree), p3 = 0.2e6;
    return 2 * (c + p3 * tan_phi) / ((1 - tan_phi / std::tan(beta)) * std::sin(2 * beta));
}

TEST(Simulation, PlaneOfWeaknessSlipsAtJaegersStress) {
    for (const double beta : {50 * degree, 60 * degree}) {
        const auto run = run_scene(plane_of_weakness(beta, "strain: {boundary: top, value: 1e-4}"));
        ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
        const double expected = jaegers_stress(beta);
        EXPECT_NEAR(run.history.back().differential_stress, expected, 2e-3 * expected) << beta;
        EXPECT_EQ(run.report.crack_checks, 0);
    }
}

TEST(Simulation, BodyUnderAGivenStressCollapsesAtTheStepThatPassesJaegersStress) {
    const double beta = 60 * degree;
    const auto run = run_scene(plane_of_weakness(beta, "stress: {boundary: top, value: 1.1 MPa}"));
    EXPECT_EQ(run.report.status, RunStatus::collapsed);
    const double step = (1.1e6 - 0.2e6) / 20;
    EXPECT_LT(run.history.back().differential_stress, jaegers_stress(beta));
    EXPECT_GT(run.history.back().differential_stress, jaegers_stress(beta) - step);
}

const char* const bonded_pair = R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.2, cohesion: 5 MPa, friction_angle: 40, tensile_strength: 1 MPa}}
interfaces:
  joint: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30}
  bond: {kind: potential_crack, normal_stiffness: 1e11, shear_stiffness: 1e11, fails_to: joint}
geometry:
  domain: {rectangle: {width: 1.0, height: 2.0}}
  fractures: [{name: seam, trace: [[-1, 1], [2, 1]], interface: bond}]
  reference_spacing: 1.0
boundaries: {bottom: {support: smooth}}
stages: [{name: pull, strain: {boundary: top, value: -2e-4, glued: true}, platens: smooth, steps: 5}]
cracks: {event_tolerance: 1e-3}
)";

// Pure tension fails at sigma_t = 1 MPa, located within the event tolerance although a step raises the stress by 0.4 MPa.
TEST(Simulation, BondInTensionFailsAtItsTensileStrengthWhateverTheStep) {
    const auto run = run_scene(bonded_pair);
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    double lowest = 0.0;
    for (const auto& record : run.equilibria) lowest = std::min(lowest, record.axial_stress);
    EXPECT_NEAR(lowest, -1e6, 1.1e-3 * 1e6);
    ASSERT_EQ(run.cracks.size(), 1U);
    EXPECT_EQ(run.cracks.front().mode, CrackMode::tension);
    EXPECT_NEAR(run.history.back().axial_stress, 0.0, 1.0);
}

// sigma_1 = 2 c cos(phi)/(1 - sin(phi)) = 21.4451 MPa in uniaxial compression.
TEST(Simulation, BondInCompressionFailsAtTheUniaxialStrengthOfMohrCoulomb) {
    const auto run = run_scene(bonded_pair, {"stages.0.strain.value=3e-3", "stages.0.steps=10"});
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    ASSERT_EQ(run.cracks.size(), 1U);
    EXPECT_EQ(run.cracks.front().mode, CrackMode::shear);
    const double strength = 2 * 5e6 * std::cos(40 * degree) / (1 - std::sin(40 * degree));
    EXPECT_NEAR(run.cracks.front().p1, strength, 2e-3 * strength);
}

const char* const small_specimen = R"(
kluft: 1
materials: {rock: {youngs_modulus: 1500 MPa, poissons_ratio: 0.25, cohesion: 0.06 MPa, friction_angle: 39.6, tensile_strength: 0.02 MPa}}
interfaces:
  joint: {kind: fracture, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, friction_angle: 12, cohesion: 0.03 MPa, cohesion_onset: 0.04 MPa, contact_rounding: 0.004 MPa}
  bond: {kind: potential_crack, normal_stiffness_times_spacing: 200 MPa, shear_stiffness_times_spacing: 100 MPa, fails_to: joint}
geometry:
  domain: {rectangle: {width: 0.2, height: 0.4}}
  fractures: [{name: main, trace: [[0.0, 0.0], [0.25, 0.4]], interface: joint}]
  tessellation: {hexagons: {spacing: 0.05}, interface: bond}
boundaries: {bottom: {support: pinned}}
stages:
  - {name: pressure, pressure: {left: 0.1 MPa, right: 0.1 MPa, top: 0.1 MPa}, steps: 2}
  - {name: platen, strain: {boundary: top, value: 0.02}, platens: smooth, steps: 20}
)";

// Near the corner of the strength the index is constant (tension) before it rises (shear): the search for its zero must
// not creep up to the kink. p1 = 2 c cos(phi)/(1 - sin(phi)) + p3 (1 + sin(phi))/(1 - sin(phi)).
TEST(Simulation, EventIsFoundBehindAKinkOfTheStrengthIndex) {
    const auto run = run_scene(R"(
kluft: 1
materials:
  rock: {youngs_modulus: 1e12, poissons_ratio: 0.25, cohesion: 0.16 MPa, friction_angle: 36.2, tensile_strength: 0.1 MPa}
interfaces:
  bond: {kind: potential_crack, normal_stiffness: 1e12, shear_stiffness: 5e11, fails_to: joint}
  joint: {kind: fracture, normal_stiffness: 1e12, shear_stiffness: 5e11, friction_angle: 36.2}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
  fractures: [{trace: [[-0.1, 1], [1.1, 1]], interface: bond}]
boundaries: {bottom: {support: pinned}}
stages:
  - {pressure: {left: -0.09999 MPa, right: -0.09999 MPa, top: 0}}
  - {displacement: {boundary: top, value: 1.5e-5}, steps: 6}
cracks: {event_tolerance: 1e-9}
solver: {tolerance: 1e-10, balance: 1e-9}
)");
    ASSERT_EQ(run.report.status, RunStatus::done);
    const double sine = std::sin(36.2 * degree);
    const double p1 = (2 * 0.16e6 * std::cos(36.2 * degree) - 0.09999e6 * (1 + sine)) / (1 - sine);
    ASSERT_EQ(run.cracks.size(), 1U);
    EXPECT_NEAR(run.cracks.front().p1, p1, 1e-6 * p1);
}

// Pushed with half of what overturns it, W b/(2 a), a block that is 1000 times as stiff as its joint settles and rests: the
// mass-like term follows the joint.
TEST(Simulation, StiffBlockOnASoftJointComesToRest) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {plane: stress, gravity: 10}
materials: {rock: {youngs_modulus: 1e13, poissons_ratio: 0, density: 2500}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 45}}
geometry:
  domain: {polygon: [[-1, -1], [3, -1], [3, 0], [1, 0], [1, 2], [0, 2], [0, 1.55], [0, 1.45], [0, 0], [-1, 0]]}
  fractures: [{trace: [[0, 0], [1, 0]]}]
boundaries: {bottom: {sides: [0], support: fixed}, push: {sides: [6]}}
stages:
  - {name: weight}
  - {name: push, pressure: {push: 83333}, steps: 2}
solver: {tolerance: 1e-10, balance: 1e-7, max_unbalanced_steps: 1}
)");
    EXPECT_EQ(run.report.status, RunStatus::done);
    EXPECT_EQ(run.report.unbalanced_steps, 0);
}

/// Keeps the state at the end of the first stage, as a run that is killed there leaves it on the disk.
class KeepsStateOfFirstStage : public StepObserver {
public:
    explicit KeepsStateOfFirstStage(State& kept) : kept_(kept) {}
    void equilibrium(const StepRecord&) override {}
    void crack(const CrackRecord&) override {}
    void step(const StepRecord& record, const State& state, const std::function<FieldRecord()>&, bool last) override {
        if (last && record.stage == 0) kept_ = state;
        last_ = record;
    }
    [[nodiscard]] const StepRecord& last() const { return last_; }

private:
    State& kept_;
    StepRecord last_;
};

// The pressure that a platen leaves behind is its reaction, also where the run was ended right after the stage.
TEST(Simulation, RunResumedAtTheEndOfAStageKeepsTheReactionOfThePlaten) {
    const Scene scene = read_scene_text(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 1e9, poissons_ratio: 0}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle: 30}}
geometry: {domain: {rectangle: {width: 2, height: 2}}, fractures: [{trace: [[-1, 1], [3, 1]]}], reference_spacing: 1}
boundaries: {bottom: {support: pinned}}
stages:
  - {displacement: {boundary: top, value: 1e-3}, steps: 2}
  - {pressure: {left: 1e4, right: 1e4}, steps: 2}
solver: {tolerance: 1e-10, balance: 1e-9}
)");
    const Model model = build_scene_model(scene).model;
    const std::atomic<bool> stop{false};
    State kept;
    State state = initial_state(model);
    KeepsStateOfFirstStage whole(kept);
    ASSERT_EQ(run_simulation(model, scene.cracks, scene.solver, state, whole, stop).status, RunStatus::done);
    State ignored;
    KeepsStateOfFirstStage resumed(ignored);
    ASSERT_EQ(run_simulation(model, scene.cracks, scene.solver, kept, resumed, stop).status, RunStatus::done);
    EXPECT_GT(whole.last().axial_stress, 1e5);
    EXPECT_EQ(resumed.last().axial_stress, whole.last().axial_stress);
}

TEST(SlowSimulation, SameSceneTwiceGivesTheSameBits) {
    std::ifstream file(KLUFT_SOURCE_DIR "/tests/support/specimen_of_hexagons.yaml");
    const std::string scene{std::istreambuf_iterator<char>(file), {}};
    const auto first = run_scene(scene);
    const auto second = run_scene(scene);
    ASSERT_EQ(first.history.size(), second.history.size());
    for (std::size_t i = 0; i < first.history.size(); ++i) {
        EXPECT_EQ(first.history[i].axial_stress, second.history[i].axial_stress);
        EXPECT_EQ(first.history[i].lateral_strain, second.history[i].lateral_strain);
        EXPECT_EQ(first.history[i].open_close_iterations, second.history[i].open_close_iterations);
    }
    EXPECT_GT(first.cracks.size(), 0U);
}

// Love-Weber: the Cauchy stress of a block is the sum of f x over its contact and outer forces, by its current area.
// The blocks of the outline are left out, because their platen forces are not in the list of points.
TEST(SlowSimulation, BlockStressIsTheLoveWeberSumOfItsContactForces) {
    auto run = run_scene(small_specimen, {"solver.tolerance=1e-9", "solver.balance=1e-7"});
    ASSERT_EQ(run.report.status, RunStatus::done) << run.report.diagnosis;
    const BlockSystem& system = run.model.system;
    const Eigen::VectorXd& q = run.state.body.displacement;
    const std::vector<Bond> bonds = placed_bonds(run.model, run.state.body);
    std::vector<Mat2> sums(system.blocks.size(), Mat2::Zero());
    std::vector<char> inside(system.blocks.size(), 1);
    for (int b = 0; b < system.n_blocks(); ++b) {
        for (const Edge& edge : system.blocks[b].edges) {
            const bool free_or_broken =
                edge.interface < 0 || run.state.body.interfaces[edge.interface] != InterfaceStatus::potential_crack;
            if (free_or_broken) inside[b] = 0;
        }
    }
    const auto arm = [&](int b, const Vec2& xi) -> Vec2 {
        return deformation_gradient(q, b, system.blocks[b].size) * (system.blocks[b].size * xi);
    };
    for (const Bond& bond : bonds) {
        for (int k = 0; k < n_bond_points; ++k) {
            const auto traction = bond_traction(run.model.laws[bond.law], bond, k, q);
            const Vec2 force = bond.weight * (traction.normal * bond.normal() + traction.shear * bond.tangent);
            sums[bond.block_a] += force * arm(bond.block_a, bond.xi_a[k]).transpose();
            sums[bond.block_b] -= force * arm(bond.block_b, bond.xi_b[k]).transpose();
        }
    }
    const auto stresses = block_stresses(system, run.model.moduli, q);
    int compared = 0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (!inside[b]) continue;
        const Mat2 f = deformation_gradient(q, b, system.blocks[b].size);
        const double area = system.blocks[b].area * (f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0));
        const Mat2 love_weber = (sums[b] + sums[b].transpose()) / (2.0 * area);
        EXPECT_LT((love_weber - stresses[b]).norm(), 2e-3 * stresses[b].norm()) << b;
        ++compared;
    }
    EXPECT_GT(compared, 3);
}

TEST(Simulation, InterruptedRunKeepsTheLastCommittedStep) {
    const Scene scene = read_scene_text(small_specimen);
    const Model model = build_scene_model(scene).model;
    State state = initial_state(model);
    std::atomic<bool> stop{false};
    class StopAtStep : public StepObserver {
    public:
        explicit StopAtStep(std::atomic<bool>& flag) : flag_(flag) {}
        void step(const StepRecord& record, const State&, const std::function<FieldRecord()>&, bool) override {
            if (record.step == 5) flag_ = true;
        }

    private:
        std::atomic<bool>& flag_;
    } observer(stop);
    const auto report = run_simulation(model, scene.cracks, scene.solver, state, observer, stop);
    EXPECT_EQ(report.status, RunStatus::interrupted);
    EXPECT_EQ(state.at.step, 5);
}

} // namespace
} // namespace kluft

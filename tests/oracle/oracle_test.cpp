// The open-close solver against an independent method: the same load step as a constrained minimisation by Ipopt
// (validation/oracle/README.md). Nothing is rounded in the laws; the solver's tolerance is 1e-10, its balance 1e-9.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/assembly/blas.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "oracle/posed_minimum.hpp"
#include "oracle/posed_step.hpp"

namespace kluft::oracle {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double tolerance = 1e-10;
constexpr double balance = 1e-9;

// ---- scenes --------------------------------------------------------------------------------------------------------

const std::string accurate = "solver: {tolerance: 1e-10, balance: 1e-9, viscosity: 1e-3, max_iterations: 50}\n";

/// Half of a rectangle of 2 m by 1 m on the other, under gravity inclined by 30 degrees.
Scene incline(double friction_degrees, double cohesion = 0.0) {
    return read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{gravity: [{:.17g}, {:.17g}]}}
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle: {}, cohesion: {}, cohesion_onset: 10e3, contact_rounding: 0, friction_rounding: 0}}
geometry:
  domain: {{rectangle: {{width: 2, height: 1}}}}
  fractures: [{{trace: [[-1, 0.5], [3, 0.5]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: weight, steps: 2}}]
)",
                                       9.81 * std::sin(30 * degree), -9.81 * std::cos(30 * degree), friction_degrees,
                                       cohesion) +
                           accurate);
}

/// A block with a V-shaped lower end in a groove whose faces dip 40 degrees, in two layers.
Scene wedge(double friction_degrees) {
    const double rise = 1.5 * std::tan(40 * degree);
    return read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{gravity: 9.81}}
materials: {{rock: {{density: 2500, youngs_modulus: 5 GPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle: {0}, contact_rounding: 0, friction_rounding: 0}}
geometry:
  domain: {{rectangle: {{width: 2, height: 2}}}}
  fractures:
    - {{trace: [[-0.5, {1:.17g}], [1, 0.5], [2.5, {1:.17g}]], interface: joint}}
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: weight, steps: 2}}]
)",
                                       friction_degrees, 0.5 + rise) +
                           accurate);
}

/// A semicircular arch of 16 voussoirs, mean radius 5 m and thickness 0.8 m, on fixed springers.
Scene arch() {
    constexpr int n_voussoirs = 16;
    constexpr double inner = 4.6, outer = 5.4;
    const double step = std::numbers::pi / n_voussoirs;
    const auto point = [](double radius, double angle) {
        return fmt::format("[{:.17g}, {:.17g}]", radius * std::cos(angle), radius * std::sin(angle));
    };
    // Corners at the springers and in the middle of each voussoir, so that joints cut sides.
    std::vector<double> angles{0.0};
    for (int i = 0; i < n_voussoirs; ++i) angles.push_back((i + 0.5) * step);
    angles.push_back(std::numbers::pi);
    std::string corners, joints;
    for (const double angle : angles) corners += point(outer, angle) + ", ";
    for (auto angle = angles.rbegin(); angle != angles.rend(); ++angle) corners += point(inner, *angle) + ", ";
    for (int i = 1; i < n_voussoirs; ++i) {
        joints += fmt::format("    - {{trace: [{}, {}], interface: joint}}\n", point(inner - 0.2, i * step),
                              point(outer + 0.2, i * step));
    }
    const int n_arc = static_cast<int>(angles.size()) - 1; // sides along one arc
    return read_scene_text(fmt::format(R"(
kluft: 1
analysis: {{gravity: 9.81}}
materials: {{stone: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle: 60, contact_rounding: 0, friction_rounding: 0}}
geometry:
  domain: {{polygon: [{}]}}
  fractures:
{}
  reference_spacing: 1.0
boundaries: {{left: {{sides: [{}], support: fixed}}, right: {{sides: [{}], support: fixed}}}}
stages: [{{name: weight, steps: 2}}]
)",
                                       corners, joints, n_arc, 2 * n_arc + 1) +
                           accurate);
}

/// Model (a) of the triaxial test, fractures only.
Scene cut_sample() {
    return read_scene(std::string(KLUFT_SOURCE_DIR) + "/models/triaxial/case-1.yaml",
                      {"interfaces.joint.contact_rounding=0", "interfaces.joint.friction_rounding=0",
                       "stages.0.steps=2", "stages.1.steps=20", "stages.1.strain.value=1 %", "solver.tolerance=1e-10",
                       "solver.balance=1e-9", "solver.viscosity=1e-3", "solver.max_iterations=50"});
}

/// Hexagons of 0.1 m under lateral pressure and a platen.
Scene hexagons(const std::string& net) {
    return read_scene_text(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 1500 MPa, poissons_ratio: 0.25}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness_times_spacing: 400 MPa, shear_stiffness_times_spacing: 200 MPa, friction_angle: 30, contact_rounding: 0, friction_rounding: 0}}
  bond: {{kind: potential_crack, normal_stiffness_times_spacing: 400 MPa, shear_stiffness_times_spacing: 200 MPa, cohesion: 100 MPa, friction_angle: 40, tensile_strength: 50 MPa, fails_to: joint}}
geometry:
  domain: {{rectangle: {{width: 0.3, height: 0.4}}}}
  fractures: [{{trace: [[-0.1, 0.05], [0.4, 0.4]], interface: joint}}]
  tessellation: {{hexagons: {{spacing: 0.1, rotation: 10}}, interface: {}}}
stages:
  - {{name: pressure, pressure: {{left: 0.2 MPa, right: 0.2 MPa, top: 0.2 MPa}}, steps: 2}}
  - {{name: platen, strain: {{boundary: top, value: 0.5 %}}, platens: smooth, steps: 10}}
boundaries: {{bottom: {{support: pinned}}}}
)",
                                       net) +
                           accurate);
}

// ---- comparison ----------------------------------------------------------------------------------------------------

Eigen::VectorXd random_vector(Eigen::Index n, double amplitude, unsigned seed) {
    std::mt19937 generator(seed);
    Eigen::VectorXd v(n);
    for (double& value : v) value = amplitude * (2.0 * static_cast<double>(generator()) / 4294967295.0 - 1.0);
    return v;
}

/// Differences relative to the largest normal force and the largest change of an unknown.
struct Comparison {
    double normal_forces = 0.0;
    double shear_forces = 0.0;
    double displacements = 0.0;
    double run = 0.0;         ///< displacements of the run itself
    double other_guess = 0.0; ///< displacements of the iteration from elsewhere
    int open = 0;
    int sliding = 0;
    int locked = 0;
};

Comparison compare(const PosedStep& step, const Eigen::VectorXd& q, const OracleSolution& oracle) {
    const LoadedBody& body = step.body();
    Comparison result;
    double largest_force = 0.0;
    for (std::size_t i = 0; i < body.placement->contacts.size(); ++i) {
        const auto traction = contact_traction(body, static_cast<int>(i), q);
        const double weight = body.placement->contacts[i].weight;
        largest_force = std::max(largest_force, -weight * traction.normal);
        result.normal_forces =
            std::max(result.normal_forces, std::abs(-weight * traction.normal - oracle.normal_forces[i]));
        result.shear_forces = std::max(result.shear_forces, std::abs(weight * traction.shear - oracle.shear_forces[i]));
        if (traction.state == ContactState::open) ++result.open;
        if (traction.state == ContactState::sliding) ++result.sliding;
        if (traction.state == ContactState::locked) ++result.locked;
    }
    const double largest_motion = (q - step.start()).cwiseAbs().maxCoeff();
    result.normal_forces /= largest_force;
    result.shear_forces /= largest_force;
    result.displacements = (q - oracle.q).cwiseAbs().maxCoeff() / largest_motion;
    result.run = (q - step.end_of_run()).cwiseAbs().maxCoeff() / largest_motion;
    return result;
}

void report(const std::string& name, const PosedStep& step, const OracleSolution& oracle, const Comparison& c) {
    testing::Test::RecordProperty("normal_forces", fmt::format("{:.2e}", c.normal_forces));
    testing::Test::RecordProperty("shear_forces", fmt::format("{:.2e}", c.shear_forces));
    testing::Test::RecordProperty("displacements", fmt::format("{:.2e}", c.displacements));
    if (std::getenv("KLUFT_ORACLE_TABLE") == nullptr) return;
    fmt::print("| {} | {} | {} | {} | {} / {} / {} | {:.0e} | {:.0e} | {:.0e} | {:.0e} | {} | {} |\n", name,
               step.body().system->n_blocks(), oracle.n_unknowns, step.body().placement->contacts.size(), c.open,
               c.sliding, c.locked, c.normal_forces, c.shear_forces, c.displacements, c.other_guess,
               oracle.ipopt_iterations, oracle.outer_iterations);
}

/// Difference of the displacements where the iteration starts beyond the solution, with noise of that share of the step.
double other_guess(PosedStep& step, const Eigen::VectorXd& q, double noise) {
    const Eigen::VectorXd moved = q - step.start();
    const double largest_motion = moved.cwiseAbs().maxCoeff();
    const Eigen::VectorXd guess = q + 0.5 * moved + random_vector(q.size(), noise * largest_motion, 7);
    const auto solution = step.solve_by_open_close(tolerance, balance, guess);
    EXPECT_TRUE(solution.converged) << solution.residual_ratio << " " << solution.viscous_share;
    return (solution.q - q).cwiseAbs().maxCoeff() / largest_motion;
}

/// Solves one load step of a scene by both methods and expects forces and displacements within `accuracy`.
Comparison expect_agreement(const std::string& name, const Scene& scene, int load_step, double accuracy,
                            double noise = 1.0) {
    set_blas_threads(1);
    PosedStep step(scene, load_step);
    EXPECT_TRUE(step.run_is_balanced());
    const auto kluft = step.solve_by_open_close(tolerance, balance, step.start());
    EXPECT_TRUE(kluft.converged) << kluft.residual_ratio << " " << kluft.viscous_share;
    const OracleSolution oracle = solve_by_minimisation(step.body(), step.start());
    EXPECT_TRUE(oracle.converged) << oracle.diagnosis << " " << oracle.last_change;
    if (oracle.normal_forces.empty() && !step.body().placement->contacts.empty()) return {};
    Comparison result = compare(step, kluft.q, oracle);
    result.other_guess = other_guess(step, kluft.q, noise);
    report(name, step, oracle, result);
    EXPECT_LT(result.normal_forces, accuracy);
    EXPECT_LT(result.shear_forces, accuracy);
    EXPECT_LT(result.displacements, accuracy);
    EXPECT_LT(result.run, accuracy);
    EXPECT_LT(result.other_guess, accuracy);
    EXPECT_LT(oracle.missed_condition, 1e-12 * (kluft.q - step.start()).cwiseAbs().maxCoeff());
    return result;
}

// ---- the formulation -----------------------------------------------------------------------------------------------

Lagged lagged_at(const LoadedBody& body, const Eigen::VectorXd& q) {
    return {coulomb_limits(body, normal_forces_at(body, q), q), pressure_forces_at(body, q)};
}

// Central differences with step h: error h^2/6 f''' and round-off of the energy over h, together below 1e-6.
TEST(OraclePotential, HasTheGradientAndTheHessianOfItsEnergy) {
    PosedStep step(hexagons("joint"), 4);
    const LoadedBody& body = step.body();
    const Potential potential = pose_minimum(body, step.start(), lagged_at(body, step.start())).potential;
    const Eigen::VectorXd x = random_vector(potential.n_unknowns, 0.01, 1);
    const Eigen::VectorXd direction = random_vector(potential.n_unknowns, 1.0, 2);
    const double h = 1e-5;
    const Eigen::VectorXd ahead = x + h * direction;
    const Eigen::VectorXd behind = x - h * direction;
    const double slope = (potential.energy(ahead) - potential.energy(behind)) / (2 * h);
    EXPECT_NEAR(potential.gradient(x).dot(direction), slope, 1e-6 * std::abs(slope));
    const Eigen::VectorXd change = (potential.gradient(ahead) - potential.gradient(behind)) / (2 * h);
    const Eigen::SparseMatrix<double> hessian = potential.hessian(x);
    const Eigen::VectorXd product = hessian.selfadjointView<Eigen::Lower>() * direction;
    EXPECT_LT((product - change).norm(), 1e-6 * change.norm());
}

// At any displacements, z = max(0, -gap) and p+, p- that minimise the energy at Coulomb's limits of these gaps give the
// forces of the law: the derivatives of the energy less the pressure of the contacts. To round-off.
TEST(OraclePotential, HasTheForcesOfTheLibraryAsItsDerivatives) {
    PosedStep step(hexagons("joint"), 4);
    const LoadedBody& body = step.body();
    unsigned seed = 0;
    for (const double amplitude : {3e-4, 3e-3, 3e-2}) { // m; the last turns hexagons of 0.1 m by some 20 degrees
        const Eigen::VectorXd q = step.start() + random_vector(step.start().size(), amplitude, ++seed);
        const auto lagged = lagged_at(body, q);
        const auto normal_forces = normal_forces_at(body, q);
        const PosedMinimum posed = pose_minimum(body, step.start(), lagged);
        const Eigen::VectorXd x = closest_unknowns(posed, body, lagged, step.start(), q);
        Eigen::VectorXd forces = posed.potential.gradient(x).head(q.size());
        for (std::size_t i = 0; i < body.placement->contacts.size(); ++i) {
            for (const auto& term : posed.potential.inequalities[i].terms) {
                if (term.unknown < q.size()) forces[term.unknown] -= normal_forces[i] * term.factor;
            }
        }
        BodyForces expected;
        body_forces(body, q, expected);
        EXPECT_LT((forces - expected.forces).norm(), 1e-12 * expected.magnitudes.norm()) << amplitude;
    }
}

// ---- scenes --------------------------------------------------------------------------------------------------------

TEST(Oracle, BlockThatSticksOnAnInclineHasTheForcesOfTheMinimumOfEnergy) {
    const auto result = expect_agreement("incline, sticks (60 degrees)", incline(60), 2, 1e-6);
    EXPECT_EQ(result.sliding, 0);
}

TEST(Oracle, BlockThatPartlySlidesOnAnInclineHasTheForcesOfTheMinimumOfEnergy) {
    const auto far = expect_agreement("incline, 35 degrees", incline(35), 2, 1e-6);
    EXPECT_GT(far.sliding, 0);
    const auto near = expect_agreement("incline, 31 degrees", incline(31), 1, 1e-6);
    EXPECT_GT(near.sliding, 0);
}

// Weight 24.5 kN/m: mean shear 6.1 kPa, Coulomb's limit without cohesion 3.9 kPa, with all of it 6.9 kPa.
TEST(Oracle, BlockOnAnInclineWithCohesionThatFadesAtTheOpeningEdgeHasTheForcesOfTheMinimumOfEnergy) {
    const auto result = expect_agreement("incline, 20 degrees and 3 kPa", incline(20, 3e3), 2, 1e-6);
    EXPECT_GT(result.sliding, 0);
    EXPECT_GT(result.locked, 0);
}

TEST(Oracle, WedgeInASmoothGrooveHasTheForcesOfTheMinimumOfEnergy) {
    expect_agreement("wedge, smooth", wedge(0), 2, 1e-6);
}

TEST(Oracle, WedgeInARoughGrooveHasTheForcesOfTheMinimumOfEnergy) {
    const auto sliding = expect_agreement("wedge, 10 degrees", wedge(10), 2, 1e-6);
    EXPECT_GT(sliding.sliding, 0);
    expect_agreement("wedge, 50 degrees", wedge(50), 2, 1e-6);
}

// With noise as large as the step 9 to 13 of 40 guesses lead an arch back to its balance, whichever way the linear systems are
// solved; with a thirtieth of it 39.
TEST(Oracle, ArchUnderItsWeightHasTheForcesOfTheMinimumOfEnergy) {
    const auto result = expect_agreement("arch of 16 voussoirs", arch(), 2, 1e-6, 0.03);
    EXPECT_GT(result.open, 0);
    EXPECT_GT(result.locked, 0);
}

TEST(Oracle, CutSampleUnderAPlatenHasTheForcesOfTheMinimumOfEnergy) {
    const auto early = expect_agreement("cut sample, 0.1 % strain", cut_sample(), 4, 1e-6);
    EXPECT_GT(early.locked, 0);
    const auto late = expect_agreement("cut sample, 0.5 % strain", cut_sample(), 12, 1e-6);
    EXPECT_GT(late.sliding, 0);
}

TEST(Oracle, HexagonsWithFrictionUnderAPlatenHaveTheForcesOfTheMinimumOfEnergy) {
    const auto result = expect_agreement("hexagons with friction", hexagons("joint"), 8, 1e-6);
    EXPECT_GT(result.sliding, 0);
    EXPECT_GT(result.locked, 0);
}

TEST(Oracle, BondedHexagonsWithAFractureHaveTheForcesOfTheMinimumOfEnergy) {
    const auto result = expect_agreement("bonded hexagons and a fracture", hexagons("bond"), 8, 1e-6);
    EXPECT_GT(result.sliding, 0);
}

// The comparison would be worth nothing if it agreed with a wrong law as well.
TEST(Oracle, NoticesAShearStiffnessThatIsWrongByAThousandth) {
    set_blas_threads(1);
    PosedStep step(hexagons("joint"), 8);
    const auto kluft = step.solve_by_open_close(tolerance, balance, step.start());
    LoadedBody body = step.body();
    std::vector<InterfaceLaw> laws = *body.laws;
    for (InterfaceLaw& law : laws) law.shear_stiffness *= 1.001;
    body.laws = &laws;
    const Comparison result = compare(step, kluft.q, solve_by_minimisation(body, step.start()));
    EXPECT_GT(result.shear_forces, 1e-5);
    EXPECT_GT(result.displacements, 1e-5);
}

} // namespace
} // namespace kluft::oracle

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/equilibrium/open_close_solver.hpp"
#include "kluft/simulation/simulation.hpp"
#include "support/lattice_body.hpp"
#include "support/owned_problem.hpp"
#include "support/scene_run.hpp"
#include "support/slope_scene.hpp"
#include "support/units.hpp"

namespace kluft {
namespace {

/// In equilibrium to the end, without help of the mass-like term.
// ---- hexagons ------------------------------------------------------------------------------------------------------

/// Number of neighbours of each block, and whether it is a whole hexagon.
struct Neighbourhood {
    std::vector<int> neighbours, whole_neighbours;
    std::vector<char> whole;

    explicit Neighbourhood(const BlockSystem& system)
        : neighbours(system.blocks.size(), 0), whole_neighbours(system.blocks.size(), 0) {
        for (const Block& block : system.blocks) {
            whole.push_back(std::abs(block.area - hexagon_area(system.spacing)) < 1e-9 * block.area &&
                            block.edges.size() == 6);
        }
        for (const Interface& interface : system.interfaces) {
            for (const auto& [b, other] :
                 {std::pair(interface.block_a, interface.block_b), std::pair(interface.block_b, interface.block_a)}) {
                ++neighbours[b];
                if (whole[other]) ++whole_neighbours[b];
            }
        }
    }
    /// A whole hexagon amid six whole ones.
    [[nodiscard]] bool inside(int b) const { return whole[b] && whole_neighbours[b] == 6; }
};

/// A bonded body of hexagons with r = k_s/k_n whose outer blocks are moved as the infinite lattice under a uniform
/// stress moves: centroids by the strain of the lattice, blocks with their own strain.
class LatticePatch {
public:
    static constexpr double e = 10e9, nu = 0.25, d = 0.03, kn = 1e11;

    LatticePatch(double ratio, double rotation, const Mat2& stress)
        : law{.normal_stiffness = kn, .shear_stiffness = ratio * kn}, laws{law}, moduli{plane_moduli(e, nu,
                                                                                                     Plane::stress)} {
        GeometrySpec spec = hexagon_spec(10.3 * d, 9.7 * d, d);
        spec.tessellation->hexagons.rotation = rotation;
        system = cut_blocks(spec).system;
        // 2D moduli with theory (20), written out: strain = mean/(2K) + deviator/(2G).
        const double compliance_k = (1 - nu) / e;
        const double compliance_g = (1 + nu) / e;
        block_strain = strain(stress, compliance_k, compliance_g);
        body_strain = strain(stress, compliance_k + 1 / (d * kn), compliance_g + 2 / (d * kn * (1 + ratio)));
    }

    void solve() {
        const Neighbourhood hexagons(system);
        OwnedProblem problem;
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, {1}, at_rest(system));
        expected = at_rest(system);
        std::vector<PrescribedDisplacement> rows;
        for (int b = 0; b < system.n_blocks(); ++b) {
            set_motion(system, b, body_strain * system.blocks[b].centroid, block_strain, expected);
            if (hexagons.inside(b)) {
                free_blocks.push_back(b);
                continue;
            }
            for (const Vec2& xi : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}) {
                const Vec2 target = displacement_at(expected, b, xi);
                rows.push_back({b, xi, Vec2::UnitX(), 0, target.x()});
                rows.push_back({b, xi, Vec2::UnitY(), 0, target.y()});
            }
        }
        problem.loads.constraints = Constraints(rows);
        const BlockPattern pattern = pattern_of(problem);
        LinearSolver linear;
        linear.analyze(pattern);
        OpenCloseOptions options;
        options.tolerance = 1e-13;
        q = at_rest(system);
        summary = OpenCloseSolver(linear, options).solve(problem, pattern, q);
        bonds = problem.placement.bonds;
    }

    InterfaceLaw law;
    std::vector<InterfaceLaw> laws;
    std::vector<ElasticModuli> moduli;
    BlockSystem system;
    Mat2 block_strain, body_strain;
    std::vector<int> free_blocks;
    Eigen::VectorXd q, expected;
    OpenCloseSummary summary;
    std::vector<Bond> bonds;

private:
    static Mat2 strain(const Mat2& stress, double compliance_k, double compliance_g) {
        const Mat2 mean = 0.5 * stress.trace() * Mat2::Identity();
        return compliance_k * mean + compliance_g * (stress - mean);
    }
};

Mat2 uniaxial(double stress, double angle) {
    const Vec2 direction(std::cos(angle), std::sin(angle));
    return stress * direction * direction.transpose();
}

// Patch test: the free hexagons take the uniform state of the outer ones. The state is exact at any strain as long as
// no block turns, because P is then linear in D.
TEST(ClosedForms, PatchOfHexagonsTakesTheUniformStressOfTheLattice) {
    Mat2 stress;
    stress << -3e6, 1e6, 1e6, -7e6;
    for (const double ratio : {0.4, 1.0}) {
        for (const double rotation : {0.0, 17 * degree}) {
            LatticePatch patch(ratio, rotation, stress);
            patch.solve();
            ASSERT_TRUE(patch.summary.converged());
            ASSERT_GT(patch.free_blocks.size(), 10U);
            const auto stresses = block_stresses(patch.system, patch.moduli, patch.q);
            const Mat2 f = Mat2::Identity() + patch.block_strain;
            const Mat2 cauchy = stress * f.transpose() / f.determinant(); // P = stress, for R = I
            for (const int b : patch.free_blocks) {
                EXPECT_LT((stresses[b] - cauchy).norm(), 1e-10 * stress.norm()) << b;
            }
            EXPECT_LT((patch.q - patch.expected).norm(), 1e-10 * patch.expected.norm());
        }
    }
}

// t_n = s (1/2 + cos 2a/(1 + r)), t_s = s r sin 2a/(1 + r) with a from the face's normal to the load (theory, 21).
TEST(ClosedForms, FacesOfTheLatticeCarryTheTractionsOfTheCellUnderUniaxialStress) {
    const double s = -2e6, ratio = 0.4, load = 25 * degree;
    LatticePatch patch(ratio, 0.0, uniaxial(s, load));
    patch.solve();
    ASSERT_TRUE(patch.summary.converged());
    int compared = 0;
    for (const Bond& bond : patch.bonds) {
        if (std::ranges::find(patch.free_blocks, bond.block_a) == patch.free_blocks.end()) continue;
        const double a = load - std::atan2(bond.normal().y(), bond.normal().x());
        for (int k = 0; k < n_bond_points; ++k) {
            const auto traction = bond_traction(patch.law, bond, k, patch.q);
            EXPECT_NEAR(traction.normal, s * (0.5 + std::cos(2 * a) / (1 + ratio)), 1e-9 * std::abs(s));
            EXPECT_NEAR(traction.shear, s * ratio * std::sin(2 * a) / (1 + ratio), 1e-9 * std::abs(s));
            ++compared;
        }
    }
    EXPECT_GT(compared, 30);
}

// Cauchy: t = sigma n on every face where k_s = k_n, for then the cell's tractions are those of a continuum.
TEST(ClosedForms, FacesWithEqualStiffnessesCarryStressTimesNormal) {
    Mat2 stress;
    stress << -3e6, 1e6, 1e6, 2e6;
    LatticePatch patch(1.0, 9 * degree, stress);
    patch.solve();
    ASSERT_TRUE(patch.summary.converged());
    int compared = 0;
    for (const Bond& bond : patch.bonds) {
        if (std::ranges::find(patch.free_blocks, bond.block_a) == patch.free_blocks.end()) continue;
        for (int k = 0; k < n_bond_points; ++k) {
            const auto local = bond_traction(patch.law, bond, k, patch.q);
            const Vec2 traction = local.normal * bond.normal() + local.shear * bond.tangent;
            EXPECT_LT((traction - stress * bond.normal()).norm(), 1e-9 * stress.norm());
            ++compared;
        }
    }
    EXPECT_GT(compared, 30);
}

// Love-Weber over the whole body: whatever the net inside, the mean stress follows from the forces on the outline,
// here sigma_x = -1 MPa and sigma_y = -3 MPa without shear. Strains are of the order of 1e-4.
TEST(ClosedForms, MeanStressOfAnIrregularFracturedBodyIsTheAppliedStress) {
    const char* const scene = R"(
kluft: 1
materials: {rock: {youngs_modulus: 50 GPa, poissons_ratio: 0.25, cohesion: 1e9, friction_angle: 30, tensile_strength: 1e9}}
interfaces:
  joint: {kind: fracture, normal_stiffness_times_spacing: 200 GPa, shear_stiffness_times_spacing: 100 GPa, friction_angle: 40}
  bond: {kind: potential_crack, normal_stiffness_times_spacing: 500 GPa, shear_stiffness_times_spacing: 200 GPa, fails_to: joint}
geometry:
  domain: {rectangle: {width: 0.5, height: 0.8}}
  fractures: [{trace: [[-0.1, 0.03], [0.6, 0.73]], interface: joint}, {trace: [[-0.1, 0.5], [0.2, 0.33]], interface: joint}]
  tessellation: {hexagons: {spacing: 0.07, rotation: 11, jitter: 0.2, seed: 3}, interface: bond}
boundaries: {bottom: {support: pinned}}
stages: [{name: pressure, pressure: {left: 1 MPa, right: 1 MPa, top: 3 MPa}, steps: 2}]
solver: {tolerance: 1e-9, balance: 1e-7}
)";
    const auto run = run_scene(scene);
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    Mat2 sum = Mat2::Zero();
    double area = 0.0;
    double spread = 0.0;
    Mat2 applied;
    applied << -1e6, 0, 0, -3e6;
    for (int b = 0; b < run.model.system.n_blocks(); ++b) {
        sum += run.model.system.blocks[b].area * run.fields.back().stress[b];
        area += run.model.system.blocks[b].area;
        spread = std::max(spread, (run.fields.back().stress[b] - applied).norm());
    }
    EXPECT_LT((sum / area - applied).norm(), 5e-4 * applied.norm());
    EXPECT_GT(spread, 0.1 * applied.norm()); // the mean is not the mean of equals
}

// ---- rotation ------------------------------------------------------------------------------------------------------

struct TurnedBody {
    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.25, Plane::strain)};
    BlockSystem system = cut_blocks(hexagon_spec(0.5, 0.4, 0.1, {0.03, 0.04})).system;

    /// Internal forces at q, bonds in the frames of `frames`.
    [[nodiscard]] Residual forces(const Eigen::VectorXd& q, const Eigen::VectorXd& frames) const {
        OwnedProblem problem;
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, {1}, frames);
        const BlockPattern pattern = pattern_of(problem);
        Residual residual;
        EquilibriumEvaluator(problem, pattern).residual(q, residual);
        return residual;
    }
};

// x = Q X + c for any angle: neither strain nor opening. A linearised rotation by 90 degrees would double the area.
TEST(ClosedForms, BodyTurnedByAnyAngleIsFreeOfStressAndForce) {
    const TurnedBody body;
    const double stiffness = 10e9; // Pa, to compare stresses and forces per metre with
    for (const double angle : {0.1, 1.0, 0.5 * std::numbers::pi, 3.0, -2.0}) {
        const auto q = affine_motion(body.system, rotation_by(angle), {0.3, -0.2});
        for (const Mat2& stress : block_stresses(body.system, body.moduli, q))
            EXPECT_LT(stress.norm(), 1e-14 * stiffness);
        EXPECT_LT(body.forces(q, q).forces.lpNorm<Eigen::Infinity>(), 1e-14 * stiffness);
        for (int b = 0; b < body.system.n_blocks(); ++b) {
            EXPECT_NEAR(deformation_gradient(q, b, body.system.blocks[b].size).determinant(), 1.0, 1e-14);
        }
    }
}

// Objectivity: of a deformed body turned by Q the forces are Q f and the stresses Q sigma Q^T.
TEST(ClosedForms, StressAndForceTurnWithTheBody) {
    const TurnedBody body;
    cut_scenes::Uniform uniform(5);
    const auto q = random_motion(body.system, 2e-3, uniform);
    const Mat2 rotation = rotation_by(2.2);
    const auto q_turned = turned(body.system, q, rotation);
    const auto stress = block_stresses(body.system, body.moduli, q);
    const auto stress_turned = block_stresses(body.system, body.moduli, q_turned);
    for (int b = 0; b < body.system.n_blocks(); ++b) {
        EXPECT_LT((stress_turned[b] - rotation * stress[b] * rotation.transpose()).norm(), 1e-11 * stress[b].norm());
    }
    const Eigen::VectorXd forces = body.forces(q, q).forces;
    const Eigen::VectorXd forces_turned = body.forces(q_turned, q_turned).forces;
    for (Eigen::Index i = 0; i < forces.size(); i += 2) {
        EXPECT_LT((forces_turned.segment<2>(i) - rotation * forces.segment<2>(i)).norm(), 1e-11 * forces.norm());
    }
}

// ---- moduli --------------------------------------------------------------------------------------------------------

// Hooke, uniaxial stress: E' = E/(1 - nu^2) and nu' = nu/(1 - nu) in plane strain, E and nu in plane stress.
TEST(ClosedForms, UniaxialModulusIsLargerByPlaneStrainThanByPlaneStress) {
    const double e = 10e9, nu = 0.25;
    for (const bool plane_strain : {true, false}) {
        const auto run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: {}}}
materials: {{rock: {{youngs_modulus: {}, poissons_ratio: {}}}}}
geometry: {{domain: {{rectangle: {{width: 1.0, height: 2.0}}}}, reference_spacing: 1.0}}
boundaries: {{bottom: {{support: smooth}}}}
stages: [{{name: platen, strain: {{boundary: top, value: 1e-7}}, platens: smooth, steps: 1}}]
solver: {{tolerance: 1e-11, balance: 1e-9}}
)",
                                               plane_strain ? "strain" : "stress", e, nu));
        ASSERT_TRUE(stands(run)) << run.report.diagnosis;
        const StepRecord& last = run.history.back();
        const double modulus = plane_strain ? e / (1 - nu * nu) : e;
        const double ratio = plane_strain ? nu / (1 - nu) : nu;
        EXPECT_NEAR(last.axial_stress / last.axial_strain, modulus, 1e-6 * modulus);
        EXPECT_NEAR(-last.lateral_strain / last.axial_strain, ratio, 1e-6);
    }
}

// Springs in series: 1/E_m = 1/E_r + 1/(k_n s) = 1/(10 GPa) + 1/(10 GPa/m 1 m) = 1/(5 GPa) in plane stress.
TEST(ClosedForms, ColumnWithJointsAcrossItIsAsSoftAsItsSpringsInSeries) {
    const auto run = run_scene(R"(
kluft: 1
analysis: {plane: stress}
materials: {rock: {youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 10 GPa/m, shear_stiffness: 10 GPa/m, friction_angle: 30, contact_rounding: 0}}
geometry:
  domain: {rectangle: {width: 1.0, height: 4.0}}
  fractures:
    - {trace: [[-1, 0.5], [2, 0.5]], interface: joint}
    - {trace: [[-1, 1.5], [2, 1.5]], interface: joint}
    - {trace: [[-1, 2.5], [2, 2.5]], interface: joint}
    - {trace: [[-1, 3.5], [2, 3.5]], interface: joint}
  reference_spacing: 1.0
boundaries: {bottom: {support: smooth}}
stages: [{name: platen, strain: {boundary: top, value: 1e-6}, platens: smooth, steps: 1}]
solver: {tolerance: 1e-10, balance: 1e-8}
)");
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    ASSERT_EQ(run.model.system.n_interfaces(), 4);
    const StepRecord& last = run.history.back();
    EXPECT_NEAR(last.axial_stress / last.axial_strain, 5e9, 1e-5 * 5e9);
}

// ---- one joint -----------------------------------------------------------------------------------------------------

/// A joint of length 1 m between a fixed lower block and an upper one that is pushed along it at its left side. `top` is
/// what holds the upper block down, `interfaces` names the joint's law `joint`.
std::string direct_shear(const std::string& interfaces, const std::string& type, const std::string& top,
                         const std::string& first_stage, double push, int steps, double youngs_modulus = 1e11) {
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress}}
materials: {{rock: {{youngs_modulus: {}, poissons_ratio: 0}}}}
interfaces: {}
geometry:
  domain: {{polygon: [[0, 0], [1, 0], [1, 0.5], [1, 1], [0, 1], [0, 0.5]]}}
  fractures: [{{name: plane, trace: [[-1, 0.5], [2, 0.5]], interface: {}}}]
  reference_spacing: 1.0
boundaries:
  bottom: {{sides: [0], support: fixed}}
  lower_right: {{sides: [1]}}
  top: {{sides: [3], support: {}}}
  upper_left: {{sides: [4]}}
stages:
  {}
  - {{name: push, displacement: {{boundary: upper_left, value: {}}}, platens: smooth, steps: {}}}
cracks: {{criterion: interface_traction, event_tolerance: 1e-3}}
solver: {{tolerance: 1e-10, balance: 1e-8}}
)",
                       youngs_modulus, interfaces, type, top, first_stage, push, steps);
}

const char* const pressed_by_1_mpa = "- {name: press, pressure: {top: 1 MPa}, steps: 1}";

// Coulomb: tau = k_s v up to c + sigma tan(phi) = 1 + tan(30) = 1.5774 MPa, constant from there on.
TEST(ClosedForms, DirectShearRisesWithTheShearStiffnessAndSlipsAtCoulombsLimit) {
    const double ks = 1e9;
    const auto run = run_scene(direct_shear(
        "{joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30, cohesion: 1 MPa, "
        "cohesion_onset: 10, contact_rounding: 0, friction_rounding: 0.01}}",
        "joint", "none", pressed_by_1_mpa, 3e-3, 10));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    int sticking = 0, sliding = 0;
    for (std::size_t i = 2; i < run.fields.size(); ++i) {
        const auto& joint = run.fields[i].interfaces.front();
        const double push = 3e-3 * run.history[i].load_factor;
        const double pressure = 1e6 / (1.0 - push); // on what is left of the joint
        const double limit = 1e6 + pressure * std::tan(30 * degree);
        EXPECT_NEAR(-joint.normal_traction, pressure, 4e-4 * pressure); // points stand still in a step of 3e-4 m
        const double slip = std::abs(joint.slip); // the push less the shortening of the block, 1 % of it
        EXPECT_NEAR(slip, push, 1e-2 * push);
        EXPECT_NEAR(std::abs(joint.shear_traction), std::min(ks * slip, limit), 4e-4 * limit) << push;
        EXPECT_EQ(joint.state, ks * slip < limit ? ContactState::locked : ContactState::sliding) << push;
        ++(ks * slip < limit ? sticking : sliding);
    }
    EXPECT_GE(sticking, 3);
    EXPECT_GE(sliding, 3);
}

// Peak c + sigma tan(phi) = 1.5774 MPa of the bond, then sigma tan(phi) = 0.5774 MPa of the fracture without cohesion.
TEST(ClosedForms, BondedJointFallsFromItsPeakToItsResidualStrengthInDirectShear) {
    const auto run = run_scene(
        direct_shear("{joint: {kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30, "
                     "contact_rounding: 0, friction_rounding: 0}, "
                     "bond: {kind: potential_crack, normal_stiffness: 1e11, shear_stiffness: 1e11, fails_to: joint, "
                     "cohesion: 1 MPa, friction_angle: 30, tensile_strength: 0.5 MPa}}",
                     "bond", "none", pressed_by_1_mpa, 3e-5, 7));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    double peak = 0.0; // the platen's force over its joint of 1 m: all shear is the push
    for (const auto& record : run.equilibria) {
        if (record.stage == 1) peak = std::max(peak, record.axial_stress);
    }
    ASSERT_EQ(run.cracks.size(), 1U);
    EXPECT_EQ(run.cracks.front().mode, CrackMode::shear);
    EXPECT_NEAR(peak, 1e6 + 1e6 * std::tan(30 * degree), 2e-3 * 1.58e6);
    EXPECT_NEAR(std::abs(run.fields.back().interfaces.front().shear_traction), 1e6 * std::tan(30 * degree), 1e2);
}

const char* const dilatant =
    "{joint: {kind: fracture, normal_stiffness: 1e9, shear_stiffness: 1e9, friction_angle: 30, dilation_angle: 10, "
    "contact_rounding: 0, friction_rounding: 0}}";

// Under constant normal stress the joint opens by the plastic slip times tan(psi): slip - tau/k_s, tau = sigma tan(phi).
TEST(ClosedForms, DilatantJointOpensByItsPlasticSlipTimesTheTangentOfDilation) {
    const double k = 1e9, tan_phi = std::tan(30 * degree), tan_psi = std::tan(10 * degree);
    const auto run = run_scene(direct_shear(dilatant, "joint", "none", pressed_by_1_mpa, 5e-3, 10));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    const auto& start = run.fields[1].interfaces.front();
    // The pressure of 1 MPa on 1 m rests on what is left of the joint; contacts are those of the last step's start.
    const double overlap = 1.0 - 5e-3;
    const auto& end = run.fields.back().interfaces.front();
    const double stress = 1e6 / overlap;
    EXPECT_NEAR(-end.normal_traction, stress, 1e-3 * stress);
    EXPECT_NEAR(std::abs(end.shear_traction), stress * tan_phi, 1e-3 * stress);
    const double plastic = std::abs(end.slip) - stress * tan_phi / k;
    EXPECT_GT(plastic, 4e-3);
    const double sinking = (stress - 1e6) / k; // of the joint, by the shorter overlap
    EXPECT_NEAR(end.gap - start.gap, plastic * tan_psi - sinking, 2e-3 * plastic * tan_psi);
}

// Between platens at a fixed distance: d sigma = u_plastic tan(psi)/(1/K + 1/k_n), K = E/H the stiffness of both blocks.
TEST(ClosedForms, DilationAgainstConstantStiffnessRaisesTheNormalStress) {
    const double k = 1e9, e = 1e10, tan_psi = std::tan(10 * degree);
    const auto run = run_scene(direct_shear(dilatant, "joint", "smooth", "", 2e-3, 8, e));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    for (std::size_t i = 3; i < run.fields.size(); ++i) {
        const auto& joint = run.fields[i].interfaces.front();
        const double plastic = std::abs(joint.slip) - std::abs(joint.shear_traction) / k;
        const double expected = plastic * tan_psi / (1.0 / e + 1.0 / k);
        EXPECT_GT(expected, 2e4);
        EXPECT_NEAR(-joint.normal_traction, expected, 5e-3 * expected) << run.history[i].load_factor;
        EXPECT_NEAR(std::abs(joint.shear_traction), -joint.normal_traction * std::tan(30 * degree), 1e-6 * expected);
    }
}

// ---- blocks under their weight -------------------------------------------------------------------------------------

// Statics: N = W cos(slope), T = W sin(slope) below the friction angle.
TEST(ClosedForms, BlockAtRestOnASlopeCarriesItsWeightAcrossAndAlongTheJoint) {
    const double weight = 2500.0 * 10.0 * 4.0 * 1.0;
    for (const double slope : {0.0, 12.0, 29.0}) {
        const auto run = run_scene(block_on_slope(4.0, 1.0, slope));
        ASSERT_TRUE(stands(run)) << slope;
        const auto& joint = run.fields.back().interfaces.front();
        EXPECT_NEAR(-joint.normal_traction * 4.0, weight * std::cos(slope * degree), 1e-5 * weight);
        EXPECT_NEAR(std::abs(joint.shear_traction) * 4.0, weight * std::sin(slope * degree), 1e-5 * weight);
    }
}

// It topples where the weight passes outside the corner, tan(slope) > width/height = 1/3, that is above 18.435 degrees.
TEST(ClosedForms, SlenderBlockOnASlopeTopplesWhereItsWeightPassesItsCorner) {
    EXPECT_TRUE(stands(run_scene(block_on_slope(0.5, 1.5, 18.40))));
    EXPECT_FALSE(stands(run_scene(block_on_slope(0.5, 1.5, 18.47))));
}

// A pressure p on its side of height H pushes a block of width b at H/2: it turns over at p H = W b/H, where that is less
// than what friction holds, W tan(phi), and slides there otherwise.
TEST(ClosedForms, BlockPushedAtItsSideTurnsOverOrSlidesWhicheverNeedsLess) {
    for (const auto& [width, height] : {std::pair(0.5, 1.5), std::pair(1.5, 0.5)}) {
        const double weight = 2500.0 * 10.0 * width * height;
        const double turning = weight * width / height, sliding = weight * std::tan(30 * degree);
        const double limit = std::min(turning, sliding) / height;
        for (const double share : {0.99, 1.01}) {
            const auto run = run_scene(block_on_slope(width, height, 0.0),
                                       {fmt::format("stages.0.pressure={{left: {:.17g}}}", share * limit)});
            EXPECT_EQ(stands(run), share < 1.0) << width;
        }
    }
}

// Statics without friction: N = W/(2 cos(alpha)) on each face of a symmetric groove.
TEST(ClosedForms, WedgeInASmoothGroovePressesOnItsFacesWithHalfItsWeightOverTheCosine) {
    const double alpha = 40 * degree;
    const auto run = run_scene(fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: 10}}
materials: {{rock: {{density: 2500, youngs_modulus: 1e11, poissons_ratio: 0}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, contact_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: 2, height: 2}}}}
  fractures: [{{trace: [[-0.5, {0:.17g}], [1, 0.5], [2.5, {0:.17g}]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: weight, steps: 1}}]
solver: {{tolerance: 1e-10, balance: 1e-7}}
)",
                                           0.5 + 1.5 * std::tan(alpha)));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    ASSERT_EQ(run.model.system.n_interfaces(), 2);
    const double weight = 2500.0 * 10.0 * (4.0 - 2.0 * (0.5 + 0.5 * std::tan(alpha))); // less the rock below the groove
    for (const auto& face : run.fields.back().interfaces) {
        EXPECT_NEAR(-face.normal_traction * (1.0 / std::cos(alpha)), weight / (2.0 * std::cos(alpha)), 1e-3 * weight);
        EXPECT_NEAR(face.shear_traction, 0.0, 1e-9 * weight);
    }
}

// ---- plane of weakness ---------------------------------------------------------------------------------------------

// Jaeger: p1 - p3 = 2 (c + p3 tan(phi))/((1 - tan(phi) cot(beta)) sin(2 beta)) for beta > phi, beta from p1 to the normal.
TEST(ClosedForms, StrengthOfAPlaneOfWeaknessFollowsJaegersCurve) {
    const double c = 0.1e6, phi = 30 * degree, p3 = 0.2e6, width = 0.5, height = 4.0;
    for (const double beta_degrees : {25.0, 40.0, 70.0, 80.0}) {
        const double beta = beta_degrees * degree;
        const double rise = (width + 0.4) * std::tan(beta) / 2;
        const auto run =
            run_scene(fmt::format(R"(
kluft: 1
materials: {{rock: {{youngs_modulus: 50 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30, cohesion: {}, cohesion_onset: 10, contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: {}, height: {}}}}}
  fractures: [{{name: plane, trace: [[-0.2, {:.17g}], [{}, {:.17g}]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: smooth}}}}
stages:
  - {{name: pressure, pressure: {{left: {}, right: {}, top: {}}}, steps: 1}}
  - {{name: platen, strain: {{boundary: top, value: 1e-4}}, platens: smooth, steps: 20}}
solver: {{tolerance: 1e-9, balance: 1e-7}}
)",
                                  c, width, height, height / 2 - rise, width + 0.2, height / 2 + rise, p3, p3, p3));
        ASSERT_TRUE(stands(run)) << run.report.diagnosis;
        const StepRecord& last = run.history.back();
        const auto& joint = run.fields.back().interfaces.front();
        if (beta <= phi) { // no slip at any stress
            EXPECT_EQ(joint.state, ContactState::locked);
            EXPECT_GT(last.differential_stress, 4e6);
            continue;
        }
        const double expected =
            2 * (c + p3 * std::tan(phi)) / ((1 - std::tan(phi) / std::tan(beta)) * std::sin(2 * beta));
        EXPECT_EQ(joint.state, ContactState::sliding);
        EXPECT_NEAR(last.differential_stress, expected, 2e-3 * expected) << beta_degrees;
    }
}

} // namespace
} // namespace kluft

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/equilibrium/open_close_solver.hpp"
#include "support/lattice_body.hpp"
#include "support/owned_problem.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

/// A small body of rigid hexagons with two fractures, in a state where every block has turned.
struct RigidBody {
    static constexpr int bond = 0, joint = 1;

    explicit RigidBody(std::uint64_t seed, double turn) : uniform(seed) {
        GeometrySpec spec = hexagon_spec(0.5, 0.4, 0.1, {0.03, 0.04}, bond);
        cut_scenes::add_trace(spec, {{-0.1, 0.1}, {0.6, 0.33}}, joint);
        system = cut_blocks(spec).system;
        q = affine_motion(system, rotation_by(turn));
        Eigen::VectorXd motion(n_rigid_unknowns * system.n_blocks());
        for (double& value : motion) value = uniform(-3e-4, 3e-4);
        const Eigen::VectorXd frames = q;
        move_rigid(system, motion, 1.0, q);
        problem.body.kinematics = Kinematics::rigid;
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, {1, 0}, frames);
        problem.placement.contacts = detect_contacts(system, surfaces_of(system, {1, 0}, laws), q, 0.01, {}).points;
        for (auto& point : problem.placement.contacts) point.history.shear_trial = uniform(-2e6, 2e6);
        problem.start = frames;
        problem.eta.assign(system.blocks.size(), 0.0);
        for (double& eta : problem.eta) eta = uniform(1e9, 1e11);
        problem.set_density(2500.0);
        problem.loads.gravity = {1.5, -9.0};
        for (int boundary = 0; boundary < 4; ++boundary) {
            const auto more = pressure_edges(system, boundary);
            problem.loads.pressure_edges.insert(problem.loads.pressure_edges.end(), more.begin(), more.end());
        }
        problem.loads.pressures = {1e8, 2e8, 3e8, 4e8};
    }

    Uniform uniform;
    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10},
                                   {.normal_stiffness = 1e10,
                                    .shear_stiffness = 5e9,
                                    .tan_friction = 0.5,
                                    .contact_rounding = 2e5,
                                    .friction_rounding = 0.1}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.2, Plane::strain)};
    BlockSystem system;
    Eigen::VectorXd q;
    OwnedProblem problem;
};

// Central differences of T' R along the motions of the blocks, at rotations of any size.
TEST(RigidBlocks, ExactTangentIsTheDerivativeOfTheForcesOnThreeUnknowns) {
    for (const double turn : {0.0, 0.7, 2.5}) {
        RigidBody body(3, turn);
        const BlockPattern pattern = pattern_of(body.problem);
        EquilibriumEvaluator evaluator(body.problem, pattern);
        BlockMatrix matrix;
        evaluator.tangent(body.q, TangentKind::exact, matrix);
        const int n = n_rigid_unknowns * body.system.n_blocks();
        const auto forces_after = [&](int unknown, double step) {
            Eigen::VectorXd motion = Eigen::VectorXd::Zero(n);
            motion[unknown] = step;
            Eigen::VectorXd q = body.q;
            move_rigid(body.system, motion, 1.0, q);
            Residual residual;
            evaluator.reduced_residual(q, residual);
            return residual.forces;
        };
        double largest = 0.0, error = 0.0;
        Eigen::VectorXd column;
        for (int i = 0; i < n; ++i) {
            matrix.multiply(Eigen::VectorXd::Unit(n, i), column);
            const double h = 1e-8;
            const Eigen::VectorXd expected = (forces_after(i, h) - forces_after(i, -h)) / (2 * h);
            largest = std::max(largest, expected.cwiseAbs().maxCoeff());
            error = std::max(error, (column - expected).cwiseAbs().maxCoeff());
        }
        EXPECT_LT(error, 1e-6 * largest) << turn;
    }
}

// det R = 1: the determinant after 90 degrees in steps is exact, whether the motion is given or solved for.
TEST(RigidBlocks, BlockTurnedByARightAngleInStepsKeepsItsArea) {
    GeometrySpec spec = cut_scenes::rectangle(2.0, 1.0);
    const BlockSystem system = cut_blocks(spec).system;
    ASSERT_EQ(system.n_blocks(), 1);
    const double size = system.blocks[0].size;
    const std::vector<InterfaceLaw> laws(1);
    const std::vector<ElasticModuli> moduli{plane_moduli(1e9, 0.2, Plane::strain)};
    OwnedProblem problem;
    problem.body.kinematics = Kinematics::rigid;
    problem.body.system = &system;
    problem.body.moduli = &moduli;
    problem.body.laws = &laws;
    problem.eta = {1e6};
    problem.set_density(2500.0);
    problem.loads.gravity = {0.0, -10.0};
    const BlockPattern pattern = pattern_of(problem);
    LinearSolver linear;
    linear.analyze(pattern);
    OpenCloseOptions options;
    options.motion_limit = 1e3;
    options.max_iterations = 50;
    OpenCloseSolver solver(linear, options);
    Eigen::VectorXd q = at_rest(system);
    constexpr int n_steps = 9;
    for (int step = 1; step <= n_steps; ++step) {
        const Mat2 target = rotation_by(step * 0.5 * std::numbers::pi / n_steps) - Mat2::Identity();
        std::vector<PrescribedDisplacement> rows;
        for (const Vec2& xi : {Vec2(0, 0), Vec2(0.5, 0.2)}) {
            const Vec2 u = size * target * xi;
            rows.push_back({0, xi, Vec2::UnitX(), 0, u.x()});
            rows.push_back({0, xi, Vec2::UnitY(), 0, u.y()});
        }
        problem.loads.constraints = Constraints(rows, system, q);
        problem.start = q;
        const auto summary = solver.solve(problem, pattern, q);
        ASSERT_TRUE(summary.converged()) << step;
        EXPECT_NEAR(deformation_gradient(q, 0, size).determinant(), 1.0, 1e-15);
    }
    EXPECT_NEAR(rotation_of(q, 0, size), 0.5 * std::numbers::pi, 1e-12);
}

/// A patch of rigid hexagons whose outer blocks move by a uniform strain.
struct RigidPatch {
    static constexpr double e = 10e9, nu = 0.15, d = 0.03;

    RigidPatch(Plane plane, const Mat2& strain) {
        const InterfaceStiffness stiffness = rigid_lattice_stiffness(e, nu, plane, hexagon_net(d));
        laws = {{.normal_stiffness = stiffness.normal, .shear_stiffness = stiffness.shear}};
        moduli = {plane_moduli(e, nu, plane)};
        system = cut_blocks(hexagon_spec(10.3 * d, 9.7 * d, d)).system;
        problem.body.kinematics = Kinematics::rigid;
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, {1}, at_rest(system));
        std::vector<int> whole_neighbours(system.blocks.size(), 0);
        const auto whole = [&](int b) {
            return system.blocks[b].edges.size() == 6 &&
                   std::abs(system.blocks[b].area - 0.5 * std::sqrt(3.0) * d * d) < 1e-9 * d * d;
        };
        for (const Interface& i : system.interfaces) {
            if (whole(i.block_b)) ++whole_neighbours[i.block_a];
            if (whole(i.block_a)) ++whole_neighbours[i.block_b];
        }
        std::vector<PrescribedDisplacement> rows;
        for (int b = 0; b < system.n_blocks(); ++b) {
            if (whole(b) && whole_neighbours[b] == 6) {
                free_blocks.push_back(b);
                continue;
            }
            const Vec2 u = strain * system.blocks[b].centroid;
            rows.push_back({b, {0, 0}, Vec2::UnitX(), 0, u.x()});
            rows.push_back({b, {0, 0}, Vec2::UnitY(), 0, u.y()});
            rows.push_back({b, {1, 0}, Vec2::UnitY(), 0, u.y()});
        }
        q = at_rest(system);
        problem.loads.constraints = Constraints(rows, system, q);
    }

    std::vector<InterfaceLaw> laws;
    std::vector<ElasticModuli> moduli;
    BlockSystem system;
    OwnedProblem problem;
    std::vector<int> free_blocks;
    Eigen::VectorXd q;
};

// Hooke's law of the rock, strain -> stress, from interfaces with k_n d = 2K and k_s d = 4G - 2K alone; the stress is
// the mean stress of the forces on a block.
TEST(RigidBlocks, LatticeOfRigidHexagonsHasTheModuliOfTheRock) {
    Mat2 strain;
    strain << -3e-7, 1e-7, 1e-7, -1e-7;
    for (const Plane plane : {Plane::strain, Plane::stress}) {
        RigidPatch patch(plane, strain);
        ASSERT_GT(patch.free_blocks.size(), 10U);
        const BlockPattern pattern = pattern_of(patch.problem);
        for (const bool reuse : {true, false}) {
            LinearSolver linear;
            linear.analyze(pattern);
            OpenCloseOptions options;
            options.tolerance = 1e-13;
            options.reuse = reuse;
            Eigen::VectorXd q = patch.q;
            ASSERT_TRUE(OpenCloseSolver(linear, options).solve(patch.problem, pattern, q).converged());
            const ElasticModuli& rock = patch.moduli.front();
            const Mat2 expected = 2 * rock.mu * strain + rock.lambda * strain.trace() * Mat2::Identity();
            const auto stresses = block_stresses(patch.problem.body, q);
            for (const int b : patch.free_blocks) {
                EXPECT_LT((stresses[b] - expected).norm(), 1e-6 * expected.norm());
                EXPECT_NEAR(rotation_of(q, b, patch.system.blocks[b].size), 0.0, 1e-6 * strain.norm());
            }
        }
    }
}

// k_n d = 2K and k_s d = 4G - 2K: for nu = 1/4 in plane strain and 1/3 in plane stress k_s would be zero.
TEST(RigidBlocks, InterfacesOfRigidHexagonsExistForSmallPoissonsRatiosOnly) {
    const auto back = rigid_lattice_moduli(rigid_lattice_stiffness(5e9, 0.2, Plane::strain, hexagon_net(0.1)),
                                           hexagon_net(0.1), Plane::strain);
    EXPECT_NEAR(back.youngs_modulus, 5e9, 1e-3);
    EXPECT_NEAR(back.poissons_ratio, 0.2, 1e-12);
    EXPECT_NO_THROW((void)rigid_lattice_stiffness(5e9, 0.249, Plane::strain, hexagon_net(0.1)));
    EXPECT_THROW((void)rigid_lattice_stiffness(5e9, 0.25, Plane::strain, hexagon_net(0.1)), InputError);
    EXPECT_NO_THROW((void)rigid_lattice_stiffness(5e9, 0.33, Plane::stress, hexagon_net(0.1)));
    EXPECT_THROW((void)rigid_lattice_stiffness(5e9, 0.34, Plane::stress, hexagon_net(0.1)), InputError);
}

} // namespace
} // namespace kluft

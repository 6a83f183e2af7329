#include "kluft/equilibrium/open_close_solver.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "support/lattice_body.hpp"
#include "support/owned_problem.hpp"

namespace kluft {
namespace {

/// A body of hexagons cut by a fracture, pressed from the right; its bottom rests on a smooth support with one vertex
/// held, its top is moved by a platen.
struct PressedBody {
    static constexpr int bond = 0, joint = 1;

    explicit PressedBody(bool travelling, std::vector<char> is_bond) {
        GeometrySpec spec = hexagon_spec(0.5, 0.6, 0.1, {0.03, 0.04}, bond);
        cut_scenes::add_trace(spec, {{-0.1, 0.25}, {0.6, 0.4}}, joint);
        system = cut_blocks(spec).system;
        problem.body.system = &system;
        problem.body.moduli = &moduli;
        problem.body.laws = &laws;
        problem.placement.bonds = bonds_at(system, is_bond, at_rest(system));
        if (!is_bond[joint]) {
            problem.placement.contacts =
                detect_contacts(system, surfaces_of(system, is_bond, laws), at_rest(system), 0.01, {}).points;
        }
        problem.loads.pressure_edges = pressure_edges(system, 1);
        problem.loads.pressures = {0.0, 2e6, 0.0, 0.0};
        std::vector<PrescribedDisplacement> rows;
        add_rows(0, 0.0, 0.0, rows);
        rows.push_back({rows.front().block, rows.front().xi, Vec2::UnitX(), 0, 0.0});
        rows.push_back({rows[2].block, rows[2].xi, Vec2::UnitX(), 0, 0.0});
        add_rows(2, travelling ? 0.0 : -4e-4, travelling ? -1.0 : 0.0, rows);
        problem.loads.constraints = Constraints(rows);
        if (travelling) {
            problem.loads.platen_force = width_across(system, 2);
            problem.loads.platen_force->stress = 5e6;
        }
    }

    OpenCloseSummary solve(Eigen::VectorXd& q, OpenCloseOptions options = {}) const {
        const BlockPattern pattern = pattern_of(problem);
        LinearSolver linear;
        linear.analyze(pattern);
        return OpenCloseSolver(linear, options).solve(problem, pattern, q, true);
    }

    std::vector<InterfaceLaw> laws{{.normal_stiffness = 1e11, .shear_stiffness = 4e10},
                                   {.normal_stiffness = 5e10,
                                    .shear_stiffness = 2e10,
                                    .tan_friction = 0.6,
                                    .contact_rounding = 1e5,
                                    .friction_rounding = 0.1}};
    std::vector<ElasticModuli> moduli{plane_moduli(10e9, 0.25, Plane::strain)};
    BlockSystem system;
    OwnedProblem problem;

private:
    void add_rows(int boundary, double target, double rate, std::vector<PrescribedDisplacement>& rows) const {
        for (const auto& [b, e] : system.boundaries[boundary].edges) {
            const Edge& edge = system.blocks[b].edges[e];
            for (const Vec2& x : {edge_start(system, edge), edge_end(system, edge)}) {
                rows.push_back({b, block_coordinates(system.blocks[b], x), Vec2::UnitY(), boundary, target, rate});
            }
        }
    }
};

/// The same equilibrium by another method: Newton on the dense system with a Lagrange multiplier for every row and the
/// travel of the platen as an unknown, without projection, limits or search. The start is near enough.
Eigen::VectorXd dense_equilibrium(const OwnedProblem& problem, Eigen::VectorXd q) {
    const BlockPattern pattern = pattern_of(problem);
    EquilibriumEvaluator evaluator(problem, pattern);
    const auto& rows = problem.loads.constraints.rows();
    const Eigen::Index n = q.size(), m = static_cast<Eigen::Index>(rows.size());
    const bool travels = problem.loads.platen_force.has_value();
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(m, n);
    Eigen::VectorXd rate(m), target(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        c.block<1, 6>(i, 6 * rows[i].block) = displacement_row(rows[i].direction, rows[i].xi).transpose();
        rate[i] = rows[i].rate;
        target[i] = rows[i].target;
    }
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(m);
    double travel = 0.0;
    for (int iteration = 0; iteration < 30; ++iteration) {
        Residual residual;
        BlockMatrix matrix;
        evaluator.residual(q, residual);
        evaluator.tangent(q, TangentKind::exact, matrix);
        Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m + 1, n + m + 1);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n + m + 1);
        system.topLeftCorner(n, n) = dense(matrix);
        system.block(0, n, n, m) = c.transpose();
        system.block(n, 0, m, n) = c;
        system.block(n, n + m, m, 1) = -rate;
        right.head(n) = -(residual.forces + c.transpose() * multipliers);
        right.segment(n, m) = target + rate * travel - c * q;
        if (travels) { // the platen is in balance: -rate . multipliers = stress (width + widening . q)
            const PlatenForce& force = *problem.loads.platen_force;
            system.block(n + m, n, 1, m) = -rate.transpose();
            system.block(n + m, 0, 1, n) = -force.stress * force.widening.transpose();
            right[n + m] = force.at(q) + rate.dot(multipliers);
        } else {
            system(n + m, n + m) = 1.0;
        }
        const Eigen::VectorXd step = Eigen::PartialPivLU<Eigen::MatrixXd>(system).solve(right);
        q += step.head(n);
        multipliers += step.segment(n, m);
        travel += step[n + m];
    }
    return q;
}

TEST(OpenCloseSolver, FindsTheEquilibriumOfTheDenseSystemWithLagrangeMultipliers) {
    for (const bool travelling : {false, true}) {
        for (const bool fractured : {false, true}) {
            const PressedBody body(travelling, {1, fractured ? char{0} : char{1}});
            Eigen::VectorXd q = at_rest(body.system);
            OpenCloseOptions options;
            options.tolerance = 1e-12;
            options.max_iterations = 40;
            ASSERT_TRUE(body.solve(q, options).converged()) << travelling << fractured;
            const Eigen::VectorXd expected =
                dense_equilibrium(body.problem, q + 1e-7 * Eigen::VectorXd::Ones(q.size()));
            EXPECT_GT(q.norm(), 1e-3);
            EXPECT_LT((q - expected).norm(), 1e-9 * q.norm()) << travelling << fractured;
        }
    }
}

// The symmetric tangent takes other steps to the same place.
TEST(OpenCloseSolver, SymmetricTangentLeadsToTheSameEquilibrium) {
    for (const bool travelling : {false, true}) {
        const PressedBody body(travelling, {1, 0});
        OpenCloseOptions options;
        options.tolerance = 1e-11;
        options.max_iterations = 200;
        options.reuse = false; // Newton's increments exactly
        Eigen::VectorXd exact = at_rest(body.system), symmetric = exact;
        const auto with_exact = body.solve(exact, options);
        options.tangent = TangentKind::symmetric;
        const auto with_symmetric = body.solve(symmetric, options);
        ASSERT_TRUE(with_exact.converged() && with_symmetric.converged());
        EXPECT_GT(with_symmetric.iterations, with_exact.iterations);
        EXPECT_LT((symmetric - exact).norm(), 1e-7 * exact.norm());
    }
}

// By hand: the platen's force is the stress times the current width, and what its rows carry is that force.
TEST(OpenCloseSolver, ReactionOfATravellingPlatenIsItsForce) {
    const PressedBody body(true, {1, 0});
    OpenCloseOptions options;
    options.tolerance = 1e-12;
    options.max_iterations = 40;
    Eigen::VectorXd q = at_rest(body.system);
    ASSERT_TRUE(body.solve(q, options).converged());
    Residual residual;
    const BlockPattern pattern = pattern_of(body.problem);
    EquilibriumEvaluator(body.problem, pattern).residual(q, residual);
    const double width = 0.5 + mean_displacement(body.system, q, 1).x() - mean_displacement(body.system, q, 3).x();
    EXPECT_NE(width, 0.5);
    EXPECT_NEAR(body.problem.loads.constraints.reaction(residual.forces, 2).y(), -5e6 * width, 1e-6 * 5e6);
    // Statics of the whole body: the bottom carries the platen's force and the pressure on the right side.
    Vec2 loads(0.0, -5e6 * width);
    for (const PressureEdge& edge : body.problem.loads.pressure_edges) loads += pressure_force(edge, 2e6, q);
    EXPECT_LT((body.problem.loads.constraints.reaction(residual.forces, 0) + loads).norm(), 1e-6 * 5e6);
}

// A linear problem (bonded, without rotation or pressure) takes one solution.
TEST(OpenCloseSolver, BondedColumnIsSolvedAtOnce) {
    PressedBody body(false, {1, 1});
    body.problem.loads.pressures.assign(4, 0.0);
    Eigen::VectorXd q = at_rest(body.system);
    const auto summary = body.solve(q);
    EXPECT_TRUE(summary.converged());
    EXPECT_LE(summary.iterations, 2); // a second one for the little rotations of the blocks
}

// Newton with an exact tangent, that of the platen's force by the width included: each iteration squares the error.
TEST(OpenCloseSolver, BondedBodyUnderATravellingPlatenConvergesQuadratically) {
    PressedBody body(true, {1, 1});
    body.problem.loads.platen_force->stress = 5e7; // 0.5 % of E: an error of the tangent shows
    const auto ratio_after = [&](int iterations) {
        OpenCloseOptions options;
        options.reuse = false; // linear solves to round-off
        options.motion_limit = 1.0;
        options.tolerance = 1e-15;
        options.max_iterations = iterations;
        Eigen::VectorXd q = at_rest(body.system);
        return body.solve(q, options).residual_ratio;
    };
    const double second = ratio_after(2), third = ratio_after(3);
    EXPECT_GT(second, 1e-7);
    EXPECT_LT(third, 20.0 * second * second);
}

TEST(OpenCloseSolver, NoBlockMovesByMoreThanTheLimitInOneIteration) {
    PressedBody body(false, {1, 1});
    body.problem.loads.pressures[1] = 2e9;
    OpenCloseOptions options;
    options.max_iterations = 1;
    options.motion_limit = 0.02;
    Eigen::VectorXd q = at_rest(body.system);
    const auto summary = body.solve(q, options);
    EXPECT_EQ(summary.termination, Termination::max_iterations);
    double largest = 0.0;
    for (int b = 0; b < body.system.n_blocks(); ++b) {
        largest = std::max({largest, q.segment<2>(6 * b).norm(), q.segment<4>(6 * b + 2).norm()});
    }
    EXPECT_NEAR(largest, 0.02 * body.system.spacing, 1e-12); // the increment was longer
}

TEST(OpenCloseSolver, BodyThatNothingHoldsHasNoEquilibrium) {
    PressedBody body(false, {1, 1});
    body.problem.loads.constraints = Constraints();
    Eigen::VectorXd q = at_rest(body.system);
    EXPECT_FALSE(body.solve(q).converged());
}

} // namespace
} // namespace kluft

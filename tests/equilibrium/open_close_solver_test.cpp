#include "kluft/equilibrium/open_close_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/equilibrium/left_over.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "support/dense_solution.hpp"
#include "support/pressed_body.hpp"

namespace kluft {
namespace {

OpenCloseSummary solve(const PressedBody& body, Eigen::VectorXd& q, const OpenCloseOptions& options = {}) {
    const BlockPattern pattern = pattern_of(body.problem);
    LinearSolver linear;
    linear.analyze(pattern);
    return OpenCloseSolver(linear, options).solve(body.problem, pattern, q, {.unloaded = true});
}

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
        const Eigen::VectorXd step = dense_solution(system, right);
        q += step.head(n);
        multipliers += step.segment(n, m);
        travel += step[n + m];
    }
    return q;
}

TEST(SlowOpenCloseSolver, FindsTheEquilibriumOfTheDenseSystemWithLagrangeMultipliers) {
    for (const bool travelling : {false, true}) {
        for (const bool fractured : {false, true}) {
            const PressedBody body(travelling, {1, fractured ? char{0} : char{1}});
            Eigen::VectorXd q = at_rest(body.system);
            OpenCloseOptions options;
            options.tolerance = 1e-12;
            options.max_iterations = 40;
            ASSERT_TRUE(solve(body, q, options).converged()) << travelling << fractured;
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
        const auto with_exact = solve(body, exact, options);
        options.tangent = TangentKind::symmetric;
        const auto with_symmetric = solve(body, symmetric, options);
        ASSERT_TRUE(with_exact.converged() && with_symmetric.converged());
        EXPECT_GT(with_symmetric.iterations, with_exact.iterations);
        EXPECT_LT((symmetric - exact).norm(), 1e-7 * exact.norm());
    }
}

// What a solve has nothing to do about is put right by one that is asked for a share of the tolerance, however coarse that is.
TEST(OpenCloseSolver, AskedForAShareOfItsToleranceItLeavesAShareOfTheForces) {
    const PressedBody body(false, {1, 0});
    const BlockPattern pattern = pattern_of(body.problem);
    LinearSolver linear;
    linear.analyze(pattern);
    OpenCloseSolver solver(linear, {.tolerance = 1e-2});
    Eigen::VectorXd q = at_rest(body.system);
    ASSERT_TRUE(solver.solve(body.problem, pattern, q, {.unloaded = true}).converged());
    EXPECT_EQ(solver.solve(body.problem, pattern, q, {}).iterations, 0);
    const OpenCloseSummary sharper = solver.solve(body.problem, pattern, q, {.tolerance_share = 1e-7});
    EXPECT_TRUE(sharper.converged());
    EXPECT_LE(sharper.residual_ratio, 1e-9);
}

// A block beside the fracture is moved by so little that the body as a whole still meets the tolerance; it and those that it
// pushes do not. They are put right without a linear solve of all blocks, to the equilibrium that is found without the move.
TEST(OpenCloseSolver, SingleBlocksAreBalancedByThemselves) {
    PressedBody body(false, {1, 0}, Kinematics::affine, 0.03);
    body.problem.loads.pressures.assign(4, 0.0);
    const BlockPattern pattern = pattern_of(body.problem);
    LinearSolver linear;
    linear.analyze(pattern);
    Eigen::VectorXd q = at_rest(body.system);
    const OpenCloseSummary first = OpenCloseSolver(linear, {.tolerance = 1e-11, .max_iterations = 40})
                                       .solve(body.problem, pattern, q, {.unloaded = true});
    ASSERT_TRUE(first.converged()) << first.residual_ratio << " " << first.iterations;
    const int moved = body.problem.placement.contacts[body.problem.placement.contacts.size() / 2].block_a;
    Eigen::VectorXd disturbed = q;
    disturbed.segment<2>(6 * moved) += Vec2(1e-9, 1e-9);
    const OpenCloseOptions options{.tolerance = 1e-3};
    const double block_tolerance = 1e-8;
    Eigen::VectorXd as_it_is = disturbed;
    EXPECT_EQ(OpenCloseSolver(linear, options).solve(body.problem, pattern, as_it_is).iterations, 0);
    EXPECT_EQ(as_it_is, disturbed);
    const OpenCloseSummary summary =
        OpenCloseSolver(linear, options).solve(body.problem, pattern, disturbed, {.block_tolerance = block_tolerance});
    EXPECT_TRUE(summary.converged());
    EXPECT_EQ(summary.iterations, 0);
    EXPECT_LT((disturbed - q).cwiseAbs().maxCoeff(), 1e-4 * 1e-9);
    const BlockBalance balance = block_balance({body.problem.body}, disturbed);
    for (std::size_t b = 0; b < balance.left.size(); ++b)
        EXPECT_LT(size_of(balance.left[b]), block_tolerance * balance.forces.around[b] + balance.forces.roundoff[b])
            << b;
}

// By hand: the platen's force is the stress times the current width, and what its rows carry is that force.
TEST(OpenCloseSolver, ReactionOfATravellingPlatenIsItsForce) {
    const PressedBody body(true, {1, 0});
    OpenCloseOptions options;
    options.tolerance = 1e-12;
    options.max_iterations = 40;
    Eigen::VectorXd q = at_rest(body.system);
    ASSERT_TRUE(solve(body, q, options).converged());
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
    const auto summary = solve(body, q);
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
        return solve(body, q, options).residual_ratio;
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
    const auto summary = solve(body, q, options);
    EXPECT_EQ(summary.termination, Termination::max_iterations);
    double largest = 0.0; // relative to a neighbour; distortions are smaller here
    for (const ContactPoint& point : body.problem.placement.contacts)
        largest = std::max(
            largest,
            (displacement_at(q, point.block_b, point.xi_b) - displacement_at(q, point.block_a, point.xi_a)).norm());
    for (int b = 0; b < body.system.n_blocks(); ++b) largest = std::max(largest, q.segment<4>(6 * b + 2).norm());
    EXPECT_NEAR(largest, 0.02 * body.system.spacing, 1e-12); // the increment was longer
}

TEST(OpenCloseSolver, BodyThatNothingHoldsHasNoEquilibrium) {
    PressedBody body(false, {1, 1});
    body.problem.loads.constraints = Constraints();
    Eigen::VectorXd q = at_rest(body.system);
    EXPECT_FALSE(solve(body, q).converged());
}

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A solve that a number that is none ends before its first increment, and that names the place.
void expect_flaw(const PressedBody& body, Eigen::VectorXd q, const std::string& flaw) {
    const OpenCloseSummary summary = solve(body, q);
    EXPECT_EQ(summary.termination, Termination::not_finite) << flaw;
    EXPECT_EQ(summary.iterations, 0) << flaw;
    EXPECT_THAT(summary.flaw, ::testing::HasSubstr(flaw));
    EXPECT_FALSE(summary.residual_ratio <= 1.0) << flaw; // no rule may take it for a small one
}

TEST(OpenCloseSolver, ADisplacementThatIsNoNumberEndsTheSolveAtOnceAndIsNamed) {
    const PressedBody body(false, {1, 0});
    for (const int b : {0, 3, body.system.n_blocks() - 1}) {
        Eigen::VectorXd q = at_rest(body.system);
        q[6 * b + 4] = none;
        expect_flaw(body, q, "the displacement of block " + std::to_string(b) + " at (");
    }
}

TEST(OpenCloseSolver, ATractionThatIsNoNumberEndsTheSolveAtOnceAndIsNamed) {
    const PressedBody whole(false, {1, 0});
    Eigen::VectorXd q = at_rest(whole.system); // where contacts are closed: an open one has no traction to spoil
    ASSERT_TRUE(solve(whole, q).converged());
    const auto expect = [&](auto points_of, auto plant) {
        for (const std::size_t place : {0U, 5U}) {
            PressedBody body(false, {1, 0});
            auto& point = points_of(body.problem.placement).at(place);
            plant(point);
            expect_flaw(body, q, "between block " + std::to_string(point.block_a) + " at (");
            if (point.interface >= 0)
                expect_flaw(body, q, "the traction on interface " + std::to_string(point.interface));
        }
    };
    const auto contacts = [](Placement & placement) -> auto& { return placement.contacts; };
    expect(contacts, [](ContactPoint& point) { point.slip_start = none; });
    expect(contacts, [](ContactPoint& point) { point.history.shear_trial = none; });
    expect(contacts, [](ContactPoint& point) { point.offset.x() = none; });
    const auto bonds = [](Placement & placement) -> auto& { return placement.bonds; };
    expect(bonds, [](Bond& bond) { bond.shear_start[1] = none; });
    expect(bonds, [](Bond& bond) { bond.slip_start[0] = none; });
}

TEST(OpenCloseSolver, ALoadThatIsNoNumberEndsTheSolveAtOnceAndIsNamedWithItsBlock) {
    PressedBody body(false, {1, 0});
    body.problem.loads.pressures[1] = none;
    int first = body.system.n_blocks();
    for (const PressureEdge& edge : body.problem.loads.pressure_edges) first = std::min(first, edge.block);
    expect_flaw(body, at_rest(body.system), "a force of block " + std::to_string(first) + " at (");

    PressedBody heavy(false, {1, 0});
    heavy.problem.eta.assign(heavy.system.blocks.size(), 1e3);
    heavy.problem.start = at_rest(heavy.system);
    heavy.problem.start[6 * 7] = none;
    expect_flaw(heavy, at_rest(heavy.system), "a force of block 7 at (");
}

} // namespace
} // namespace kluft

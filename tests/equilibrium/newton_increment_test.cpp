#include "kluft/equilibrium/newton_increment.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/dense_solution.hpp"
#include "support/pressed_body.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

/// Increments of a body from a state in which neither the forces nor the prescribed displacements are right.
struct Start {
    Start(bool travelling, Kinematics kinematics, double amplitude = 2e-5) : body(travelling, {1, 0}, kinematics) {
        Uniform uniform(8);
        Eigen::VectorXd motion(evaluator.coordinates().size());
        for (double& value : motion) value = uniform(-amplitude, amplitude);
        evaluator.coordinates().move(at_rest(body.system), motion, 1.0, q);
        body.problem.loads.constraints.correction(q, prescribed);
        evaluator.reduced_residual(q, residual);
        border = border_of_platen(body.problem, evaluator.coordinates());
        linear.analyze(pattern);
    }
    [[nodiscard]] NewtonPoint point() { return {evaluator, border, q, residual, prescribed, 1e-5}; }
    [[nodiscard]] Eigen::MatrixXd tangent() {
        BlockMatrix matrix;
        evaluator.tangent(q, TangentKind::exact, matrix);
        return dense(matrix);
    }

    PressedBody body;
    BlockPattern pattern = pattern_of(body.problem);
    EquilibriumEvaluator evaluator{body.problem, pattern};
    Eigen::VectorXd q, prescribed;
    Residual residual;
    Border border;
    LinearSolver linear;
};

/// The increment of the dense system with a Lagrange multiplier for every row and the travel of the platen as an
/// unknown,
///     K dq + C' multipliers = -R,   C (q + dq) = target + rate travel,   v . (R + K dq) = stress width(q + dq).
Eigen::VectorXd dense_increment(Start& start) {
    const OwnedProblem& problem = start.body.problem;
    const DenseRows rows(problem);
    const Eigen::MatrixXd tangent = start.tangent();
    const Eigen::Index n = tangent.rows(), m = rows.rates.size();
    Eigen::MatrixXd system = rows.bordered(tangent);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + m + 1);
    right.head(n) = -start.residual.forces;
    for (Eigen::Index i = 0; i < m; ++i) {
        const PrescribedDisplacement& row = problem.loads.constraints.rows()[static_cast<std::size_t>(i)];
        right[n + i] = DenseRows::scale * (row.target - row.direction.dot(displacement_at(start.q, row.block, row.xi)));
    }
    system(n + m, n + m) = DenseRows::scale; // without a travelling platen its travel is zero
    if (problem.loads.platen_force) {
        const PlatenForce& platen = *problem.loads.platen_force;
        const Eigen::VectorXd v = least_norm_solution(rows.matrix, rows.rates);
        Eigen::VectorXd widening;
        start.evaluator.coordinates().reduce(platen.widening, widening);
        system.block(n + m, 0, 1, n) = v.transpose() * tangent - platen.stress * widening.transpose();
        system(n + m, n + m) = 0.0;
        right[n + m] = platen.at(start.q) - v.dot(start.residual.forces);
    }
    return dense_solution(system, right).head(n);
}

TEST(NewtonIncrement, SolvesTheDenseSystemWithLagrangeMultipliers) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        for (const bool travelling : {false, true}) {
            Start start(travelling, kinematics);
            NewtonIncrement newton(start.linear, {.reuse = false, .motion_limit = 10.0});
            ASSERT_TRUE(newton.find(start.point(), TangentKind::exact));
            const Eigen::VectorXd expected = dense_increment(start);
            EXPECT_LT((newton.increment() - expected).norm(), 1e-7 * expected.norm()) << travelling;
            EXPECT_TRUE(newton.limited().empty());
        }
    }
}

/// What an increment leaves of the equations, over their right side.
double share_left_by(Start& start, const Eigen::VectorXd& increment) {
    const Eigen::MatrixXd tangent = start.tangent();
    Eigen::VectorXd right = -start.residual.forces - tangent * start.prescribed;
    Eigen::VectorXd left = -start.residual.forces - tangent * increment;
    start.body.problem.loads.constraints.project(right);
    start.body.problem.loads.constraints.project(left);
    return left.norm() / right.norm();
}

// theory (31): what a linear solve leaves is at most a tenth of its right side, here with the factor of another
// tangent.
TEST(NewtonIncrement, RefinedIncrementLeavesLittleOfItsEquations) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Start start(false, kinematics);
        NewtonIncrement newton(start.linear, {.reuse = true, .motion_limit = 10.0});
        ASSERT_TRUE(newton.find(start.point(), TangentKind::exact));
        EXPECT_LT(share_left_by(start, newton.increment()), 0.1);
    }
}

TEST(NewtonIncrement, KeepsItsFactorUntilItIsToldToForgetIt) {
    Start start(true, Kinematics::affine);
    NewtonIncrement newton(start.linear, {});
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(newton.find(start.point(), TangentKind::exact));
    EXPECT_EQ(start.linear.statistics().factorizations, 1);
    newton.forget_factor();
    ASSERT_TRUE(newton.find(start.point(), TangentKind::exact));
    EXPECT_EQ(start.linear.statistics().factorizations, 2);
}

// A short step of a motion needs no factor, and (31) holds as with one; in a long one the mass-like term is too small.
TEST(NewtonIncrement, IsFoundWithoutAFactorWhereTheMassLikeTermIsMuchOfTheTangent) {
    for (const bool is_short : {true, false}) {
        Start start(false, Kinematics::affine);
        const double stiffness = start.tangent().trace();
        double mass = 0.0;
        for (const Block& block : start.body.system.blocks) mass += mass_matrix(block, 0.0).trace();
        const double eta = (is_short ? 0.1 : 1e-4) * stiffness / mass;
        start.body.problem.eta.assign(start.body.system.blocks.size(), eta);
        start.body.problem.start = start.q;
        NewtonIncrement newton(start.linear, {.reuse = true, .motion_limit = 10.0});
        ASSERT_TRUE(newton.find(start.point(), TangentKind::exact));
        EXPECT_EQ(start.linear.statistics().factorizations, is_short ? 0 : 1);
        EXPECT_LT(share_left_by(start, newton.increment()), 0.1);
    }
}

/// The largest of what theory (28a) limits, over what it is relative to.
double largest_relative_motion(Start& start, const Eigen::VectorXd& increment) {
    const Coordinates& coordinates = start.evaluator.coordinates();
    const BlockSystem& system = start.body.system;
    const double extent = (system.upper - system.lower).maxCoeff();
    const auto scale = [&](int b) { return motion_scale(system, system.blocks[b]); };
    Eigen::VectorXd moved;
    coordinates.move(start.q, increment, 1.0, moved);
    moved -= start.q;
    double largest = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b)
        largest = std::max(
            {largest, coordinates.distortion(increment, b) / scale(b), coordinates.motion(increment, b) / extent});
    const auto note = [&](int a, int b, const Vec2& relative) {
        largest = std::max(largest, relative.norm() / std::min(scale(a), scale(b)));
    };
    for (const Bond& bond : start.body.problem.placement.bonds)
        for (int k = 0; k < n_bond_points; ++k) note(bond.block_a, bond.block_b, relative_displacement(bond, k, moved));
    for (const ContactPoint& point : start.body.problem.placement.contacts)
        note(point.block_a, point.block_b,
             displacement_at(moved, point.block_b, point.xi_b) - displacement_at(moved, point.block_a, point.xi_a));
    return largest;
}

// One factor for all blocks: the increment keeps its direction.
TEST(NewtonIncrement, IsScaledUntilNoBlockMovesBeyondTheLimit) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Start start(false, kinematics);
        NewtonIncrement whole(start.linear, {.reuse = false, .motion_limit = 10.0});
        ASSERT_TRUE(whole.find(start.point(), TangentKind::exact));
        const double share = 0.7 * largest_relative_motion(start, whole.increment());
        NewtonIncrement limited(start.linear, {.reuse = false, .motion_limit = share});
        ASSERT_TRUE(limited.find(start.point(), TangentKind::exact));
        EXPECT_LT((limited.increment() - 0.7 * whole.increment()).norm(), 1e-9 * whole.increment().norm());
        EXPECT_GE(limited.limited().size(), 1U);
        NewtonIncrement free(start.linear, {.reuse = false, .motion_limit = 1.01 * share / 0.7});
        ASSERT_TRUE(free.find(start.point(), TangentKind::exact));
        EXPECT_TRUE(free.limited().empty());
    }
}

TEST(NewtonIncrement, IsNotFoundWhereAPieceHasNoStiffness) {
    Start start(false, Kinematics::affine);
    start.body.problem.placement.bonds.clear();
    start.body.problem.placement.contacts.clear();
    NewtonIncrement newton(start.linear, {.reuse = false});
    EXPECT_FALSE(newton.find(start.point(), TangentKind::symmetric));
}

// The increment of a damped tangent solves (K + lambda M) dq = -R on the free motions, with and without reuse of a factor.
TEST(NewtonIncrement, DampingAddsAMassToTheTangent) {
    for (const bool reuse : {false, true}) {
        Start start(false, Kinematics::affine);
        start.body.problem.loads.constraints = Constraints();
        start.prescribed.setZero(start.q.size());
        NewtonPoint point = start.point();
        point.damping = 1e12;
        point.largest_residual = 1e-9 * start.residual.forces.norm();
        NewtonIncrement newton(start.linear, {reuse});
        ASSERT_TRUE(newton.find(point, TangentKind::exact));
        Eigen::MatrixXd damped = start.tangent();
        for (int b = 0; b < start.body.system.n_blocks(); ++b)
            damped.block<6, 6>(6 * b, 6 * b) += point.damping * mass_matrix(start.body.system.blocks[b], 0.0);
        const Eigen::VectorXd expected = dense_solution(damped, -start.residual.forces);
        EXPECT_LT((newton.increment() - expected).norm(), 1e-6 * expected.norm()) << reuse;
    }
}

} // namespace
} // namespace kluft

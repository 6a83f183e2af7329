#include "kluft/equilibrium/held_friction.hpp"

#include <gtest/gtest.h>

#include "support/pressed_body.hpp"

namespace kluft {
namespace {

/// A fractured body between platens, and what solves it.
struct HeldFriction : ::testing::Test {
    HeldFriction() { linear.analyze(pattern); }

    PressedBody body{false, {1, 0}};
    BlockPattern pattern = pattern_of(body.problem);
    LinearSolver linear;
    OpenCloseSolver solver{linear, {.tolerance = 1e-9, .max_iterations = 40}};

    HeldFrictionApproach approach(const HeldFrictionGoal& goal, Eigen::VectorXd& q) {
        return approach_with_held_friction(solver, body.problem, pattern, goal, q);
    }
};

// The limits that stay are Coulomb's, but for the last change of a ten-millionth of their sum. Expected: what Newton's method finds by itself.
TEST_F(HeldFriction, ComesToTheEquilibriumOfCoulombsLaw) {
    Eigen::VectorXd expected = at_rest(body.system);
    ASSERT_TRUE(solver.solve(body.problem, pattern, expected, {.unloaded = true}).converged());
    Eigen::VectorXd q = at_rest(body.system);
    const HeldFrictionApproach found = approach({.unloaded = true}, q);
    EXPECT_TRUE(found.is_moved);
    EXPECT_GT(found.n_solves, 0);
    EXPECT_LT((q - expected).norm(), 1e-5 * expected.norm());
}

TEST_F(HeldFriction, FromAnEquilibriumItStaysThere) {
    Eigen::VectorXd q = at_rest(body.system);
    ASSERT_TRUE(solver.solve(body.problem, pattern, q, {.unloaded = true}).converged());
    const Eigen::VectorXd before = q;
    const HeldFrictionApproach found = approach({.unloaded = false}, q);
    EXPECT_TRUE(found.is_moved);
    EXPECT_EQ(found.n_solves, 0);
    EXPECT_EQ(q, before);
}

} // namespace
} // namespace kluft

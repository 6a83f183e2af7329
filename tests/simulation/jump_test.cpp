#include "kluft/simulation/jump.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/posed_run.hpp"

namespace kluft {
namespace {

using posed::degree;
using posed::Workplace;

constexpr double weight = posed::density * posed::gravity * 2.0; ///< of the block (N/m)

/// What a relaxation comes to from where the block lies, under its whole weight.
struct Relaxed {
    explicit Relaxed(Workplace& work, bool must_rest = false) : bench(work.bench()), goal(goal_at(bench, 1.0, false)) {
        goal.must_rest = must_rest;
        StepInProgress p = begin_step(bench, work.state, goal);
        PlacedState placed = place_for_load_step(p);
        found = recover(p, placed, 1.0);
        failure = p.step.failure;
        end = p.step.end;
        balanced_part = p.step.balanced_part;
    }
    StepBench bench;
    StepGoal goal;
    Equilibrium found;
    std::optional<Failure> failure;
    State end;
    std::optional<Step::BalancedPart> balanced_part;
};

/// u of the block, which is the second one.
Vec2 displacement_of_block(const Eigen::VectorXd& q) { return q.segment<2>(n_block_unknowns); }

// Below the friction angle a block comes to rest on its plane: the joint closes by W cos(dip)/(k_n L), and the block, whose
// mean stress is half of that at its base, is shorter by W cos(dip)/(4 E L) of a metre below its centroid.
TEST(Relaxation, BlockComesToRestBelowTheFrictionAngle) {
    const double dip = 20.0 * degree;
    Workplace work(posed::block_on_a_plane(dip, 30.0 * degree));
    const Relaxed relaxed(work);
    ASSERT_FALSE(relaxed.failure.has_value());
    EXPECT_TRUE(relaxed.found.balanced);
    const Vec2 across(-std::sin(dip), std::cos(dip));
    const double sunk = -displacement_of_block(relaxed.found.displacement).dot(across);
    const double joint_closure = weight * std::cos(dip) / (1e10 * 2.0);
    const double own_shortening = weight * std::cos(dip) / (4.0 * 1e10 * 2.0);
    EXPECT_NEAR(sunk, joint_closure + own_shortening, 1e-3 * joint_closure);
}

// Above the friction angle it slides on down the plane: no attempt balances it.
TEST(Relaxation, BlockAboveTheFrictionAngleFalls) {
    const double dip = 40.0 * degree;
    Workplace work(posed::block_on_a_plane(dip, 30.0 * degree));
    EXPECT_FALSE(Relaxed(work).found.balanced);
    const Relaxed relaxed(work, true);
    ASSERT_TRUE(relaxed.failure.has_value());
    EXPECT_EQ(relaxed.failure->kind, FailureKind::falling);
    const Vec2 moved = displacement_of_block(relaxed.end.body.displacement);
    const Vec2 down(-std::cos(dip), -std::sin(dip));
    EXPECT_GT(moved.dot(down), 0.99 * moved.norm());
}

TEST(Relaxation, RemembersWhereTheLastBalancedEquilibriumWas) {
    Workplace work(posed::block_on_a_plane(40.0 * degree, 30.0 * degree));
    const Relaxed relaxed(work);
    ASSERT_TRUE(relaxed.balanced_part.has_value());
    EXPECT_TRUE(posed::same(relaxed.balanced_part->body, work.state.body));
    EXPECT_EQ(relaxed.balanced_part->n_equilibria, 0U);
}

} // namespace
} // namespace kluft

#include "kluft/simulation/jump.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/posed_run.hpp"
#include "support/scene_run.hpp"

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

constexpr double gap = 0.1; ///< between a block on its plane and the stop below it (m)

/// A block of 2 m by 0.5 m on a fixed plane that dips by 40 degrees, steeper than its friction angle of 30. Its joint has a
/// cohesion of 1500 Pa, with which it loses equilibrium at 0.61 of its weight. A fixed stop is `gap` further down.
std::string block_above_a_stop(const std::string& stages) {
    const auto turned = [](double x, double y) {
        const double dip = 40.0 * degree;
        return fmt::format("[{:.15g}, {:.15g}]", x * std::cos(dip) - y * std::sin(dip),
                           x * std::sin(dip) + y * std::cos(dip));
    };
    const auto rectangle = [&](double left, double right, double bottom, double top) {
        return fmt::format("[{}, {}, {}, {}]", turned(left, bottom), turned(right, bottom), turned(right, top),
                           turned(left, top));
    };
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: [0, -9.81]}}
materials: {{rock: {{density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}}}
interfaces:
  joint: {{kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 30, cohesion: 1500,
          cohesion_onset: 100}}
geometry:
  blocks:
    - {{name: plane, polygon: {}, support: fixed}}
    - {{name: stop, polygon: {}, support: fixed}}
    - {{name: block, polygon: {}}}
stages: {}
)",
                       rectangle(-3, 5, -1, 0), rectangle(-1, -gap, 0, 0.5), rectangle(0, 2, 0, 0.5), stages);
}

/// What drives the block down where `share` of its weight acts (N/m).
double driving_force(double share) {
    const double dip = 40.0 * degree;
    const double block_weight = 2500.0 * 9.81 * share;
    return block_weight * (std::sin(dip) - std::cos(dip) * std::tan(30.0 * degree)) - 2.0 * 1500.0;
}

// It comes to rest at the stop. What is released on the way is the work of weight less friction, a constant force; within the
// pseudo-time step that meets the stop it is taken as falling, an error of half that of such a step.
TEST(Jump, BlockThatLosesItsHoldComesToRestAtTheStop) {
    const SceneRun run = run_scene(block_above_a_stop("[{name: weight, steps: 5}]"));
    ASSERT_TRUE(stands(run)) << run.report.diagnosis;
    ASSERT_EQ(run.jumps.size(), 1U);
    const JumpRecord& jump = run.jumps.front();
    EXPECT_EQ(jump.step, 4);
    EXPECT_DOUBLE_EQ(jump.load_factor, 0.8);
    EXPECT_EQ(jump.blocks, 1);
    EXPECT_NEAR(jump.largest_slip, gap, 1e-3 * gap);
    EXPECT_NEAR(jump.released_energy, driving_force(0.8) * gap, 0.5 * MotionControl{}.error * driving_force(0.8) * gap);
    EXPECT_EQ(run.history[3].jumps, 0);
    EXPECT_EQ(run.history[4].jumps, 1);
    EXPECT_EQ(run.history[5].jumps, 1);
}

/// Where the fall of `block` ends, followed with a control.
Eigen::VectorXd end_of_motion(const MotionControl& control) {
    Workplace work(build_scene_model(read_scene_text(block_above_a_stop("[{name: weight, steps: 1}]"))).model);
    const StepBench bench = work.bench();
    const StepGoal goal = goal_at(bench, 1.0, false);
    StepInProgress p = begin_step(bench, work.state, goal);
    PlacedState placed = place_for_load_step(p);
    return follow_motion(p, placed, 1.0, control).displacement;
}

TEST(Jump, HalfThePseudoTimeStepLeadsToTheSameState) {
    const MotionControl usual;
    MotionControl finer = usual;
    finer.error = 0.25 * usual.error; // of second order
    finer.longest = 0.5 * usual.longest;
    const Eigen::VectorXd end = end_of_motion(usual);
    EXPECT_LT((end - end_of_motion(finer)).norm(), 1e-5 * end.norm());
}

} // namespace
} // namespace kluft

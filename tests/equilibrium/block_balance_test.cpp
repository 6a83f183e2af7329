// What is left over on blocks and groups, on bodies of two blocks that are posed in code.
#include "kluft/equilibrium/left_over.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "kluft/loading/acting_forces.hpp"
#include "kluft/simulation/placement.hpp"
#include "support/posed_run.hpp"
#include "support/pressed_body.hpp"

namespace kluft {
namespace {

constexpr double weight = posed::gravity * posed::density * 2.0; // of the block on a plane (N/m)

/// A block on a plane that dips to the left, in the placement of a state and under its whole weight.
struct OnAPlane {
    posed::Workplace work;
    StepGoal goal;
    StepInProgress p;
    PlacedState placed;
    LoadsAt at;

    explicit OnAPlane(double dip, double friction_angle)
        : work(posed::block_on_a_plane(dip, friction_angle)), p(begin_step(work.bench(), work.state, goal)),
          placed(place(p)), at(p.loads_at(1.0)) {}
    [[nodiscard]] BlockBalance balance(const Eigen::VectorXd& q) const {
        return block_balance(loaded_body(work.model, placed.placement, at), q);
    }
};

TEST(BlockBalance, OfABlockThatNothingHoldsIsItsWeight) {
    const OnAPlane posed(20.0 * posed::degree, 30.0 * posed::degree);
    const BlockBalance balance = posed.balance(posed.p.displacement());
    EXPECT_NEAR(balance.left[1].x(), 0.0, 1e-9 * weight);
    EXPECT_NEAR(balance.left[1].y(), -weight, 1e-9 * weight);
    EXPECT_NEAR(balance.forces.own[1], weight, 1e-9 * weight);
    EXPECT_EQ(size_of(balance.left[0]), 0.0); // it is fixed
    const BlockVerdict verdict = judge_blocks(balance, nullptr, {});
    EXPECT_NEAR(verdict.error, 1.0, 1e-9);
    ASSERT_FALSE(verdict.balanced());
    EXPECT_EQ(verdict.moving.front().block, 1);
    EXPECT_NEAR(verdict.moving.front().direction.y(), -1.0, 1e-9);
}

TEST(BlockBalance, OfABlockAtRestIsNothing) {
    OnAPlane posed(20.0 * posed::degree, 30.0 * posed::degree);
    posed.goal.balance.share = 1e-6;
    const Equilibrium found = find_at(posed.p, posed.placed, 1.0, posed.p.displacement());
    EXPECT_TRUE(found.balanced);
    EXPECT_LT(found.verdict.error, 1e-6);
    EXPECT_LT(size_of(posed.balance(found.displacement).left[1]), 1e-6 * weight);
}

// Limit equilibrium: what friction cannot hold of the weight along the plane, W (sin dip - cos dip tan phi).
TEST(BlockBalance, OfABlockThatSlidesIsWhatFrictionCannotHold) {
    const double dip = 30.0 * posed::degree;
    const double friction = 25.0 * posed::degree;
    const OnAPlane posed(dip, friction);
    StepInProgress p = posed.p;
    const Equilibrium found = find_at(p, posed.placed, 1.0, p.displacement());
    EXPECT_FALSE(found.balanced);
    const double expected = std::sin(dip) - std::cos(dip) * std::tan(friction);
    EXPECT_NEAR(found.verdict.error, expected, 1e-2 * expected);
    const Vec2 direction = found.verdict.moving.front().direction;
    EXPECT_NEAR(direction.x(), -std::cos(dip), 1e-2);
    EXPECT_NEAR(direction.y(), -std::sin(dip), 1e-2);
}

/// Two blocks side by side that touch nothing, or each other.
BlockBalance two_blocks(double left_a, double left_b, double own, bool loaded, bool together) {
    BlockBalance balance;
    balance.forces = {{own, own}, {own, own}, {0.0, 0.0}, {loaded, loaded}, false, {}, {own, own}};
    balance.left = {Vec3(left_a, 0, 0), Vec3(left_b, 0, 0)};
    balance.position = {Vec2(0, 0), Vec2(0, 1)};
    balance.area = {1.0, 1.0};
    balance.held = {0, 0};
    if (together) balance.groups = {{0, 1}};
    return balance;
}

TEST(BlockVerdict, CountsTheResultantOfBlocksThatHoldTogether) {
    // Opposite forces on two blocks, one above the other: no resultant, but a moment of 2 x 0.5 over sqrt(2).
    const BlockVerdict verdict = judge_blocks(two_blocks(1.0, -1.0, 1e4, true, true), nullptr, {.share = 1e-6});
    EXPECT_NEAR(verdict.error, 1e-4, 1e-18);
    const BlockVerdict group = judge_blocks(two_blocks(1.0, 1.0, 1e4, false, true), nullptr, {.share = 1e-3});
    EXPECT_NEAR(group.error, 2.0 / 2e4, 1e-18);
    EXPECT_TRUE(group.balanced());
}

TEST(BlockVerdict, NamesTheGroundOfAGroupThatMovesOnlyWhereNothingElseMoves) {
    BlockBalance balance = two_blocks(1.0, 1.0, 1.0, true, true);
    balance.held = {1, 0};
    const BlockVerdict verdict = judge_blocks(balance, nullptr, {});
    ASSERT_FALSE(verdict.balanced());
    for (const MovingBlock& each : verdict.moving) EXPECT_EQ(each.block, 1);
    balance.held = {1, 1};
    EXPECT_FALSE(judge_blocks(balance, nullptr, {}).balanced());
}

TEST(BlockVerdict, BlockWithoutLoadsOnlyMustNotDisturbThoseAroundIt) {
    BlockBalance before = two_blocks(4.0, 0.0, 1.0, false, false);
    before.forces.around = {1e4, 1e4};
    BlockBalance now = before;
    now.left[0].x() = 2.0;
    EXPECT_TRUE(judge_blocks(now, &before, {}).balanced());  // it comes to rest
    EXPECT_FALSE(judge_blocks(now, &now, {}).balanced());    // it goes on
    EXPECT_FALSE(judge_blocks(now, nullptr, {}).balanced()); // not known
    now.left[0].x() = 0.9;
    EXPECT_TRUE(judge_blocks(now, &now, {}).balanced()); // a tenth of what may disturb those around it
    now.forces.loaded = {1, 1};
    EXPECT_FALSE(judge_blocks(now, &before, {}).balanced()); // loads must be carried
}

TEST(BlockVerdict, FragmentThatTouchesNothingHasNothingToBalanceWithoutLoads) {
    EXPECT_TRUE(judge_blocks(two_blocks(1e-30, 0.0, 0.0, false, false), nullptr, {}).balanced());
    EXPECT_FALSE(judge_blocks(two_blocks(1e-30, 0.0, 1e-30, true, false), nullptr, {}).balanced());
}

// theory (27d): what drives both along x, where nothing holds them, is judged by the loads along x; the rest, and what drives them
// along y, by their own.
TEST(BlockVerdict, BodyThatIsFreeToDriftIsJudgedAlongThatByItsLoads) {
    BlockBalance balance = two_blocks(1.0, 1.0, 10.0, true, false);
    EXPECT_FALSE(judge_blocks(balance, nullptr, {}).balanced());
    balance.free = {{Vec2(1, 0), 4e3}};
    EXPECT_TRUE(judge_blocks(balance, nullptr, {}).balanced());
    balance.free = {{Vec2(1, 0), 1e3}}; // of which 2 is more than a share of 1e-3
    EXPECT_FALSE(judge_blocks(balance, nullptr, {}).balanced());
    balance.free = {{Vec2(0, 1), 4e3}};
    EXPECT_FALSE(judge_blocks(balance, nullptr, {}).balanced());
    balance = two_blocks(1.0, -1.0, 10.0, true, false); // nothing of it drives the body
    balance.free = {{Vec2(1, 0), 4e3}};
    EXPECT_NEAR(judge_blocks(balance, nullptr, {}).error, 0.1, 1e-12);
}

TEST(BlockVerdict, NamesTheWorstFirst) {
    const BlockVerdict verdict = judge_blocks(two_blocks(0.01, 0.5, 1.0, true, false), nullptr, {});
    ASSERT_EQ(verdict.moving.size(), 2U);
    EXPECT_EQ(verdict.moving.front().block, 1);
    EXPECT_EQ(verdict.moving.front().direction, Vec2(1, 0));
}

/// What supports and platens carry, by the table of forces that a run writes.
double carried_by_supports(const LoadedBody& body, const Eigen::VectorXd& q) {
    std::map<int, Vec2> forces;
    for (const ConstrainedBlock& held : body.loads->constraints.blocks()) forces.emplace(held.block, Vec2::Zero());
    for (const ContactForce& at : contact_forces(body, q)) {
        const Vec2 normal = at.normal;
        const Vec2 tangent(-normal.y(), normal.x());
        const Vec2 on_a = at.length * (at.normal_traction * normal + at.shear_traction * tangent);
        if (forces.contains(at.block_a)) forces[at.block_a] += on_a;
        if (forces.contains(at.block_b)) forces[at.block_b] -= on_a;
    }
    double sum = 0.0;
    for (const auto& [block, force] : forces) sum += force.norm();
    return sum;
}

// The forces of a body that has shed its load are none beside those that it has carried (27c): a hundredth of that stress on
// the size of a block without loads, and of the body. A body that carries it still is judged as ever, and so is a weight.
TEST(BlockBalance, OfABodyThatHasShedItsLoadIsByWhatItHasCarried) {
    PressedBody pressed(false, {1, 0});
    const BlockSystem& system = pressed.system;
    const BlockPattern pattern = pattern_of(pressed.problem);
    Eigen::VectorXd q = at_rest(system);
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += 1e-6 * std::sin(static_cast<double>(i)); // m
    const auto look = [&](double carried_stress) {
        pressed.problem.body.carried_stress = carried_stress;
        Residual residual;
        EquilibriumEvaluator(pressed.problem, pattern).residual(q, residual);
        return std::pair(residual.force_scale, own_forces(pressed.problem.body, q));
    };
    const auto [scale, own] = look(0.0);
    const auto [scale_of_little, own_of_little] = look(1.0);
    EXPECT_EQ(scale_of_little, scale);
    EXPECT_EQ(own_of_little.own, own.own);
    const double of_carrying = carried_by_supports(pressed.problem.body, q) / (0.01 * std::sqrt(area_of(system)));
    EXPECT_EQ(look((1.0 - 1e-9) * of_carrying).second.own, own.own);
    EXPECT_NE(look((1.0 + 1e-9) * of_carrying).second.own, own.own);
    constexpr double carried = 1e15; // Pa, far beyond the pressure
    const auto [scale_of_much, own_of_much] = look(carried);
    EXPECT_NEAR(scale_of_much, 0.01 * carried * std::sqrt(area_of(system)), 1e-12 * scale_of_much);
    int n_lowered = 0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (own.loaded[b]) {
            EXPECT_EQ(own_of_much.own[b], own.own[b]);
        } else if (own.own[b] > 0.0) {
            ++n_lowered;
            EXPECT_DOUBLE_EQ(own_of_much.own[b], 0.01 * carried * std::sqrt(system.blocks[b].area));
        } else {
            EXPECT_EQ(own_of_much.own[b], 0.0); // nothing acts on it
        }
    }
    EXPECT_GT(n_lowered, 0);
}

// Of 236 triangles that had carried 33 MPa a splinter stayed wedged in a notch, with more than a hundredth of that, and the rest, which
// lay loose, made ten load steps unbalanced.
TEST(BlockBalance, OfABodyThatHasShedItsLoadIsWithoutWhatIsJammedInIt) {
    PressedBody pressed(false, {1, 0});
    const BlockSystem& system = pressed.system;
    std::vector<char> supported(system.n_blocks(), 0);
    for (const ConstrainedBlock& held : pressed.problem.body.loads->constraints.blocks()) supported[held.block] = 1;
    std::vector<char> near = supported;
    for (const Interface& interface : system.interfaces) {
        if (supported[interface.block_a] != 0) near[interface.block_b] = 1;
        if (supported[interface.block_b] != 0) near[interface.block_a] = 1;
    }
    const auto jammed = static_cast<int>(std::ranges::find(near, 0) - near.begin());
    ASSERT_LT(jammed, system.n_blocks());
    Eigen::VectorXd q = at_rest(system);
    q[n_block_unknowns * jammed] += 1e-3; // m: bonds pull at it and contacts press
    const OwnForces own = own_forces(pressed.problem.body, q);
    pressed.problem.body.carried_stress = own.own[jammed] / std::sqrt(area_of(system)); // it has 100 times (27c)
    const OwnForces beside = own_forces(pressed.problem.body, q);
    ASSERT_TRUE(beside.has_shed_its_load);
    EXPECT_EQ(beside.own[jammed], own.own[jammed]);
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double floor = 0.01 * pressed.problem.body.carried_stress * std::sqrt(system.blocks[b].area);
        EXPECT_DOUBLE_EQ(beside.own[b],
                         own.loaded[b] != 0 || own.own[b] == 0.0 ? own.own[b] : std::max(own.own[b], floor));
    }
}

} // namespace
} // namespace kluft

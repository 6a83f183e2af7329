#include "kluft/simulation/equilibrium_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/posed_run.hpp"

namespace kluft {
namespace {

using posed::degree;
using posed::Workplace;

/// A search of the equilibrium of a block on a plane that dips by 20 degrees, with a large mass-like term.
struct Posed {
    explicit Posed(double friction_angle) : work(posed::block_on_a_plane(20.0 * degree, friction_angle)) {
        StepInProgress p = begin_step(work.bench(), work.state, goal);
        placed = place(p);
        placed.eta.assign(2, 1e8);
        at = p.loads_at(1.0);
    }
    [[nodiscard]] EquilibriumProblem problem() const {
        return pose(work.model, placed, at, work.state.body.displacement);
    }
    [[nodiscard]] Equilibrium find(const BlockGoal& balance) {
        return work.search.find(problem(), work.state.body.displacement, balance, {.unloaded = true});
    }
    Workplace work;
    StepGoal goal;
    PlacedState placed;
    LoadsAt at;
};

// The rounds end when what is left over on the block is below the share asked for; fewer digits take fewer rounds.
TEST(EquilibriumSearch, RepeatsTheSolveUntilTheMassLikeTermNoLongerCounts) {
    Posed posed(30.0 * degree);
    const Equilibrium coarse = posed.find({.share = 1e-2});
    const Equilibrium fine = posed.find({.share = 1e-8});
    EXPECT_TRUE(coarse.balanced);
    EXPECT_TRUE(fine.balanced);
    EXPECT_LE(coarse.verdict.error, 1e-2);
    EXPECT_LE(fine.verdict.error, 1e-8);
    EXPECT_GE(fine.iterations, coarse.iterations);
}

// Without friction it slides: the part of its weight along the plane stays left over, from round to round.
TEST(EquilibriumSearch, BodyThatMovesOnIsNotBalanced) {
    Posed posed(0.0);
    const Equilibrium found = posed.find({.share = 1e-6});
    EXPECT_FALSE(found.balanced);
    EXPECT_FALSE(found.verdict.falls);
    EXPECT_NEAR(found.verdict.error, std::sin(20.0 * degree), 1e-3);
}

TEST(EquilibriumSearch, OrdersTheMatrixAgainOnlyForPairsThatItLacks) {
    Posed posed(30.0 * degree);
    const auto analyses = [&] {
        RunCosts costs;
        posed.work.search.add_costs(costs);
        return costs.analyses;
    };
    const int before = analyses();
    posed.work.search.require_pairs(posed.placed.placement.contacts, {{0, 1}});
    EXPECT_EQ(analyses(), before);
    posed.work.search.order_for({{0, 1}});
    EXPECT_EQ(analyses(), before + 1);
    EXPECT_EQ(posed.work.search.near_pairs().size(), 1U);
}

TEST(EquilibriumSearch, ForcesVanishAtAnEquilibrium) {
    Posed posed(30.0 * degree);
    const Equilibrium found = posed.find({.share = 1e-8});
    EquilibriumProblem problem = posed.problem();
    problem.eta.clear();
    Eigen::VectorXd forces = posed.work.search.forces(problem, found.displacement);
    posed.at.loads.constraints.project(forces);
    EXPECT_LT(forces.norm(), 1e-7 * found.summary.force_scale);
}

/// Forty bonded blocks of 1 m by 1 m on each other, on a fixed support, under a pressure at the top and one from the left.
Model column(double at_the_top, double from_the_left) {
    constexpr double n = 40.0;
    GeometrySpec spec = cut_scenes::rectangle(1.0, n);
    for (double y = 1.0; y < n; y += 1.0) cut_scenes::add_trace(spec, {{-1.0, y}, {2.0, y}}, 0);
    spec.reference_spacing = 1.0;
    ModelInput input;
    input.materials = {posed::stiff_rock()};
    InterfaceType bond = posed::joint(30.0 * degree);
    bond.kind = InterfaceKind::potential_crack;
    bond.fails_to = 1;
    input.interface_types = {bond, posed::joint(30.0 * degree)};
    input.loads.supports = {Support::fixed, Support::none, Support::none, Support::none};
    Stage stage;
    stage.name = "pressure";
    stage.pressure = {{2, at_the_top}, {3, from_the_left}};
    stage.steps = 1;
    input.loads.stages = {stage};
    return build_model(cut_blocks(spec).system, input);
}

/// Under its full loads, in a step of a motion with the mass-like term of `eta` (Pa/m2).
struct PosedColumn {
    PosedColumn(double at_the_top, double from_the_left, const SolverOptions& options)
        : work(column(at_the_top, from_the_left), options) {
        StepInProgress p = begin_step(work.bench(), work.state, StepGoal{});
        placed = place(p);
        at = p.loads_at(1.0);
    }
    [[nodiscard]] Equilibrium move_on(const Eigen::VectorXd& from, double share, double eta) {
        placed.eta.assign(work.model.system.blocks.size(), eta);
        return work.search.move_on(pose(work.model, placed, at, from), from, {.share = share}, false);
    }
    Workplace work;
    PlacedState placed;
    LoadsAt at;
};

// Each of forty blocks may keep a ten-thousandth of what presses on it, twice the pressure at the top; of all of them together, which bonds
// hold, no more than a thousandth of that pressure may be left.
TEST(EquilibriumSearch, MotionGoesOnWhereTheBalanceOfAGroupAsksForMoreThanTheTolerance) {
    constexpr double pressure = 1e6;
    constexpr double share = 1e-3;
    const double from_the_left = 5e-5 * pressure; // on each block
    PosedColumn bent(pressure, from_the_left, Workplace::tight());
    const Eigen::VectorXd start = bent.move_on(Eigen::VectorXd::Zero(6 * 40), share, 1e-3).displacement;

    SolverOptions coarse = Workplace::tight();
    coarse.tolerance = 1e-3;
    PosedColumn straight(pressure, 0.0, coarse);
    const Equilibrium moved = straight.move_on(start, share, 1e-3);
    EXPECT_GT(40.0 * from_the_left, share * pressure);
    EXPECT_TRUE(judge_blocks(moved.blocks, nullptr, {.share = share}).balanced());
    EXPECT_NE(moved.displacement, start);
}

} // namespace
} // namespace kluft

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

} // namespace
} // namespace kluft

#include "kluft/equilibrium/part_of_body.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "kluft/equilibrium/local_iteration.hpp"
#include "support/pressed_body.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

/// A body with loads of all kinds, away from equilibrium.
struct Disturbed {
    explicit Disturbed(double amplitude = 2e-5) : body(false, {1, 0}), q(at_rest(body.system)) {
        Uniform uniform(5);
        for (double& value : q) value = uniform(-amplitude, amplitude);
        body.problem.eta.assign(body.system.blocks.size(), 1e9);
        body.problem.least_mass_area = 0.01;
        body.problem.start = at_rest(body.system);
        body.problem.loads.gravity = Vec2(1.0, -9.0);
        body.problem.set_density(2500.0);
        body.problem.loads.point_loads.push_back({free_block(), Vec2(0.1, 0.2), Vec2(3e3, -4e3)});
        body.problem.loads.friction.push_back({free_block(), Vec2(-0.2, 0.1), Vec2(1e3, 2e3)});
    }
    /// A block with points on the fracture.
    [[nodiscard]] int free_block() const { return body.problem.placement.contacts.front().block_b; }
    [[nodiscard]] Eigen::VectorXd forces(const Eigen::VectorXd& at) const {
        const BlockPattern pattern = pattern_of(body.problem);
        Residual residual;
        EquilibriumEvaluator(body.problem, pattern).residual(at, residual);
        body.problem.loads.constraints.project(residual.forces);
        return residual.forces;
    }
    PressedBody body;
    Eigen::VectorXd q;
};

// The forces on the free blocks of a part are those that the whole body has there, whatever blocks are chosen.
TEST(PartOfBody, HasTheForcesOfTheWholeBody) {
    const Disturbed disturbed;
    const Eigen::VectorXd whole = disturbed.forces(disturbed.q);
    const Surroundings surroundings(disturbed.body.problem);
    const int n_blocks = disturbed.body.system.n_blocks();
    std::vector<std::vector<int>> choices{{disturbed.free_block()}, {}, {}};
    for (int b = 0; b < n_blocks; b += 3) choices[1].push_back(b);
    for (int b = n_blocks - 1; b >= 0; --b) choices[2].push_back(b);
    for (const std::vector<int>& free : choices) {
        const PartOfBody part(surroundings, free, disturbed.q);
        const BlockPattern pattern(part.problem().body.system->n_blocks(), part.pairs());
        Residual residual;
        EquilibriumEvaluator(part.problem(), pattern).residual(part.start(), residual);
        part.problem().body.loads->constraints.project(residual.forces);
        for (int i = 0; i < part.n_free(); ++i)
            EXPECT_LT((residual.forces.segment<6>(6 * i) - whole.segment<6>(6 * free[i])).norm(), 1e-12 * whole.norm())
                << free.size() << " " << free[i];
    }
}

TEST(Surroundings, NeighboursAreThoseOfBondsAndContacts) {
    const Disturbed disturbed;
    const Surroundings surroundings(disturbed.body.problem);
    const Placement& placement = disturbed.body.problem.placement;
    std::vector<std::set<int>> expected(disturbed.body.system.blocks.size());
    const auto join = [&](const auto& pair) {
        expected[pair.block_a].insert(pair.block_b);
        expected[pair.block_b].insert(pair.block_a);
    };
    for (const Bond& bond : placement.bonds) join(bond);
    for (const ContactPoint& point : placement.contacts) join(point);
    for (int b = 0; b < disturbed.body.system.n_blocks(); ++b) {
        const std::vector<int> found = surroundings.neighbours(b);
        EXPECT_EQ(std::set<int>(found.begin(), found.end()), expected[b]) << b;
    }
}

// One block of a body without loads is pushed into its neighbours: the forces of that are put right, and nothing moves but it,
// those that it pushes and those that these touch.
TEST(LocalIteration, PutsRightASinglePushedBlock) {
    Disturbed disturbed(0.0);
    disturbed.body.problem.loads = Loads();
    disturbed.body.problem.eta.clear();
    const int pushed = disturbed.free_block();
    disturbed.q.segment<2>(6 * pushed) += Vec2(3e-6, 2e-6);
    const Eigen::VectorXd forces = disturbed.forces(disturbed.q);
    ASSERT_GT(forces.norm(), 1e4);
    Eigen::VectorXd moved = disturbed.q;
    ASSERT_TRUE(LocalIteration(disturbed.body.problem).improve(forces, 0.2, 0.0, moved));
    EXPECT_LT(disturbed.forces(moved).norm(), 0.1 * forces.norm());
    std::vector<int> near = Surroundings(disturbed.body.problem).neighbours(pushed);
    const std::vector<int> first_ring = near;
    for (const int b : first_ring) {
        const std::vector<int> next = Surroundings(disturbed.body.problem).neighbours(b);
        near.insert(near.end(), next.begin(), next.end());
    }
    for (int b = 0; b < disturbed.body.system.n_blocks(); ++b) {
        if (b == pushed || std::ranges::find(near, b) != near.end()) continue;
        EXPECT_EQ((moved - disturbed.q).segment<6>(6 * b).norm(), 0.0) << b;
    }
}

// Blocks at the platen and at the support stay on them, to the last bits of a displacement of 4e-4.
TEST(LocalIteration, KeepsPrescribedDisplacements) {
    const Disturbed disturbed;
    const Constraints& constraints = disturbed.body.problem.loads.constraints;
    Eigen::VectorXd correction;
    constraints.correction(disturbed.q, correction);
    const Eigen::VectorXd held = disturbed.q + correction;
    std::vector<int> blocks;
    for (const auto& row : constraints.rows()) blocks.push_back(row.block);
    Eigen::VectorXd moved = held;
    LocalIteration(disturbed.body.problem).improve(blocks, 0.0, moved);
    EXPECT_LT(disturbed.forces(moved).norm(), 0.9 * disturbed.forces(held).norm());
    constraints.correction(moved, correction);
    EXPECT_LT(correction.lpNorm<Eigen::Infinity>(), 1e-18);
}

} // namespace
} // namespace kluft

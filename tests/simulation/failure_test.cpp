// Which blocks move where nothing balances them.
#include "kluft/simulation/failure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/kinematics/rigid.hpp"
#include "support/lattice_body.hpp"

namespace kluft {
namespace {

// A block 1 m wide and 2 m high that tips over its right lower corner moves there and turns clockwise, also where what
// pushes it at the moment is a force alone; also from a pose in which it is turned already.
TEST(Failure, BlockThatTipsIsSaidToTurn) {
    const BlockSystem system = cut_blocks(cut_scenes::rectangle(1.0, 2.0)).system;
    const double size = system.blocks[0].size;
    const auto tipped = [&](double angle) {
        Eigen::VectorXd q = at_rest(system);
        set_rotation(q, 0, size, angle);
        const Vec2 from_corner(-0.5, 1.0); // m, to the centre
        q.segment<2>(0) = rotation_by(angle) * from_corner - from_corner;
        return q;
    };
    const std::vector<MovingBlock> pushed{{0, Vec2::UnitX(), 0}};
    for (const double before : {0.0, -3.0}) {
        const std::vector<MovingBlock> found = moving_on(system, tipped(before), tipped(before - 0.5), pushed);
        EXPECT_EQ(found.at(0).turn, -1) << before;
    }
    Eigen::VectorXd slid = at_rest(system);
    slid[0] = 1.0;
    EXPECT_EQ(moving_on(system, at_rest(system), slid, {{0, Vec2::UnitY(), 1}}), pushed);
}

// Five blocks in a row, of which the middle one is known to move, by 1 mm: two with 0.4 mm move along; one with 0.2 mm does not, nor does
// that behind it. By the rule (0.3 of the farthest motion, through blocks that move as much).
TEST(Failure, WhatMovesAlongIsJoinedToIt) {
    GeometrySpec row = cut_scenes::rectangle(5.0, 1.0);
    for (const double x : {1.0, 2.0, 3.0, 4.0}) cut_scenes::add_trace(row, {{x, -1.0}, {x, 2.0}});
    const BlockSystem system = cut_blocks(row).system;
    const auto block_at = [&](double x) { // m from the left
        const auto is_there = [&](const Block& block) {
            return std::abs(system.origin.x() + block.centroid.x() - x) < 0.1;
        };
        return static_cast<int>(std::ranges::find_if(system.blocks, is_there) - system.blocks.begin());
    };
    const Eigen::VectorXd before = at_rest(system);
    Eigen::VectorXd now = before;
    for (const auto& [x, moved] : {std::pair{0.5, 0.4e-3}, {1.5, 0.4e-3}, {2.5, 1e-3}, {3.5, 0.2e-3}, {4.5, 0.5e-3}})
        now[n_block_unknowns * block_at(x) + 1] = moved;
    const std::vector<MovingBlock> moving{{block_at(2.5), Vec2::UnitY(), 0}};
    const std::vector<MovingBlock> along = moving_along(system, before, now, moving);
    EXPECT_THAT(along, ::testing::UnorderedElementsAre(MovingBlock{block_at(0.5), Vec2::UnitY(), 0},
                                                       MovingBlock{block_at(1.5), Vec2::UnitY(), 0}));
    const Failure failure{.moving = moving, .along = along};
    EXPECT_EQ(all_moving(failure).size(), 3U);
    EXPECT_EQ(all_moving(failure).front(), moving.front());
}

} // namespace
} // namespace kluft

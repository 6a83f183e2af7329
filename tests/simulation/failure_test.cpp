// Which blocks move where nothing balances them.
#include "kluft/simulation/failure.hpp"

#include <cmath>

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

} // namespace
} // namespace kluft

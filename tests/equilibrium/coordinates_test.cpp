#include "kluft/equilibrium/coordinates.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "support/lattice_body.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

BlockSystem net_of_hexagons() { return cut_blocks(hexagon_spec(0.5, 0.4, 0.1, {0.03, 0.04})).system; }

Eigen::VectorXd random_vector(Eigen::Index n, double amplitude, Uniform& uniform) {
    Eigen::VectorXd v(n);
    for (double& value : v) value = uniform(-amplitude, amplitude);
    return v;
}

TEST(Coordinates, BodyHasSixUnknownsPerAffineAndThreePerRigidBlock) {
    const BlockSystem system = net_of_hexagons();
    EXPECT_EQ(Coordinates(system, Kinematics::affine).size(), 6 * system.n_blocks());
    EXPECT_EQ(Coordinates(system, Kinematics::rigid).size(), 3 * system.n_blocks());
}

TEST(Coordinates, AffineBlocksMoveByTheShareOfTheIncrement) {
    const BlockSystem system = net_of_hexagons();
    const Coordinates coordinates(system, Kinematics::affine);
    Uniform uniform(1);
    const Eigen::VectorXd q = random_motion(system, 0.1, uniform);
    const Eigen::VectorXd increment = random_motion(system, 0.1, uniform);
    Eigen::VectorXd moved;
    coordinates.move(q, increment, 0.25, moved);
    EXPECT_LT((moved - (q + 0.25 * increment)).norm(), 1e-16);
    Eigen::VectorXd in_place = q;
    coordinates.move(in_place, increment, 0.25, in_place);
    EXPECT_EQ(in_place, moved);
}

// Twelve increments of 30 degrees, w = h pi/6, are a full turn: D = h (R - I) is zero again, and |det F| = 1 on the
// way.
TEST(Coordinates, RotationsOfRigidBlocksAddUp) {
    const BlockSystem system = net_of_hexagons();
    const Coordinates coordinates(system, Kinematics::rigid);
    Eigen::VectorXd increment = Eigen::VectorXd::Zero(coordinates.size());
    for (int b = 0; b < system.n_blocks(); ++b) {
        increment[3 * b] = 0.002;
        increment[3 * b + 2] = 2.0 * system.blocks[b].size * std::numbers::pi / 6.0;
    }
    Eigen::VectorXd q = at_rest(system);
    for (int i = 0; i < 12; ++i) {
        coordinates.move(q, increment, 0.5, q);
        EXPECT_NEAR(deformation_gradient(q, 0, system.blocks[0].size).determinant(), 1.0, 1e-15);
    }
    for (int b = 0; b < system.n_blocks(); ++b) {
        EXPECT_NEAR(q[6 * b], 0.012, 1e-15);
        EXPECT_LT(q.segment<5>(6 * b + 1).norm(), 1e-15);
    }
}

// By hand: |(3, 4)| = 5, and D = ((1, 2), (3, 4)) has the norm sqrt(30).
TEST(Coordinates, MotionOfAnAffineBlockIsTheLargerOfItsTranslationAndItsDeformation) {
    const BlockSystem system = net_of_hexagons();
    const Coordinates coordinates(system, Kinematics::affine);
    Eigen::VectorXd increment = at_rest(system);
    increment.segment<6>(6) << 3e-3, 4e-3, 1e-3, 3e-3, 2e-3, 4e-3;
    increment.segment<6>(12) << 3e-3, 4e-3, 1e-4, 3e-4, 2e-4, 4e-4;
    EXPECT_EQ(coordinates.motion(increment, 0), 0.0);
    EXPECT_DOUBLE_EQ(coordinates.motion(increment, 1), std::sqrt(30.0) * 1e-3);
    EXPECT_DOUBLE_EQ(coordinates.motion(increment, 2), 5e-3);
}

// The same motion, counted in the six numbers and in the three: a small rotation changes D by its motion.
TEST(Coordinates, MotionOfARigidBlockIsThatOfItsSixNumbers) {
    const BlockSystem system = net_of_hexagons();
    const Coordinates coordinates(system, Kinematics::rigid);
    Uniform uniform(2);
    Eigen::VectorXd q = affine_motion(system, rotation_by(0.8));
    const Eigen::VectorXd increment = random_vector(coordinates.size(), 1e-6, uniform);
    Eigen::VectorXd moved;
    coordinates.move(q, increment, 1.0, moved);
    const Coordinates affine(system, Kinematics::affine);
    for (int b = 0; b < system.n_blocks(); ++b) {
        EXPECT_NEAR(coordinates.motion(increment, b), affine.motion(moved - q, b), 1e-4 * 1e-6);
    }
}

// Virtual work: forces on the six numbers do the same work as the reduced ones on the unknowns, in either kinematics
// and at rotations of any size. Central differences of the motion.
TEST(Coordinates, ReducedForcesDoTheSameWork) {
    const BlockSystem system = net_of_hexagons();
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Coordinates coordinates(system, kinematics);
        for (const double turn : {0.0, 0.7, 2.5}) {
            Uniform uniform(3);
            const Eigen::VectorXd q = affine_motion(system, rotation_by(turn));
            const Eigen::VectorXd forces = random_motion(system, 1e6, uniform);
            const Eigen::VectorXd increment = random_vector(coordinates.size(), 1e-5, uniform);
            Eigen::VectorXd forward, backward, reduced;
            coordinates.move(q, increment, 1.0, forward);
            coordinates.move(q, increment, -1.0, backward);
            coordinates.turn_to(q);
            coordinates.reduce(forces, reduced);
            const double work = 0.5 * forces.dot(forward - backward);
            EXPECT_NEAR(reduced.dot(increment), work, 1e-6 * reduced.norm() * increment.norm()) << turn;
        }
    }
}

// By hand: where nothing has turned, w of a block gets the magnitudes of D21 and D12 alone.
TEST(Coordinates, NormOfMagnitudesCountsWhatActsOnTheUnknowns) {
    const BlockSystem system = net_of_hexagons();
    Eigen::VectorXd magnitudes = at_rest(system);
    magnitudes.segment<6>(6) << 2.0, 3.0, 100.0, 1.0, 5.0, 100.0;
    Coordinates affine(system, Kinematics::affine);
    EXPECT_DOUBLE_EQ(affine.norm_of_magnitudes(magnitudes), std::sqrt(4.0 + 9.0 + 2e4 + 1.0 + 25.0));
    Coordinates rigid(system, Kinematics::rigid);
    rigid.turn_to(at_rest(system));
    EXPECT_DOUBLE_EQ(rigid.norm_of_magnitudes(magnitudes), 7.0); // 4 + 9 + (1 + 5)^2 = 49
}

TEST(Coordinates, NormsOfTheBlocksAddUpToThatOfTheBody) {
    const BlockSystem system = net_of_hexagons();
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        const Coordinates coordinates(system, kinematics);
        Uniform uniform(4);
        const Eigen::VectorXd v = random_vector(coordinates.size(), 1.0, uniform);
        double sum = 0.0;
        for (int b = 0; b < system.n_blocks(); ++b) sum += coordinates.squared_norm(v, b);
        EXPECT_NEAR(sum, v.squaredNorm(), 1e-13 * sum);
    }
}

// D = h (R - I) of a rigid block has the round-off of h even where it is zero; displacements of affine blocks have that
// of their own size.
TEST(Coordinates, RoundoffOfRigidBlocksIsThatOfTheirSize) {
    const BlockSystem system = net_of_hexagons();
    const Coordinates affine(system, Kinematics::affine), rigid(system, Kinematics::rigid);
    EXPECT_EQ(affine.roundoff(at_rest(system)), 0.0);
    EXPECT_DOUBLE_EQ(rigid.roundoff(at_rest(system)), 1e-13 * 0.1);
    Eigen::VectorXd q = at_rest(system);
    q[7] = -0.3;
    EXPECT_DOUBLE_EQ(affine.roundoff(q), 1e-13 * 0.3);
    EXPECT_DOUBLE_EQ(rigid.roundoff(q), 1e-13 * 0.4);
}

} // namespace
} // namespace kluft

#include "kluft/equilibrium/boundary_terms.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/dense_solution.hpp"
#include "support/lattice_body.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

/// A body of hexagons; its boundaries are bottom, right, top and left.
BlockSystem hexagons() { return cut_blocks(hexagon_spec(0.6, 0.4, 0.1, {0.03, 0.02})).system; }

/// Resultant and moment about the local origin of a pressure on a boundary.
struct Resultant {
    Vec2 force = Vec2::Zero();
    double moment = 0.0;
    Resultant& operator+=(const Resultant& other) {
        force += other.force;
        moment += other.moment;
        return *this;
    }
};

Resultant resultant(const BlockSystem& system, int boundary, double pressure, const Eigen::VectorXd& q) {
    Resultant sum;
    for (const PressureEdge& edge : pressure_edges(system, boundary)) {
        const Block& block = system.blocks[edge.block];
        const Vec2 force = pressure_force(edge, pressure, q);
        const Vec2 at = block.centroid + block.size * edge.xi_middle + displacement_at(q, edge.block, edge.xi_middle);
        sum += {force, cross(at, force)};
    }
    return sum;
}

// Statics: a uniform pressure on a closed outline has neither resultant nor moment, however the body moves as a whole.
TEST(PressureEdges, UniformPressureAllAroundABodyIsInEquilibrium) {
    const BlockSystem system = hexagons();
    Mat2 f;
    f << 1.1, 0.3, -0.2, 0.9;
    for (const Mat2& motion : {Mat2(Mat2::Identity()), rotation_by(1.3), f}) {
        const auto q = affine_motion(system, motion, {0.2, -0.1});
        Resultant sum;
        for (int boundary = 0; boundary < 4; ++boundary) sum += resultant(system, boundary, 2e6, q);
        EXPECT_LT(sum.force.norm(), 1e-12 * 2e6);
        EXPECT_LT(std::abs(sum.moment), 1e-12 * 2e6);
    }
}

// -p times the outward normal times the length: on the top of 0.6 m, 2 MPa push with 1.2 MN/m against its normal.
TEST(PressureEdges, PressureTurnsWithItsBoundary) {
    const BlockSystem system = hexagons();
    constexpr int top = 2;
    for (const double angle : {0.0, 0.4, -1.3}) {
        const auto sum = resultant(system, top, 2e6, affine_motion(system, rotation_by(angle)));
        const Vec2 outward(-std::sin(angle), std::cos(angle)); // of the turned top
        EXPECT_LT((sum.force + 1.2e6 * outward).norm(), 1e-9 * 1.2e6);
    }
}

// What has turned by a right angle shows the pressure another face: it fades over the last ten degrees.
TEST(PressureEdges, PressureLeavesAnEdgeThatHasTurnedAway) {
    const BlockSystem system = hexagons();
    constexpr int top = 2;
    constexpr double degree = std::numbers::pi / 180.0;
    const auto force_at = [&](double angle) {
        return resultant(system, top, 2e6, affine_motion(system, rotation_by(angle * degree))).force.norm();
    };
    EXPECT_NEAR(force_at(79.9), 1.2e6, 1e-3);
    EXPECT_NEAR(force_at(-85.0), 1.2e6 * std::cos(85.0 * degree) / std::cos(80.0 * degree), 1e-3);
    EXPECT_EQ(force_at(91.0), 0.0);
    EXPECT_EQ(force_at(-150.0), 0.0);
}

// Nanson's formula in the plane: the force on a stretched edge is the pressure on its current length.
TEST(PressureEdges, PressureActsOnTheCurrentLength) {
    const BlockSystem system = hexagons();
    Mat2 stretch;
    stretch << 1.25, 0.0, 0.0, 0.8;
    const auto q = affine_motion(system, stretch);
    EXPECT_LT((resultant(system, 2, 2e6, q).force - Vec2(0.0, -1.25 * 1.2e6)).norm(), 1e-9 * 1.2e6);
    EXPECT_LT((resultant(system, 1, 2e6, q).force - Vec2(-0.8 * 0.8e6, 0.0)).norm(), 1e-9 * 1.2e6);
}

/// Of edges as they were cut, or of edges from which the pressure fades (true).
class PressureTangent : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(AsCutOrFading, PressureTangent, testing::Bool());

// Central differences of the generalised force; it is linear in D, and quadratic where the pressure fades, so they are
// exact up to round-off.
TEST_P(PressureTangent, IsMinusTheDerivativeOfTheForce) {
    const BlockSystem system = hexagons();
    Uniform uniform(3);
    const bool fading = GetParam();
    Eigen::VectorXd q = random_motion(system, fading ? 1e-3 : 1e-2, uniform);
    if (fading) q += affine_motion(system, rotation_by(85.0 * std::numbers::pi / 180.0));
    for (const PressureEdge& edge : pressure_edges(system, 1)) {
        const auto force_at = [&](const Eigen::VectorXd& state) {
            Eigen::VectorXd forces = at_rest(system);
            add_force(forces, edge.block, edge.xi_middle, pressure_force(edge, 3e6, state));
            return Vec6(forces.segment<6>(6 * edge.block));
        };
        Mat6 expected;
        for (int i = 0; i < 6; ++i) {
            Eigen::VectorXd plus = q, minus = q;
            plus[6 * edge.block + i] += 1e-3;
            minus[6 * edge.block + i] -= 1e-3;
            expected.col(i) = -(force_at(plus) - force_at(minus)) / 2e-3;
        }
        Mat6 tangent = Mat6::Zero();
        add_pressure_tangent(edge, 3e6, q, tangent);
        EXPECT_GT(expected.norm(), 1e5);
        EXPECT_LT((tangent - expected).norm(), 1e-10 * expected.norm());
    }
}

// ---- constraints ---------------------------------------------------------------------------------------------------

/// Rows on three blocks: one direction, a whole vertex and, dependent on each other, three collinear points.
std::vector<PrescribedDisplacement> some_rows() {
    const Vec2 slanted = Vec2(3, 4) / 5;
    return {{0, {0.3, -0.2}, slanted, 0, 1e-3},       {2, {0.1, 0.5}, Vec2::UnitX(), 1, 2e-3},
            {2, {0.1, 0.5}, Vec2::UnitY(), 1, -1e-3}, {4, {-0.5, 0.4}, Vec2::UnitY(), 2, 1e-3},
            {4, {0.0, 0.4}, Vec2::UnitY(), 2, 2e-3},  {4, {0.5, 0.4}, Vec2::UnitY(), 2, 3e-3}};
}

TEST(Constraints, ProjectionIsIdempotentSymmetricAndLeavesNoMotionOfTheRows) {
    const BlockSystem system = hexagons();
    const Constraints constraints(some_rows());
    Uniform uniform(1);
    const auto v = random_motion(system, 1.0, uniform);
    const auto w = random_motion(system, 1.0, uniform);
    Eigen::VectorXd once = v, of_w = w;
    constraints.project(once);
    constraints.project(of_w);
    Eigen::VectorXd twice = once;
    constraints.project(twice);
    EXPECT_LT((twice - once).norm(), 1e-14 * v.norm());
    EXPECT_NEAR(once.dot(w), v.dot(of_w), 1e-13 * v.squaredNorm());
    for (const auto& row : constraints.rows()) {
        EXPECT_NEAR(displacement_row(row.direction, row.xi).dot(once.segment<6>(6 * row.block)), 0.0, 1e-14);
        EXPECT_GT(std::abs(displacement_row(row.direction, row.xi).dot(v.segment<6>(6 * row.block))), 1e-2);
    }
    // One row, two rows and two independent ones of three take five unknowns away.
    EXPECT_LT((once - v).segment<6>(6).norm(), 1e-15);
    EXPECT_GT((once - v).norm(), 0.1);
}

TEST(Constraints, RowsHoldAfterTheCorrectionWhichIsTheShortest) {
    const BlockSystem system = hexagons();
    const Constraints constraints(some_rows());
    Uniform uniform(2);
    const auto q = random_motion(system, 1e-2, uniform);
    Eigen::VectorXd dq;
    constraints.correction(q, dq);
    for (const auto& row : constraints.rows()) {
        EXPECT_NEAR(row.direction.dot(displacement_at(q + dq, row.block, row.xi)), row.target, 1e-16);
    }
    Eigen::VectorXd in_null_space = dq;
    constraints.project(in_null_space);
    EXPECT_LT(in_null_space.norm(), 1e-14 * dq.norm()); // nothing of it could be left out
    constraints.correction(q + dq, dq);
    EXPECT_LT(dq.norm(), 1e-15);
}

// Two points a hundred-thousandth of a block apart, as where a joint meets a support beside a corner: what round-off leaves at them is
// nothing to correct, though a turn of the block by it would be a hundred thousand times as large.
TEST(Constraints, RowsNearToEachOtherHoldToRoundoff) {
    const BlockSystem system = hexagons();
    const Constraints constraints(
        {{3, {0.3, 0.4}, Vec2::UnitX(), 2, 1e-3}, {3, {0.3, 0.40001}, Vec2::UnitX(), 2, 1e-3}});
    Uniform uniform(2);
    for (int trial = 0; trial < 20; ++trial) {
        Eigen::VectorXd q = random_motion(system, 1e-2, uniform);
        const double roundoff = 1e-13 * q.lpNorm<Eigen::Infinity>();
        Eigen::VectorXd dq;
        constraints.correction(q, dq, roundoff);
        EXPECT_GT(dq.norm(), 1e-4);
        q += dq;
        constraints.correction(q, dq, roundoff);
        q += dq; // the first one was large, and so is its round-off
        constraints.correction(q, dq, 1e-13 * q.lpNorm<Eigen::Infinity>());
        EXPECT_EQ(dq.norm(), 0.0) << trial;
    }
}

// One affine block cannot follow three collinear points to heights 0, 3, 0: least squares takes their mean, 1, and misses
// by 1, -2, 1 (computed again by a QR factorization).
TEST(Constraints, ContradictingRowsAreMetInLeastSquares) {
    const BlockSystem system = hexagons();
    std::vector<PrescribedDisplacement> rows;
    const double targets[3] = {0.0, 3e-3, 0.0};
    Eigen::MatrixXd matrix(3, 6); // of no fixed size, as in other tests: such a factorization takes seconds to compile
    for (int i = 0; i < 3; ++i) {
        rows.push_back({3, Vec2(0.5 * (i - 1), 0.4), Vec2::UnitY(), 2, targets[i]});
        matrix.row(i) = displacement_row(rows.back().direction, rows.back().xi).transpose();
    }
    Eigen::VectorXd dq;
    Constraints(rows).correction(at_rest(system), dq);
    for (const auto& row : rows) EXPECT_NEAR(displacement_at(dq, 3, row.xi).y(), 1e-3, 1e-17);
    const Eigen::VectorXd expected = least_norm_solution(matrix, Eigen::Vector3d(targets));
    EXPECT_LT((dq.segment<6>(18) - expected).norm(), 1e-16);
    EXPECT_NEAR(dq.norm(), expected.norm(), 1e-16);
}

/// Three vertices of two blocks on a platen that travels downward, and a block on a fixed one.
std::vector<PrescribedDisplacement> travelling_rows() {
    return {{0, {-0.5, 0.5}, Vec2::UnitY(), 2, 1e-3, -1.0},
            {0, {0.5, 0.5}, Vec2::UnitY(), 2, 2e-3, -1.0},
            {1, {0.0, 0.5}, Vec2::UnitY(), 2, 3e-3, -1.0},
            {4, {0.0, -0.5}, Vec2::UnitY(), 0, 0.0, 0.0}};
}

// A platen that travels by 5 mm: its rows hold at target - 5 mm, the others at their own.
TEST(Constraints, RowsOfATravellingPlatenFollowItTogether) {
    const BlockSystem system = hexagons();
    const Constraints constraints(travelling_rows());
    Eigen::VectorXd dq;
    constraints.correction(at_rest(system), dq);
    const Eigen::VectorXd q = dq + 5e-3 * constraints.travel_motion(dq.size());
    const double travel = (1e-3 - displacement_at(q, 0, {-0.5, 0.5}).y());
    for (const auto& row : constraints.rows()) {
        EXPECT_NEAR(displacement_at(q, row.block, row.xi).y(), row.target + row.rate * travel, 1e-16);
    }
    constraints.correction(q, dq);
    EXPECT_LT(dq.norm(), 1e-15); // holds wherever the platen is
}

// Least squares: the platen comes to where it misses its vertices least, the mean of what they lack.
TEST(Constraints, CorrectionLeavesATravellingPlatenWhereItsVerticesAre) {
    const BlockSystem system = hexagons();
    const Constraints constraints(travelling_rows());
    Eigen::VectorXd q = at_rest(system);
    const double heights[] = {1e-3 - 4e-3, 2e-3 - 5e-3, 3e-3 - 9e-3}; // on the way down by 4, 5 and 9 mm: 6 mm
    set_motion(system, 1, {0.0, heights[2]}, Mat2::Zero(), q);
    const double slope = (heights[1] - heights[0]) / system.blocks[0].size;
    Mat2 turn;
    turn << 0, 0, slope, 0;
    set_motion(system, 0, {0.0, 0.5 * (heights[0] + heights[1])}, turn, q);
    Eigen::VectorXd dq;
    constraints.correction(q, dq);
    const double reached[] = {1e-3 - 6e-3, 2e-3 - 6e-3, 3e-3 - 6e-3};
    for (int i = 0; i < 3; ++i) {
        const auto& row = constraints.rows()[i];
        EXPECT_NEAR(displacement_at(q, row.block, row.xi).y(), heights[i], 1e-16);
        EXPECT_NEAR(displacement_at(q + dq, row.block, row.xi).y(), reached[i], 1e-16);
    }
}

// K := P K P + scale (1 - P), from the dense projector made of the projected unit vectors.
TEST(Constraints, ProjectionOfAMatrixIsThatOfItsRowsAndColumns) {
    const BlockSystem system = hexagons();
    std::vector<std::pair<int, int>> pairs;
    for (const Interface& interface : system.interfaces) pairs.emplace_back(interface.block_a, interface.block_b);
    const BlockPattern pattern(system.n_blocks(), pairs);
    BlockMatrix matrix;
    matrix.reset(pattern);
    Uniform uniform(6);
    for (Mat6& value : matrix.values) {
        for (double& x : value.reshaped()) x = uniform(-1, 1);
    }
    const Constraints constraints(some_rows());
    const Eigen::Index n = 6 * system.n_blocks();
    Eigen::MatrixXd projector(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, i);
        constraints.project(unit);
        projector.col(i) = unit;
    }
    const Eigen::MatrixXd expected =
        projector * dense(matrix) * projector + 7.0 * (Eigen::MatrixXd::Identity(n, n) - projector);
    EXPECT_NEAR(projector.trace(), static_cast<double>(n) - 5.0,
                1e-12); // one, two and, of three collinear points, two rows
    project(constraints, matrix, 7.0);
    EXPECT_LT((dense(matrix) - expected).cwiseAbs().maxCoeff(), 1e-14);
}

/// A square of 1 m on smooth supports at its bottom (boundary 0) and its left (boundary 3), rows as StageLoads makes them.
struct ProppedSquare {
    BlockSystem system = cut_blocks(cut_scenes::rectangle(1.0, 1.0)).system;
    Constraints constraints{std::vector<PrescribedDisplacement>{{0, {-0.5, -0.5}, {0, -1}, 0, 0.0},
                                                                {0, {0.5, -0.5}, {0, -1}, 0, 0.0},
                                                                {0, {-0.5, -0.5}, {-1, 0}, 3, 0.0},
                                                                {0, {-0.5, 0.5}, {-1, 0}, 3, 0.0}}};
};

// By hand: a square of 1 m pressed by 3 MPa from above and 2 MPa from the right rests with 3 MN/m and 2 MN/m on its
// supports. Its own stress is that of the loads: internal forces h P = -(3, 2) MPa on D.
TEST(Constraints, ReactionBalancesTheLoads) {
    const ProppedSquare square;
    Eigen::VectorXd residual = at_rest(square.system);  // internal less external without the supports
    add_force(residual, 0, {0.0, 0.5}, Vec2(0.0, 3e6)); // minus the load of the top
    add_force(residual, 0, {0.5, 0.0}, Vec2(2e6, 0.0));
    residual[2] += -2e6; // h P_xx
    residual[5] += -3e6; // h P_yy
    EXPECT_LT((square.constraints.reaction(residual, 0) - Vec2(0.0, 3e6)).norm(), 1e-8);
    EXPECT_LT((square.constraints.reaction(residual, 3) - Vec2(2e6, 0.0)).norm(), 1e-8);
    EXPECT_EQ(square.constraints.reaction(residual, 1), Vec2(0.0, 0.0));
    square.constraints.project(residual);
    EXPECT_LT(residual.norm(), 1e-8); // the supports carry all of it
}

// By hand: a load of 4 MN/m at three quarters of the width leaves 1 and 3 MN/m on the two corners; their sum is 4.
TEST(Constraints, ReactionOfAnEccentricLoadIsItsResultant) {
    const ProppedSquare square;
    Eigen::VectorXd residual = at_rest(square.system);
    add_force(residual, 0, {0.25, 0.5}, Vec2(0.0, 4e6));
    residual[5] += -4e6; // h P_yy of the load over the height
    EXPECT_LT((square.constraints.reaction(residual, 0) - Vec2(0.0, 4e6)).norm(), 1e-8);
    EXPECT_LT(square.constraints.reaction(residual, 3).norm(), 1e-8);
}

} // namespace
} // namespace kluft

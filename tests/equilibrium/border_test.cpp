#include "kluft/equilibrium/border.hpp"

#include <gtest/gtest.h>

#include "support/dense_solution.hpp"
#include "support/pressed_body.hpp"

namespace kluft {
namespace {

using cut_scenes::Uniform;

/// A body under a travelling platen, in a state that is no equilibrium, with its dense tangent.
struct Bordered {
    explicit Bordered(Kinematics kinematics) : body(true, {1, 0}, kinematics) {
        increment = Eigen::VectorXd::Zero(coordinates().size());
        for (double& value : increment) value = uniform(-3e-5, 3e-5);
        coordinates().move(at_rest(body.system), increment, 1.0, q);
        border = border_of_platen(body.problem, coordinates());
    }
    [[nodiscard]] const Coordinates& coordinates() const { return evaluator.coordinates(); }

    Uniform uniform{5};
    PressedBody body;
    BlockPattern pattern = pattern_of(body.problem);
    EquilibriumEvaluator evaluator{body.problem, pattern};
    Eigen::VectorXd increment, q;
    Border border;
};

TEST(Border, ExistsUnderATravellingPlatenAlone) {
    for (const bool travelling : {false, true}) {
        const PressedBody body(travelling, {1, 1});
        const Coordinates coordinates(body.system, Kinematics::affine);
        EXPECT_EQ(border_of_platen(body.problem, coordinates).exists(), travelling);
    }
}

// The definition: the vertices of the platen follow its travel, here downward, and all others stay.
TEST(Border, UnitTravelMovesTheRowsOfThePlatenByTheirRates) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        const Bordered bordered(kinematics);
        const DenseRows rows(bordered.body.problem);
        EXPECT_GT(rows.rates.norm(), 1.0);
        EXPECT_LT((rows.matrix * bordered.border.motion - rows.rates).norm(), 1e-12);
    }
}

// Central differences of v . R - stress width along a random increment.
TEST(Border, RowIsTheDerivativeOfThePlatensImbalance) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Bordered bordered(kinematics);
        bordered.body.problem.loads.platen_force->stress = 5e8; // the part of the width shows
        const auto imbalance_after = [&](double s) {
            Eigen::VectorXd moved;
            Residual residual;
            bordered.coordinates().move(bordered.q, bordered.increment, s, moved);
            bordered.evaluator.reduced_residual(moved, residual);
            return platen_imbalance(bordered.body.problem, bordered.border, moved, residual.forces);
        };
        const double h = 1e-4;
        const double expected = -(imbalance_after(h) - imbalance_after(-h)) / (2.0 * h);
        BlockMatrix tangent;
        (void)imbalance_after(0.0);
        bordered.evaluator.tangent(bordered.q, TangentKind::exact, tangent);
        set_platen_equation(bordered.body.problem, bordered.coordinates(), tangent, bordered.border);
        const Eigen::VectorXd& row = bordered.border.row;
        EXPECT_NEAR(row.dot(bordered.increment), expected, 1e-5 * row.norm() * bordered.increment.norm());
    }
}

// The dense bordered system with a Lagrange multiplier for every row,
//     [K C' 0; C 0 -rate; row 0 0] (dq, multipliers, t) = (b, 0, missing),
// against two solutions in the null space of the rows and the elimination of t.
TEST(Border, EliminationSolvesTheDenseBorderedSystem) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Bordered bordered(kinematics);
        const OwnedProblem& problem = bordered.body.problem;
        Border& border = bordered.border;
        Residual residual;
        bordered.evaluator.reduced_residual(bordered.q, residual);
        BlockMatrix tangent;
        bordered.evaluator.tangent(bordered.q, TangentKind::exact, tangent);
        set_platen_equation(problem, bordered.coordinates(), tangent, border);
        const DenseRows rows(problem);
        const Eigen::Index n = residual.forces.size(), m = rows.rates.size();
        const Eigen::VectorXd b = -residual.forces;
        const double missing = 3e5;

        Eigen::MatrixXd system = rows.bordered(dense(tangent));
        system.block(n + m, 0, 1, n) = border.row.transpose();
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n + m + 1);
        right.head(n) = b;
        right[n + m] = missing;
        const Eigen::VectorXd expected = dense_solution(system, right).head(n);

        Eigen::MatrixXd projector(n, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, i);
            problem.loads.constraints.project(unit);
            projector.col(i) = unit;
        }
        const Eigen::MatrixXd free = projector * dense(tangent) * projector +
                                     dense(tangent).norm() * (Eigen::MatrixXd::Identity(n, n) - projector);
        const Eigen::VectorXd response = dense_solution(free, border.column);
        Eigen::VectorXd increment = dense_solution(free, projector * b);
        border.add_to(missing, response, increment);
        EXPECT_LT((increment - expected).norm(), 1e-8 * expected.norm());
    }
}

// Statics: what is left of the forces has their work in a motion of the null space, and in unit travel what the platen
// lacks.
TEST(Border, FreePartHasTheWorkOfTheForcesInEveryFreeMotion) {
    for (const Kinematics kinematics : {Kinematics::affine, Kinematics::rigid}) {
        Bordered bordered(kinematics);
        const OwnedProblem& problem = bordered.body.problem;
        Residual residual;
        bordered.evaluator.reduced_residual(bordered.q, residual);
        Eigen::VectorXd free = residual.forces;
        keep_free_part(problem, bordered.border, bordered.q, free);
        Eigen::VectorXd motion = bordered.increment;
        problem.loads.constraints.project(motion);
        const double scale = residual.forces.norm();
        EXPECT_GT(motion.norm(), 0.5 * bordered.increment.norm());
        EXPECT_NEAR(free.dot(motion), residual.forces.dot(motion), 1e-12 * scale * motion.norm());
        const PlatenForce& platen = *problem.loads.platen_force;
        const double width = 0.5 + mean_displacement(bordered.body.system, bordered.q, 1).x() -
                             mean_displacement(bordered.body.system, bordered.q, 3).x();
        EXPECT_NEAR(free.dot(bordered.border.motion),
                    residual.forces.dot(bordered.border.motion) - platen.stress * width, 1e-9 * scale);
    }
}

} // namespace
} // namespace kluft

#include "kluft/equilibrium/border.hpp"

namespace kluft {

void Border::add_to(double missing, const Eigen::VectorXd& response, Eigen::VectorXd& increment) const {
    const Eigen::VectorXd with_travel = response + motion;
    increment += (missing - row.dot(increment)) / row.dot(with_travel) * with_travel;
}

Border border_of_platen(const EquilibriumProblem& problem, const Coordinates& coordinates) {
    Border border;
    border.motion = travel_of_platen(*problem.body.loads, coordinates.size());
    return border;
}

/// The row is v' K - stress dw/dq: a platen on a widening body pushes harder.
void set_platen_equation(const EquilibriumProblem& problem, const Coordinates& coordinates, const BlockMatrix& tangent,
                         Border& border) {
    tangent.multiply(border.motion, border.column);
    tangent.multiply_transposed(border.motion, border.row);
    Eigen::VectorXd widening;
    coordinates.reduce(problem.body.loads->platen_force->widening, widening);
    border.row -= problem.body.loads->platen_force->stress * widening;
    border.column *= -1.0;
    problem.body.loads->constraints.project(border.column);
}

double platen_imbalance(const EquilibriumProblem& problem, const Border& border, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& forces) {
    return problem.body.loads->platen_force->at(q) - border.motion.dot(forces);
}

void keep_free_part(const EquilibriumProblem& problem, const Border& border, const Eigen::VectorXd& q,
                    Eigen::VectorXd& forces) {
    keep_free_part(*problem.body.loads, border.motion, q, forces);
}

} // namespace kluft

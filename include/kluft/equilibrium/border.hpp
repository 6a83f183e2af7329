// One unknown and one equation beside those of the blocks: the travel of a platen under a given force (docs/theory.md,
// "A platen under a given stress").
#pragma once

#include <Eigen/Core>

#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// The linear system of an increment dq = x + t motion, x in the null space of the prescribed rows (projector P), t the
/// unknown more:
///
///     P K dq = P b,   row . dq = missing.
///
/// Block elimination solves it with the factor of K on the null space alone: `column` is its second right side.
struct Border {
    Eigen::VectorXd motion; ///< of the unknowns for t = 1; empty where there is no border
    Eigen::VectorXd column; ///< -P K motion
    Eigen::VectorXd row;    ///< derivative of the equation with respect to the unknowns

    [[nodiscard]] bool exists() const { return motion.size() > 0; }
    /// Completes `increment`, the solution of P K x = P b in the null space, by t times the motion and the response of
    /// the blocks to it, the solution of P K x = column.
    void add_to(double missing, const Eigen::VectorXd& response, Eigen::VectorXd& increment) const;
};

/// The motion v of the unknowns for unit travel of the platen under a given force (1); no border where there is none.
[[nodiscard]] Border border_of_platen(const EquilibriumProblem& problem, const Coordinates& coordinates);

/// Takes column and row of the platen's equation v . R = stress width(q) from a tangent that has the prescribed motions
/// still in it; the coordinates are turned to its q.
void set_platen_equation(const EquilibriumProblem& problem, const Coordinates& coordinates, const BlockMatrix& tangent,
                         Border& border);

/// What the platen's force exceeds the work of `forces` on the unknowns by, stress width(q) - v . forces (N/m).
[[nodiscard]] double platen_imbalance(const EquilibriumProblem& problem, const Border& border, const Eigen::VectorXd& q,
                                      const Eigen::VectorXd& forces);

/// Takes the reactions of supports and platens out of the residual at q, forces on the unknowns. What remains has the
/// work of the forces in every free motion, the platen's travel included.
void keep_free_part(const EquilibriumProblem& problem, const Border& border, const Eigen::VectorXd& q,
                    Eigen::VectorXd& forces);

} // namespace kluft

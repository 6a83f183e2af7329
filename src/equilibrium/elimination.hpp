// Nonlinear elimination: before the next global step of an iteration, the few blocks that carry most of the forces are put
// right by themselves (docs/theory.md, "Elimination").
#pragma once

#include <optional>

#include <Eigen/Core>

#include "iterate.hpp"
#include "kluft/equilibrium/local_iteration.hpp"
#include "kluft/equilibrium/open_close_solver.hpp"
#include "stopping_test.hpp"

namespace kluft {

/// Puts right the iterates of given equations, those of affine blocks that have contacts; others it leaves as they are.
class Elimination {
public:
    Elimination(Equations& equations, IterationSeconds& seconds) : equations_(equations), seconds_(seconds) {}

    /// Rounds of local iterations from the iterate `at` of q, as long as the norm of all forces falls by them and is above
    /// `enough` (N/m), and not more than a `largest_part` of all blocks carries most of it. Afterwards `at` is the iterate of the new q, and the tangent of the equations belongs to it. False where
    /// nothing has moved.
    bool improve(double enough, double largest_part, Iterate& at, Eigen::VectorXd& q);
    /// Rounds of local iterations on single blocks that are not balanced in an iterate that meets the tolerance for the body
    /// as a whole, if not more than a `largest_part` of all. True if q is an equilibrium afterwards; else all is as it was.
    [[nodiscard]] bool balances(StoppingTest& stopping, double largest_part, Iterate& at, Eigen::VectorXd& q);

private:
    [[nodiscard]] bool has_any(const Iterate& at) const;
    [[nodiscard]] bool moves_far(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;
    [[nodiscard]] LocalIteration& local();

    Equations& equations_;
    IterationSeconds& seconds_;
    std::optional<LocalIteration> local_; ///< made where it is needed
};

} // namespace kluft

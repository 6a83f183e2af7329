// Newton's method with a damping that follows from its success, for equilibria that the work along the increment does not
// lead to (docs/theory.md, "Damped iteration").
#pragma once

#include <Eigen/Core>

#include "elimination.hpp"
#include "iterate.hpp"
#include "kluft/equilibrium/newton_increment.hpp"
#include "stopping_test.hpp"

namespace kluft {

/// One damped iteration on given equations, of affine blocks.
class DampedIteration {
public:
    DampedIteration(Equations& equations, Elimination& elimination, NewtonIncrement& newton,
                    const OpenCloseOptions& options, double& seconds)
        : equations_(equations), elimination_(elimination), newton_(newton), options_(options), seconds_(seconds) {}

    /// Goes from q, where the prescribed displacements hold, to an equilibrium, which becomes q. False where the forces do not
    /// fall enough, by a half in `patience` linear solves: q is the iterate with the least then. Counts its linear solves in `n_solves`.
    [[nodiscard]] bool find(StoppingTest& stopping, int patience, int& n_solves, Eigen::VectorXd& q);

private:
    Equations& equations_;
    Elimination& elimination_;
    NewtonIncrement& newton_;
    const OpenCloseOptions& options_;
    double& seconds_; ///< in residuals
};

} // namespace kluft

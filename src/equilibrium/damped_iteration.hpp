// Newton's method with a damping that follows from its success, for equilibria that the work along the increment does not
// lead to (docs/theory.md, "Damped iteration").
#pragma once

#include <Eigen/Core>

#include "iterate.hpp"
#include "kluft/equilibrium/local_iteration.hpp"
#include "kluft/equilibrium/newton_increment.hpp"
#include "stopping_test.hpp"

namespace kluft {

/// One damped iteration on given equations, of affine blocks.
class DampedIteration {
public:
    DampedIteration(Equations& equations, NewtonIncrement& newton, const OpenCloseOptions& options, double& seconds)
        : equations_(equations), newton_(newton), options_(options), seconds_(seconds), local_(equations.problem) {}

    /// Goes from q, where the prescribed displacements hold, to an equilibrium, which becomes q. False where the forces do not
    /// fall enough: q is the iterate with the least then. Counts its linear solves in `n_solves`.
    [[nodiscard]] bool find(StoppingTest& stopping, int& n_solves, Eigen::VectorXd& q);

private:
    void improve_locally(const StoppingTest& stopping, Iterate& at, Eigen::VectorXd& q);

    Equations& equations_;
    NewtonIncrement& newton_;
    const OpenCloseOptions& options_;
    double& seconds_;
    LocalIteration local_;
};

} // namespace kluft

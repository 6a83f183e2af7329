// A body whose stiffness is factorized, as it is during a load step.
#pragma once

#include <span>

#include "body.hpp"
#include "kluft/assembly/linear_solver.hpp"

namespace kluft::bench {

class FactoredBody {
public:
    /// Factorizes once, which also finds the structure of the factor.
    explicit FactoredBody(const Body& body);

    /// Stiffness of the unchanged body, as in every iteration.
    void assemble();
    /// The same after changes.
    void assemble(std::span<const StiffnessChange> changes);
    void factorize();
    /// Back to the unchanged body with a factor that has no changes.
    void restore();
    /// Puts the changes on the factor; false where a factorization is due instead.
    [[nodiscard]] bool update(std::span<const StiffnessChange> changes);
    /// With the factor and its changes.
    void solve();
    /// The same, refined against the assembled stiffness. Returns the number of Krylov vectors.
    int solve_refined();

    [[nodiscard]] const Body& body() const { return body_; }

private:
    const Body& body_;
    EquilibriumEvaluator evaluator_;
    LinearSolver solver_;
    BlockMatrix matrix_;
    Eigen::VectorXd load_;
    Eigen::VectorXd solution_;
    bool matrix_is_changed_ = false;
    bool factor_is_changed_ = false;
};

} // namespace kluft::bench

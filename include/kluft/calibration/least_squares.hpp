// Least squares within bounds, by Ipopt with the Hessian of Gauss and Newton.
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>

namespace kluft {

/// ResidualRows and their derivatives.
struct ResidualRows {
    Eigen::VectorXd values;   ///< size m
    Eigen::MatrixXd jacobian; ///< m x n
};

/// The residuals at x (size n); nothing where there are none, which makes the step shorter.
using ResidualFunction = std::function<std::optional<ResidualRows>(const Eigen::VectorXd& x)>;

struct LeastSquaresOptions {
    double residual = 1e-8;     ///< ends where none of the judged residuals is larger in magnitude
    Eigen::Index n_judged = -1; ///< residuals that are judged, the first ones; -1: all
    int max_evaluations = 100;
};

struct LeastSquaresResult {
    Eigen::VectorXd x;      ///< the best that was evaluated
    ResidualRows residuals; ///< there
    int evaluations = 0;    ///< of the function, each place once
    bool converged = false; ///< to the residual or to a minimum
};

/// Minimises the sum of the squares of the residuals for lower <= x <= upper (size n each), from `start`, which is moved
/// into the bounds; what has equal bounds does not move. Where residuals vanish at the minimum the convergence is quadratic. Throws InputError where there are no
/// residuals at `start`.
[[nodiscard]] LeastSquaresResult minimise_squares(const ResidualFunction& function, const Eigen::VectorXd& start,
                                                  const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                                  const LeastSquaresOptions& options = {});

} // namespace kluft

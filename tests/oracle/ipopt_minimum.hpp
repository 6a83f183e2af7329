// Minimum of a potential by Ipopt's interior-point method.
#pragma once

#include <string>

#include <Eigen/Core>

#include "oracle/potential.hpp"

namespace kluft::oracle {

/// What unknowns and forces are measured in, so that Ipopt sees numbers about one.
struct Scales {
    double length = 1.0; ///< m
    double force = 1.0;  ///< N/m
};

struct Minimum {
    Eigen::VectorXd x;                 ///< m
    Eigen::VectorXd equality_forces;   ///< that the conditions exert along their forms (N/m)
    Eigen::VectorXd inequality_forces; ///< >= 0 (N/m)
    int iterations = 0;
    bool converged = false;
    std::string status;
};

/// Tolerance 1e-12 in the scaled unknowns and forces, without relaxation of bounds. `weight`: of the barrier at the start;
/// small where `guess` is near the minimum.
[[nodiscard]] Minimum minimise(const Potential& potential, const Eigen::VectorXd& guess, const Scales& scales,
                               double weight);

} // namespace kluft::oracle

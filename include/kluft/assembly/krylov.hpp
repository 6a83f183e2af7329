// Flexible GMRES (Saad, SIAM J. Sci. Comput. 14, 1993): refines what a factor of a nearby matrix solves.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace kluft {

/// Keeps its basis between solutions, so that only the first ones allocate.
class Gmres {
public:
    using Operator = std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)>; ///< y = A x
    using Bound = std::function<double(double correction)>; ///< of |r|, from an estimate of the correction's norm

    /// Adds to x the correction for the residual r = b - A x. Stops where |r| by the recurrence is within the bound or
    /// after `max_vectors`. Returns the number of applications of the preconditioner.
    int correct(const Operator& matrix, const Operator& precondition, int max_vectors, const Bound& bound,
                const Eigen::VectorXd& r, Eigen::VectorXd& x);

    /// Gives the memory of the basis back.
    void release() { v_ = z_ = {}; }

private:
    void extend_basis(int n);
    void rotate(int column);

    std::vector<Eigen::VectorXd> v_; ///< orthonormal
    std::vector<Eigen::VectorXd> z_; ///< preconditioned
    std::vector<Eigen::VectorXd> h_; ///< columns of the triangle
    Eigen::VectorXd cosine_, sine_, right_side_, weights_;
};

} // namespace kluft

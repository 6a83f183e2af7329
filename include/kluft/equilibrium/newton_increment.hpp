// Newton's increment (28): the tangent of the moment, and the linear system with the prescribed motions and the
// platen's travel in it.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/border.hpp"
#include "kluft/equilibrium/reused_factor.hpp"

namespace kluft {

/// Where an increment starts, and the equations there.
struct NewtonPoint {
    EquilibriumEvaluator& evaluator; ///< of which the last residual was that at q
    Border& border;                  ///< of the problem's platen; column and row are set here
    const Eigen::VectorXd& q;
    const Residual& residual; ///< at q, on the unknowns
    const Eigen::VectorXd&
        prescribed;         ///< change of the unknowns that prescribed displacements ask for; zero: they hold
    double tolerance = 0.0; ///< of |R|/F_ref: near equilibrium a linear solve leaves less
    double largest_residual = std::numeric_limits<double>::infinity(); ///< of a linear solve (N/m)
    double damping = 0.0; ///< lambda: the tangent is that at q plus lambda M (29c), of affine blocks (Pa/m2)
};

/// Takes the unknowns that constraints prescribe out of a matrix over the unknowns: their rows and columns are those of a diagonal.
void make_free(const Constraints& constraints, BlockMatrix& matrix);

struct NewtonOptions {
    bool reuse = true;          ///< of the factor; false: the tangent itself is factorized anew
    double motion_limit = 0.04; ///< largest relative motion of neighbours, and distortion, of the motion_scale (28a)
};

/// Finds increments one after the other, and keeps the factor in between.
class NewtonIncrement {
public:
    NewtonIncrement(LinearSolver& linear_solver, NewtonOptions options)
        : linear_solver_(linear_solver), options_(options), factor_(linear_solver) {}

    /// Finds the increment of the unknowns with a tangent of this kind, inside the limit of motions. False if the
    /// tangent cannot be factorized.
    [[nodiscard]] bool find(const NewtonPoint& at, TangentKind kind);
    [[nodiscard]] const Eigen::VectorXd& increment() const { return increment_; }
    /// Blocks whose motion would have been beyond the limit, in ascending order.
    [[nodiscard]] const std::vector<int>& limited() const { return limited_; }

    /// The next increment makes a new factor.
    void forget_factor() { factor_.forget(); }
    /// The same, and what follows does not depend on what was found before.
    void start_anew() { factor_.forget_all(); }
    /// Time spent so far in tangents (s).
    [[nodiscard]] double assembly_seconds() const { return assembly_seconds_; }

private:
    void assemble(const NewtonPoint& at, TangentKind kind);
    void assemble_symmetric(const NewtonPoint& at);
    [[nodiscard]] bool solve_anew(const NewtonPoint& at, TangentKind kind);
    [[nodiscard]] bool solve_with_reuse(const NewtonPoint& at, TangentKind kind);
    [[nodiscard]] bool solve_without_factor(const NewtonPoint& at);
    [[nodiscard]] bool solve_refined(const NewtonPoint& at);
    void limit_motions(const NewtonPoint& at);

    LinearSolver& linear_solver_;
    NewtonOptions options_;
    ReusedFactor factor_;
    BlockMatrix matrix_;
    Eigen::VectorXd right_side_, increment_;
    Eigen::VectorXd response_; ///< solution for the border's column
    Eigen::VectorXd scratch_;
    std::vector<int> limited_;
    double assembly_seconds_ = 0.0;
};

} // namespace kluft

// Open-close iteration: Newton's method on the one residual, with contact states following from the displacements.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/linear_solver.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/equilibrium/newton_increment.hpp"

namespace kluft {

struct OpenCloseOptions {
    double tolerance = 1e-5; ///< of |R|/F_ref
    int max_iterations = 12; ///< linear solves per attempt: give up early, a relaxation is cheaper (measured)
    TangentKind tangent = TangentKind::exact;
    bool reuse = true; ///< of the factor from one linear solve to the next; false: the exact tangent is factorized anew
    double motion_limit = 0.04; ///< largest relative motion per iteration, of the lattice spacing (28a)
};

enum class Aim {
    equilibrium, ///< to the tolerance
    relaxation   ///< a step on the way: a residual well below the mass-like forces is enough, and few iterations
};

/// What a solve is to come to.
struct IterationGoal {
    Aim aim = Aim::equilibrium;
    /// The body's contacts carry no force yet and therefore have no stiffness: the first increment takes the touching
    /// ones as closed.
    bool unloaded = false;
    /// The loads are given, and not the motion of a platen: where the iteration goes on with damping it has more patience.
    bool given_loads = false;
    /// Largest residual of a block over its own force (block_balance.hpp), beside the tolerance for all together.
    double block_tolerance = std::numeric_limits<double>::infinity();
    double tolerance_share = 1.0; ///< of the tolerance for all together, that is asked for
};

enum class Termination {
    converged,      ///< q is an equilibrium
    relaxed,        ///< q is near enough to one for a relaxation
    max_iterations, ///< q is the last iterate, no equilibrium
    singular,       ///< the stiffness could not be factorized: nothing holds a part of the body
    not_finite      ///< a displacement, a force or an increment is no finite number
};

struct OpenCloseSummary {
    Termination termination = Termination::max_iterations;
    int iterations = 0;          ///< linear solves
    double residual_ratio = 0.0; ///< |R|/F_ref at q
    double force_scale = 0.0;    ///< F_ref (N/m)
    double left_to_go = 0.0;     ///< of the prescribed displacements (m): before they hold there may be no forces
    int worst_block = -1;        ///< the block with the largest residual
    std::string flaw;            ///< what is no finite number, and where; "" otherwise
    [[nodiscard]] bool converged() const { return termination == Termination::converged; }
};

/// Time spent so far (s).
struct IterationSeconds {
    double residual = 0.0; ///< of all blocks
    double local = 0.0;    ///< in iterations on some
};

class OpenCloseSolver {
public:
    OpenCloseSolver(LinearSolver& linear_solver, OpenCloseOptions options)
        : options_(options), newton_(linear_solver, {options.reuse, options.motion_limit}) {}

    /// Newton with root finding on R . dq from the guess q, which becomes the last iterate. The linear solver must
    /// have analysed `pattern`.
    OpenCloseSummary solve(const EquilibriumProblem& problem, const BlockPattern& pattern, Eigen::VectorXd& q,
                           const IterationGoal& goal = {});

    [[nodiscard]] const OpenCloseOptions& options() const { return options_; }
    void set_tolerance(double tolerance) { options_.tolerance = tolerance; }

    /// The next linear solve makes a new factor: what follows does not depend on what was solved before.
    void start_anew() { newton_.start_anew(); }

    /// Time spent so far in residuals and tangents (s).
    [[nodiscard]] double assembly_seconds() const { return seconds_.residual + newton_.assembly_seconds(); }

    /// Time spent so far in local iterations (s).
    [[nodiscard]] double local_seconds() const { return seconds_.local; }

private:
    OpenCloseOptions options_;
    NewtonIncrement newton_;
    IterationSeconds seconds_;
};

} // namespace kluft

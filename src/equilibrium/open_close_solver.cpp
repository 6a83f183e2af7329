#include "kluft/equilibrium/open_close_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "kluft/core/stopwatch.hpp"
#include "kluft/equilibrium/left_over.hpp"
#include "kluft/equilibrium/line_search.hpp"

namespace kluft {

namespace {

constexpr int iterations_before_halving = 8; ///< then the norm must fall, or it is searched on
constexpr double short_step = 0.1;           ///< of the increment: this way leads nowhere
constexpr int max_short_steps = 3;           ///< in succession
constexpr double restless_share = 0.2;       ///< of the norm of the residual
constexpr int relaxation_iterations = 6;     ///< of one step: what takes more needs more mass (measured)
constexpr double block_linear_share = 0.3;   ///< of what is allowed on a block: what a linear solve may leave
constexpr double relaxed_share = 0.2;        ///< of the mass-like forces, that a step of relaxation may leave
constexpr double usual_tolerance = 1e-5;     ///< with a smaller one such a step leaves less, in proportion

/// The equations of one solve.
struct Equations {
    Equations(const EquilibriumProblem& to_solve, const BlockPattern& pattern)
        : problem(to_solve), evaluator(problem, pattern), border(border_of_platen(problem, evaluator.coordinates())) {}

    const EquilibriumProblem& problem;
    EquilibriumEvaluator evaluator;
    Border border;
};

/// The forces at an iterate.
struct Iterate {
    Residual residual;           ///< on the unknowns
    Eigen::VectorXd free_forces; ///< the residual without reactions
    double norm = 0.0;           ///< of the free forces (N/m)
    Eigen::VectorXd prescribed;  ///< change of the unknowns that prescribed displacements ask for
    bool held = false;           ///< they hold up to round-off, and `prescribed` is zero
};

void evaluate(Equations& equations, const Eigen::VectorXd& q, double& seconds, Residual& residual) {
    const Stopwatch watch(seconds);
    equations.evaluator.reduced_residual(q, residual);
}

void evaluate(Equations& equations, const Eigen::VectorXd& q, double& seconds, Iterate& at) {
    evaluate(equations, q, seconds, at.residual);
    equations.problem.body.loads->constraints.correction(q, at.prescribed);
    at.free_forces = at.residual.forces;
    keep_free_part(equations.problem, equations.border, q, at.free_forces);
    at.norm = at.free_forces.norm();
    at.held = at.prescribed.lpNorm<Eigen::Infinity>() <= equations.evaluator.coordinates().roundoff(q);
    if (at.held) at.prescribed.setZero();
}

int largest_block(const Coordinates& coordinates, const Eigen::VectorXd& forces) {
    int worst = 0;
    double largest = -1.0;
    for (int b = 0; b < coordinates.n_blocks(); ++b) {
        const double size = coordinates.squared_norm(forces, b);
        if (size > largest) {
            largest = size;
            worst = b;
        }
    }
    return worst;
}

/// Searches along one increment after the other.
class Search {
public:
    Search(Equations& equations, double& seconds) : equations_(equations), seconds_(seconds) {}

    /// Finds the step length from q, where the free forces are those of the iterate: a root of the work along the
    /// increment; where that does not fall at first, or where root finding `stalls`, one with a smaller norm.
    [[nodiscard]] double step_length(const Eigen::VectorXd& q, const Eigen::VectorXd& increment, const Iterate& from,
                                     bool stalls) {
        const auto slope_at = [&](double s) { return free_forces(q, increment, s).dot(increment); }; // (29)
        const auto norm_at = [&](double s) { return free_forces(q, increment, s).norm(); };
        const double slope_at_zero = from.free_forces.dot(increment);
        if (slope_at_zero < 0.0 && !stalls) return step_to_root(slope_at_zero, slope_at);
        return step_by_halving(from.norm, norm_at);
    }

    /// The free forces at the end of the last full increment that was searched on; empty before.
    [[nodiscard]] const Eigen::VectorXd& full_step_forces() const { return full_step_forces_; }

private:
    const Eigen::VectorXd& free_forces(const Eigen::VectorXd& q, const Eigen::VectorXd& increment, double s) {
        equations_.evaluator.coordinates().move(q, increment, s, position_);
        evaluate(equations_, position_, seconds_, trial_);
        keep_free_part(equations_.problem, equations_.border, position_, trial_.forces);
        if (s == 1.0) full_step_forces_ = trial_.forces;
        return trial_.forces;
    }

    Equations& equations_;
    double& seconds_;
    Eigen::VectorXd position_;
    Residual trial_;
    Eigen::VectorXd full_step_forces_;
};

/// Blocks whose part of the forces is larger than a share of their own.
struct UnbalancedBlocks {
    std::vector<int> blocks;                                        ///< the worst first
    double least_allowed = std::numeric_limits<double>::infinity(); ///< part of the forces on any of them (N/m)
};

UnbalancedBlocks unbalanced_blocks(const Equations& equations, const Eigen::VectorXd& q, const Eigen::VectorXd& forces,
                                   double tolerance) {
    UnbalancedBlocks result;
    if (!std::isfinite(tolerance)) return result;
    const Coordinates& coordinates = equations.evaluator.coordinates();
    const OwnForces own = own_forces(equations.problem.body, q);
    double worst = 0.0;
    for (int b = 0; b < coordinates.n_blocks(); ++b) {
        const double left = size_of(rigid_part(coordinates, *equations.problem.body.system, q, forces, b));
        const double allowed = tolerance * own.around[b] + own.roundoff[b];
        if (left <= allowed || own.around[b] == 0.0) continue; // it may touch nothing
        result.blocks.push_back(b);
        result.least_allowed = std::min(result.least_allowed, allowed);
        if (left <= worst * allowed) continue;
        worst = left / std::max(allowed, 1e-300);
        std::swap(result.blocks.front(), result.blocks.back());
    }
    return result;
}

/// The blocks that have a large part of the forces, or that limited the increment.
std::vector<int> restless_blocks(const Coordinates& coordinates, const Eigen::VectorXd& forces,
                                 const std::vector<int>& limited) {
    std::vector<int> restless = limited;
    if (forces.size() == 0) return restless;
    const double least = restless_share * forces.norm();
    for (int b = 0; b < coordinates.n_blocks(); ++b) {
        if (std::sqrt(coordinates.squared_norm(forces, b)) >= least) restless.push_back(b);
    }
    return restless;
}

template <class Lists> std::vector<int> union_of(const Lists& lists) {
    std::vector<int> all;
    for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

/// Judges when the iteration ends, from its norms and step lengths so far.
class StoppingTest {
public:
    StoppingTest(const OpenCloseOptions& options, const IterationGoal& goal, OpenCloseSummary& summary)
        : summary_(summary), tolerance_(options.tolerance), block_tolerance_(goal.block_tolerance),
          relaxed_share_(relaxed_share * std::min(1.0, tolerance_ / usual_tolerance)),
          max_iterations_(options.max_iterations), relaxes_(goal.aim == Aim::relaxation) {
        if (relaxes_) max_iterations_ = std::min(relaxation_iterations, max_iterations_);
    }

    /// Judges the iterate q. True if it is the last one; the summary says why.
    [[nodiscard]] bool ends(const Equations& equations, const Eigen::VectorXd& q, const Iterate& at) {
        summary_.force_scale = at.residual.force_scale;
        summary_.residual_ratio = summary_.force_scale > 0.0 ? at.norm / summary_.force_scale : 0.0;
        unbalanced_ = {};
        if (is_equilibrium(at)) {
            unbalanced_ = unbalanced_blocks(equations, q, at.free_forces, block_tolerance_);
            if (unbalanced_.blocks.empty()) return ends_with(Termination::converged);
        }
        summary_.worst_block = unbalanced_.blocks.empty()
                                   ? largest_block(equations.evaluator.coordinates(), at.free_forces)
                                   : unbalanced_.blocks.front();
        if (is_relaxed(equations.problem, q, at)) return ends_with(Termination::relaxed);
        if (summary_.iterations < max_iterations_ && short_steps_ < max_short_steps) return false;
        summary_.restless = union_of(restless_);
        return ends_with(Termination::max_iterations);
    }

    /// What a linear solve may leave where only single blocks are not balanced (N/m).
    [[nodiscard]] double largest_residual() const { return block_linear_share * unbalanced_.least_allowed; }

    /// True where root finding has had its chance and the norm does not fall.
    [[nodiscard]] bool stalls(const Iterate& at) const {
        return summary_.iterations > iterations_before_halving && at.norm >= previous_norm_;
    }

    /// Notes the step of length s from an iterate, and the blocks that were restless on it.
    void note_step(const Iterate& from, double s, std::vector<int> restless) {
        restless.insert(restless.end(), unbalanced_.blocks.begin(), unbalanced_.blocks.end());
        restless_[static_cast<std::size_t>(summary_.iterations) % restless_.size()] = std::move(restless);
        short_steps_ = s < short_step ? short_steps_ + 1 : 0;
        previous_norm_ = from.norm;
    }

private:
    bool ends_with(Termination termination) {
        summary_.termination = termination;
        return true;
    }
    [[nodiscard]] bool is_equilibrium(const Iterate& at) const {
        return at.held && at.norm <= tolerance_ * at.residual.force_scale + at.residual.roundoff;
    }
    [[nodiscard]] bool is_relaxed(const EquilibriumProblem& problem, const Eigen::VectorXd& q,
                                  const Iterate& at) const {
        return relaxes_ && at.held && summary_.iterations > 0 &&
               at.norm <= relaxed_share_ * viscous_force(problem, q).norm;
    }

    OpenCloseSummary& summary_;
    double tolerance_;
    double block_tolerance_;
    double relaxed_share_; ///< of the mass-like forces
    int max_iterations_;
    bool relaxes_;
    double previous_norm_ = -1.0;                ///< of the free forces one iteration ago (N/m)
    int short_steps_ = 0;                        ///< in succession
    UnbalancedBlocks unbalanced_;                ///< where the body as a whole meets the tolerance
    std::array<std::vector<int>, 4> restless_{}; ///< blocks, of each of the last iterations
};

} // namespace

OpenCloseSummary OpenCloseSolver::solve(const EquilibriumProblem& problem, const BlockPattern& pattern,
                                        Eigen::VectorXd& q, const IterationGoal& goal) {
    Equations equations(problem, pattern);
    const Coordinates& coordinates = equations.evaluator.coordinates();
    Search search(equations, residual_seconds_);
    OpenCloseSummary summary;
    StoppingTest stopping(options_, goal, summary);
    Iterate at;
    for (;;) {
        evaluate(equations, q, residual_seconds_, at);
        if (stopping.ends(equations, q, at)) return summary;
        const bool first = summary.iterations == 0;
        const bool touching =
            first && goal.unloaded && !problem.body.placement->contacts.empty(); // a bonded body has its stiffness
        const NewtonPoint point{equations.evaluator, equations.border,           q, at.residual, at.prescribed,
                                options_.tolerance,  stopping.largest_residual()};
        if (!newton_.find(point, touching ? TangentKind::touching : options_.tangent)) {
            summary.termination = Termination::singular;
            return summary;
        }
        ++summary.iterations;
        const Eigen::VectorXd& increment = newton_.increment();
        const double s = at.held ? search.step_length(q, increment, at, stopping.stalls(at)) : 1.0;
        stopping.note_step(at, s, restless_blocks(coordinates, search.full_step_forces(), newton_.limited()));
        coordinates.move(q, increment, s, q);
    }
}

} // namespace kluft

#include "kluft/equilibrium/open_close_solver.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "damped_iteration.hpp"
#include "elimination.hpp"
#include "iterate.hpp"
#include "kluft/equilibrium/finite_check.hpp"
#include "kluft/equilibrium/line_search.hpp"
#include "stopping_test.hpp"

namespace kluft {

namespace {

constexpr double worthwhile_part =
    0.03; ///< of the blocks: where so few carry most of the forces, they are cheaper than all (measured)

constexpr int patience_from_rest =
    24;                     ///< of the damped iteration, linear solves: walls under their weight take so many
constexpr int patience = 6; ///< where loads are not given: what stops is more often the end of a path

constexpr double near_equilibrium = 1e-3; ///< forces over F_ref: less is left over by contacts that chatter

bool is_finite(const Iterate& at) {
    return std::isfinite(at.norm) && std::isfinite(at.residual.force_scale) && std::isfinite(at.residual.roundoff);
}

/// Such a solve comes to nothing, whatever is left over.
OpenCloseSummary ended_by(NumberFlaw flaw, OpenCloseSummary summary) {
    summary.termination = Termination::not_finite;
    summary.residual_ratio = std::numeric_limits<double>::infinity();
    summary.worst_block = flaw.block;
    summary.flaw = std::move(flaw.what);
    return summary;
}

/// Searches along one increment after the other.
class Search {
public:
    Search(Equations& equations, double& seconds) : equations_(equations), seconds_(seconds) {}

    /// Finds the step length from q, where the free forces are those of the iterate: a root of the work along the
    /// increment; where that does not fall at first, or where root finding `stalls`, one with a smaller norm.
    [[nodiscard]] double step_length(const Eigen::VectorXd& q, const Eigen::VectorXd& increment, const Iterate& from,
                                     bool stalls) {
        const auto slope_at = [&](double s) { return evaluate_at(q, increment, s).free_forces.dot(increment); }; // (29)
        const auto norm_at = [&](double s) { return evaluate_at(q, increment, s).norm; };
        const double slope_at_zero = from.free_forces.dot(increment);
        if (slope_at_zero < 0.0 && !stalls) return step_to_root(slope_at_zero, slope_at);
        return step_by_halving(from.norm, norm_at);
    }

    /// Moves q along the increment, and evaluates it there, unless that was done last.
    void move(const Eigen::VectorXd& increment, double s, Iterate& at, Eigen::VectorXd& q) {
        if (s != last_) static_cast<void>(evaluate_at(q, increment, s));
        q.swap(position_);
        std::swap(at, trial_);
        last_ = not_evaluated;
    }

private:
    static constexpr double not_evaluated = -1.0;

    const Iterate& evaluate_at(const Eigen::VectorXd& q, const Eigen::VectorXd& increment, double s) {
        equations_.evaluator.coordinates().move(q, increment, s, position_);
        evaluate(equations_, position_, seconds_, trial_);
        last_ = s;
        return trial_;
    }

    Equations& equations_;
    double& seconds_;
    double last_ = not_evaluated; ///< step length
    Eigen::VectorXd position_;
    Iterate trial_; ///< there
};

/// The iterate with the smallest forces so far, of those where the prescribed displacements hold.
struct LeastForces {
    Eigen::VectorXd q;
    double norm = std::numeric_limits<double>::infinity();

    void note(const Eigen::VectorXd& at_q, const Iterate& at) {
        if (!at.held || at.norm >= norm) return;
        q = at_q;
        norm = at.norm;
    }
};

} // namespace

OpenCloseSummary OpenCloseSolver::solve(const EquilibriumProblem& problem, const BlockPattern& pattern,
                                        Eigen::VectorXd& q, const IterationGoal& goal) {
    Equations equations(problem, pattern);
    const Coordinates& coordinates = equations.evaluator.coordinates();
    Search search(equations, seconds_.residual);
    Elimination elimination(equations, seconds_);
    OpenCloseSummary summary;
    StoppingTest stopping(options_, goal, summary);
    const bool may_be_damped = goal.aim == Aim::equilibrium && !coordinates.are_rigid();
    Iterate at;
    LeastForces least;
    evaluate(equations, q, seconds_.residual, at);
    for (;;) {
        if (!is_finite(at)) return ended_by(flaw_of_forces(problem, q, at.residual.forces), std::move(summary));
        if (elimination.improve(stopping.negligible_forces(problem, q, at), worthwhile_part, at, q))
            stopping.note_elimination();
        if (may_be_damped) least.note(q, at);
        if (stopping.finds(equations, q, at) || elimination.balances(stopping, worthwhile_part, at, q) ||
            stopping.ends(problem, q, at))
            return summary;
        const bool first = summary.iterations == 0;
        const bool touching =
            first && goal.unloaded && !problem.body.placement->contacts.empty(); // a bonded body has its stiffness
        const NewtonPoint point{equations.evaluator,  equations.border,           q, at.residual, at.prescribed,
                                stopping.tolerance(), stopping.largest_residual()};
        if (!newton_.find(point, touching ? TangentKind::touching : options_.tangent)) {
            summary.termination = Termination::singular;
            return summary;
        }
        ++summary.iterations;
        const bool is_too_far = goal.aim == Aim::relaxation && !at.held && !newton_.limited().empty();
        if (is_too_far) { // loads move blocks beyond the limit (28a) in this pseudo-time step
            summary.termination = Termination::max_iterations;
            return summary;
        }
        const Eigen::VectorXd& increment = newton_.increment();
        if (!increment.allFinite()) return ended_by(flaw_of_increment(problem, increment), std::move(summary));
        const double s = at.held ? search.step_length(q, increment, at, stopping.stalls(at)) : 1.0;
        stopping.note_step(at, s);
        const bool is_near = goal.given_loads || least.norm < near_equilibrium * at.residual.force_scale;
        if (may_be_damped && is_near && at.held && s < short_step) {
            q = std::move(least.q);
            DampedIteration damped(equations, elimination, newton_, options_, seconds_.residual);
            const int patient = goal.given_loads ? patience_from_rest : patience;
            if (!damped.find(stopping, patient, summary.iterations, q))
                summary.termination = Termination::max_iterations;
            return summary;
        }
        search.move(increment, s, at, q);
    }
}

} // namespace kluft

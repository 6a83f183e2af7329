#include "kluft/equilibrium/open_close_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kluft/core/stopwatch.hpp"

namespace kluft {

namespace {

constexpr int iterations_before_halving = 8; ///< then the norm must fall, or it is searched on
constexpr int max_search_residuals = 8;
constexpr double accepted_end_slope = 0.3; ///< of |g(0)|: the full step is taken
constexpr double accepted_root_slope = 0.1;
constexpr double short_step = 0.1;                    ///< of the increment: this way leads nowhere
constexpr int max_short_steps = 3;                    ///< in succession
constexpr double restless_share = 0.2;                ///< of the norm of the residual
constexpr int max_refinements = 60;                   ///< Krylov vectors of one linear solve
constexpr int refinements_worth_a_factorization = 15; ///< measured at 600, 5 000 and 50 000 blocks: 15, 18, 19
constexpr double linear_share = 0.3;                  ///< of the tolerated residual, that a linear solve may leave
constexpr double far_linear_residual = 0.05;          ///< of its right side: as many iterations as with less (measured)
constexpr double largest_linear_residual = 0.1;       ///< of its right side, near equilibrium
constexpr double travel_residual = 1e-8;              ///< of the column of a platen's travel
constexpr int relaxation_iterations = 6;              ///< of one step: what takes more needs more mass (measured)
constexpr double relaxed_share = 0.2;                 ///< of the mass-like forces, that a step of relaxation may leave

double typical_diagonal(const BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    return matrix.trace() / (pattern.block_unknowns() * pattern.n_blocks());
}

/// The square of the norm of a block's part of a vector with `nu` unknowns per block.
double squared_norm(const Eigen::VectorXd& v, int nu, int b) {
    if (nu == n_rigid_unknowns) return v.segment<n_rigid_unknowns>(n_rigid_unknowns * b).squaredNorm();
    return v.segment<n_block_unknowns>(n_block_unknowns * b).squaredNorm();
}

int largest_block(const Eigen::VectorXd& forces, int nu) {
    int worst = 0;
    double largest = -1.0;
    for (int b = 0; b < forces.size() / nu; ++b) {
        const double size = squared_norm(forces, nu, b);
        if (size > largest) {
            largest = size;
            worst = b;
        }
    }
    return worst;
}

/// The blocks that have a large part of the forces, or that limited the increment.
std::vector<int> restless_blocks(const Eigen::VectorXd& forces, int nu, const std::vector<int>& limited) {
    std::vector<int> restless = limited;
    const double least = restless_share * forces.norm();
    for (int b = 0; b < forces.size() / nu; ++b) {
        if (std::sqrt(squared_norm(forces, nu, b)) >= least) restless.push_back(b);
    }
    return restless;
}

/// Of prescribed displacements. The gradient of a rigid block, h (R - I), has the round-off of its size.
double prescribed_roundoff(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    const double of_size = problem.body.kinematics == Kinematics::rigid ? 1e-13 * problem.body.system->spacing : 0.0;
    return of_size + 1e-13 * q.lpNorm<Eigen::Infinity>();
}

template <class Lists> std::vector<int> union_of(const Lists& lists) {
    std::vector<int> all;
    for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

} // namespace

/// Removes the reactions; what remains has the work of the forces in every free motion, the platen's travel included.
void OpenCloseSolver::keep_free_part(const EquilibriumProblem& problem, const Eigen::VectorXd& q,
                                     Eigen::VectorXd& forces) const {
    const bool travels = problem.body.loads->platen_force.has_value();
    const double missing = travels ? travel_.dot(forces) - problem.body.loads->platen_force->at(q) : 0.0;
    problem.body.loads->constraints.project(forces);
    if (travels) forces += missing / travel_.squaredNorm() * travel_;
}

double OpenCloseSolver::slope_at(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                 const Eigen::VectorXd& q, double s) {
    move_to(problem, q, s);
    evaluate(evaluator, position_, trial_);
    keep_free_part(problem, position_, trial_.forces);
    return trial_.forces.dot(increment_);
}

/// Root of g(s) = R(q + s dq).dq on (0, 1] by the Illinois variant of regula falsi.
double OpenCloseSolver::step_along_root(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                        const Eigen::VectorXd& q, double slope_at_zero) {
    const double scale = std::abs(slope_at_zero);
    double high = 1.0;
    double g_high = slope_at(problem, evaluator, q, high);
    full_step_forces_ = trial_.forces;
    if (g_high <= accepted_end_slope * scale) return high;
    double low = 0.0;
    double g_low = slope_at_zero;
    double s = high;
    for (int i = 0; i < max_search_residuals; ++i) {
        s = std::clamp(high - g_high * (high - low) / (g_high - g_low), low + 0.05 * (high - low),
                       high - 0.05 * (high - low));
        const double g = slope_at(problem, evaluator, q, s);
        if (std::abs(g) < accepted_root_slope * scale) break;
        if (g > 0.0) {
            high = s;
            g_high = g;
            g_low *= 0.5;
        } else {
            low = s;
            g_low = g;
            g_high *= 0.5;
        }
    }
    return s;
}

double OpenCloseSolver::step_by_halving(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                        const Eigen::VectorXd& q, double norm_at_zero) {
    double best = 1.0;
    double best_norm = -1.0;
    double s = 1.0;
    for (int i = 0; i < max_search_residuals; ++i, s *= 0.5) {
        move_to(problem, q, s);
        evaluate(evaluator, position_, trial_);
        keep_free_part(problem, position_, trial_.forces);
        const double norm = trial_.forces.norm();
        if (i == 0) full_step_forces_ = trial_.forces;
        if (best_norm < 0.0 || norm < best_norm) {
            best = s;
            best_norm = norm;
        }
        if (norm < (1.0 - 1e-4 * s) * norm_at_zero) break;
    }
    return best;
}

/// One factor for all blocks: the increment stays Newton's direction.
void OpenCloseSolver::limit_increment(const BlockSystem& system) {
    limited_.clear();
    const double limit = options_.motion_limit * system.spacing;
    double largest = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b) {
        double motion = 0.0;
        if (nu_ == n_rigid_unknowns) {
            const auto block = increment_.segment<n_rigid_unknowns>(n_rigid_unknowns * b);
            motion = std::max(block.head<2>().norm(), std::sqrt(2.0) * std::abs(block[2]));
        } else {
            const auto block = increment_.segment<n_block_unknowns>(n_block_unknowns * b);
            motion = std::max(block.head<2>().norm(), block.tail<4>().norm());
        }
        if (motion > limit) limited_.push_back(b);
        largest = std::max(largest, motion);
    }
    if (largest > limit) increment_ *= limit / largest;
}

/// position_ := q moved by s times the increment.
void OpenCloseSolver::move_to(const EquilibriumProblem& problem, const Eigen::VectorXd& q, double s) {
    if (nu_ != n_rigid_unknowns) {
        position_ = q + s * increment_;
        return;
    }
    position_ = q;
    move_rigid(*problem.body.system, increment_, s, position_);
}

/// The forces on the unknowns.
void OpenCloseSolver::evaluate(EquilibriumEvaluator& evaluator, const Eigen::VectorXd& q, Residual& residual) {
    const Stopwatch watch(assembly_seconds_);
    if (nu_ != n_rigid_unknowns) return evaluator.residual(q, residual);
    evaluator.residual(q, of_six_numbers_);
    evaluator.reduce_to_unknowns(of_six_numbers_.forces, residual.forces);
    residual.force_scale = of_six_numbers_.force_scale;
    residual.roundoff = of_six_numbers_.roundoff;
}

/// The tangent at q, with the prescribed motions taken out.
void OpenCloseSolver::assemble(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                               const Eigen::VectorXd& q, TangentKind kind) {
    const Stopwatch watch(assembly_seconds_);
    evaluator.tangent(q, kind, matrix_);
    if (problem.body.loads->platen_force) {
        matrix_.multiply(travel_, travel_column_);
        matrix_.multiply_transposed(travel_, travel_row_);
        if (nu_ == n_rigid_unknowns) {
            evaluator.reduce_to_unknowns(problem.body.loads->platen_force->widening, scratch_);
            travel_row_ -= problem.body.loads->platen_force->stress * scratch_;
        } else {
            travel_row_ -= problem.body.loads->platen_force->stress * problem.body.loads->platen_force->widening;
        }
        travel_column_ *= -1.0;
        problem.body.loads->constraints.project(travel_column_);
    }
    right_side_ = -residual_.forces;
    if (!prescribed_.isZero(0.0)) {
        matrix_.multiply(prescribed_, scratch_);
        right_side_ -= scratch_;
    }
    problem.body.loads->constraints.project(right_side_);
    project(problem.body.loads->constraints, matrix_, typical_diagonal(matrix_));
}

/// increment_ and response_ by a factorization of the assembled matrix.
bool OpenCloseSolver::solve_anew(const EquilibriumProblem& problem, TangentKind kind) {
    reference_.forget();
    const bool exact = kind == TangentKind::exact;
    if (!linear_solver_.factorize(std::move(matrix_), exact ? Factorization::lu : Factorization::cholesky))
        return false;
    linear_solver_.solve(right_side_, increment_);
    if (problem.body.loads->platen_force) linear_solver_.solve(travel_column_, response_);
    return true;
}

/// The same by the factor in use with its changes, by a new one of the symmetric tangent, or by one of the exact
/// tangent, whichever is the first that works.
bool OpenCloseSolver::solve_with_reuse(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                       const Eigen::VectorXd& q) {
    if (update_factor(problem, q)) {
        assemble(problem, evaluator, q, options_.tangent);
        if (solve_refined(problem)) return true;
    }
    if (renew_factor(problem, evaluator, q)) {
        assemble(problem, evaluator, q, options_.tangent);
        if (solve_refined(problem)) return true;
    } else {
        assemble(problem, evaluator, q, options_.tangent);
    }
    return solve_anew(problem, options_.tangent);
}

/// False if there is no factor worth keeping.
bool OpenCloseSolver::update_factor(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    if (!reference_.taken() || analysis_of_factor_ != linear_solver_.statistics().analyses ||
        excess_refinements_ > refinements_worth_a_factorization) {
        return false;
    }
    return linear_solver_.update(reference_.changes(problem, q));
}

bool OpenCloseSolver::renew_factor(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                   const Eigen::VectorXd& q) {
    {
        const Stopwatch watch(assembly_seconds_);
        evaluator.tangent(q, TangentKind::symmetric, matrix_);
        project(problem.body.loads->constraints, matrix_, typical_diagonal(matrix_));
    }
    reference_.take(problem, q, matrix_);
    if (!linear_solver_.factorize(std::move(matrix_), Factorization::rounded_cholesky)) {
        reference_.forget();
        return false;
    }
    analysis_of_factor_ = linear_solver_.statistics().analyses;
    fresh_refinements_ = -1;
    excess_refinements_ = 0;
    return true;
}

/// Far from equilibrium a linear solve need not be exact, near it it leaves less than what the iteration tolerates.
bool OpenCloseSolver::solve_refined(const EquilibriumProblem& problem) {
    const double norm = right_side_.norm();
    SolveGoal goal;
    goal.residual =
        std::min(largest_linear_residual * norm,
                 std::max(far_linear_residual * norm, linear_share * options_.tolerance * residual_.force_scale));
    const SolveReport report = linear_solver_.solve(matrix_, right_side_, goal, max_refinements, increment_);
    if (fresh_refinements_ < 0) fresh_refinements_ = report.refinements;
    excess_refinements_ += std::max(0, report.refinements - fresh_refinements_);
    if (!report.accepted || !problem.body.loads->platen_force) return report.accepted;
    goal.residual = travel_residual * travel_column_.norm();
    return linear_solver_.solve(matrix_, travel_column_, goal, max_refinements, response_).accepted;
}

/// The increment for the platen's travel as a bordered system, by a second solution with the same factor:
/// travel_row . increment = out_of_balance.
void OpenCloseSolver::add_travel(const EquilibriumProblem& problem, double out_of_balance) {
    problem.body.loads->constraints.project(response_);
    response_ += travel_;
    increment_ += (out_of_balance - travel_row_.dot(increment_)) / travel_row_.dot(response_) * response_;
}

/// Newton's increment at q, inside the limits. False if the stiffness cannot be factorized.
bool OpenCloseSolver::find_increment(const EquilibriumProblem& problem, EquilibriumEvaluator& evaluator,
                                     const Eigen::VectorXd& q, TangentKind kind) {
    if (options_.reuse && kind != TangentKind::touching) {
        if (!solve_with_reuse(problem, evaluator, q)) return false;
    } else {
        assemble(problem, evaluator, q, kind);
        if (!solve_anew(problem, kind)) return false;
    }
    problem.body.loads->constraints.project(increment_);
    if (problem.body.loads->platen_force) {
        add_travel(problem, problem.body.loads->platen_force->at(q) - travel_.dot(residual_.forces) -
                                travel_row_.dot(prescribed_));
    }
    increment_ += prescribed_;
    limit_increment(*problem.body.system);
    return true;
}

OpenCloseSummary OpenCloseSolver::solve(const EquilibriumProblem& problem, const BlockPattern& pattern,
                                        Eigen::VectorXd& q, bool unloaded, Aim aim) {
    const bool relaxes = aim == Aim::relaxation;
    const int max_iterations =
        relaxes ? std::min(relaxation_iterations, options_.max_iterations) : options_.max_iterations;
    EquilibriumEvaluator evaluator(problem, pattern);
    nu_ = unknowns_per_block(problem.body.kinematics);
    OpenCloseSummary summary;
    full_step_forces_.resize(0);
    for (auto& blocks : restless_) blocks.clear();
    int short_steps = 0; // in succession
    double previous_norm = -1.0;
    if (problem.body.loads->platen_force)
        travel_ = problem.body.loads->constraints.travel_motion(nu_ * problem.body.system->n_blocks());
    Eigen::VectorXd free_forces;
    for (;;) {
        evaluate(evaluator, q, residual_);
        problem.body.loads->constraints.correction(q, prescribed_);
        free_forces = residual_.forces;
        keep_free_part(problem, q, free_forces);
        const double norm = free_forces.norm();
        summary.force_scale = residual_.force_scale;
        summary.residual_ratio = residual_.force_scale > 0.0 ? norm / residual_.force_scale : 0.0;
        const double missing = prescribed_.lpNorm<Eigen::Infinity>();
        const bool held = missing <= prescribed_roundoff(problem, q);
        if (held && norm <= options_.tolerance * residual_.force_scale + residual_.roundoff) {
            summary.termination = Termination::converged;
            return summary;
        }
        summary.worst_block = largest_block(free_forces, nu_);
        if (relaxes && held && summary.iterations > 0 && norm <= relaxed_share * viscous_force(problem, q)) {
            summary.termination = Termination::relaxed;
            return summary;
        }
        if (summary.iterations >= max_iterations || short_steps >= max_short_steps) {
            summary.restless = union_of(restless_);
            return summary;
        }
        const bool first = summary.iterations == 0;
        if (held) prescribed_.setZero();
        const bool touching =
            first && unloaded && !problem.body.placement->contacts.empty(); // a bonded body has its stiffness
        if (!find_increment(problem, evaluator, q, touching ? TangentKind::touching : options_.tangent)) {
            summary.termination = Termination::singular;
            return summary;
        }
        ++summary.iterations;

        double s = 1.0;
        if (held) {
            const double slope = free_forces.dot(increment_);
            const bool stalls = summary.iterations > iterations_before_halving && norm >= previous_norm;
            s = slope < 0.0 && !stalls ? step_along_root(problem, evaluator, q, slope)
                                       : step_by_halving(problem, evaluator, q, norm);
        }
        restless_[summary.iterations % restless_.size()] = restless_blocks(full_step_forces_, nu_, limited_);
        short_steps = s < short_step ? short_steps + 1 : 0;
        if (nu_ == n_rigid_unknowns) {
            move_rigid(*problem.body.system, increment_, s, q);
        } else {
            q += s * increment_;
        }
        previous_norm = norm;
    }
}

} // namespace kluft

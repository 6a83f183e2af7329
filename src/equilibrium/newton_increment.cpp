#include "kluft/equilibrium/newton_increment.hpp"

#include <algorithm>
#include <utility>

#include "kluft/core/stopwatch.hpp"
#include "kluft/equilibrium/boundary_terms.hpp"
#include "kluft/equilibrium/motion_limit.hpp"

namespace kluft {

namespace {

constexpr double linear_share = 0.3;           ///< of the tolerated residual, that a linear solve may leave
constexpr double usual_linear_residual = 0.05; ///< of its right side: as many iterations as with less (measured)
constexpr double far_linear_residual = 0.02;   ///< of its right side, far from equilibrium: what touches is found there
constexpr double far_from_equilibrium = 0.01;  ///< right side over F_ref
constexpr double largest_linear_residual = 0.1; ///< of its right side, near equilibrium
constexpr double least_mass_share = 0.01;       ///< of the tangent's trace (measured: 0.003 to 0.03)
constexpr int most_vectors_without_factor = 30; ///< of a solution, which takes 9 to 20
constexpr double travel_residual = 1e-8;        ///< of the border's column

/// Adds lambda M to the tangent (29c).
void add_damping(const EquilibriumProblem& problem, double damping, BlockMatrix& matrix) {
    if (damping == 0.0) return;
    const std::vector<Block>& blocks = problem.body.system->blocks;
    for (int b = 0; b < matrix.pattern->n_blocks(); ++b)
        matrix.values[matrix.pattern->diagonal(b)] += damping * mass_matrix(blocks[b], problem.least_mass_area);
}

/// Trace of the mass-like term (Pa).
double mass_of(const EquilibriumProblem& problem, double damping) {
    if (problem.eta.empty() && damping == 0.0) return 0.0;
    const std::vector<Block>& blocks = problem.body.system->blocks;
    double sum = 0.0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const double eta = damping + (problem.eta.empty() ? 0.0 : problem.eta[b]);
        sum += eta * mass_matrix(blocks[b], problem.least_mass_area).trace();
    }
    return sum;
}

/// Whether a point slides under a limit that follows its pressure.
bool has_friction_in_tangent(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    for (int i = 0; i < static_cast<int>(problem.body.placement->contacts.size()); ++i) {
        const PointTraction traction = contact_traction(problem.body, i, q);
        if (traction.state == ContactState::sliding && traction.tangent(0, 1) != traction.tangent(1, 0)) return true;
    }
    return false;
}

/// The second bound of (31): far from equilibrium a linear solve need not be exact, near it it leaves less than what
/// the iteration tolerates, and where no contact can change its state it does so at once. `right_side`: its norm (N/m).
double linear_residual(const NewtonPoint& at, double right_side) {
    const double tolerated = linear_share * at.tolerance * at.residual.force_scale;
    const bool is_far = right_side > far_from_equilibrium * at.residual.force_scale;
    const bool is_bonded = at.evaluator.problem().body.placement->contacts.empty();
    const double share = is_bonded ? 0.0 : (is_far ? far_linear_residual : usual_linear_residual);
    return std::min(
        {at.largest_residual, largest_linear_residual * right_side, std::max(share * right_side, tolerated)});
}

} // namespace

void make_free(const Constraints& constraints, BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    project(constraints, matrix, matrix.trace() / (pattern.block_unknowns() * pattern.n_blocks()));
}

/// Sets up the right side and the tangent at q with the prescribed motions taken out, and the border if there is one.
void NewtonIncrement::assemble(const NewtonPoint& at, TangentKind kind) {
    const Stopwatch watch(assembly_seconds_);
    const EquilibriumProblem& problem = at.evaluator.problem();
    at.evaluator.tangent(at.q, kind, matrix_);
    add_damping(problem, at.damping, matrix_);
    if (at.border.exists()) set_platen_equation(problem, at.evaluator.coordinates(), matrix_, at.border);
    right_side_ = -at.residual.forces;
    if (!at.prescribed.isZero(0.0)) {
        matrix_.multiply(at.prescribed, scratch_);
        right_side_ -= scratch_;
    }
    problem.body.loads->constraints.project(right_side_);
    make_free(problem.body.loads->constraints, matrix_);
}

void NewtonIncrement::assemble_symmetric(const NewtonPoint& at) {
    const Stopwatch watch(assembly_seconds_);
    at.evaluator.tangent(at.q, TangentKind::symmetric, matrix_);
    add_damping(at.evaluator.problem(), at.damping, matrix_);
    make_free(at.evaluator.problem().body.loads->constraints, matrix_);
}

/// Solves for increment and response by a factorization of the assembled matrix.
bool NewtonIncrement::solve_anew(const NewtonPoint& at, TangentKind kind) {
    factor_.forget();
    const bool exact = kind == TangentKind::exact;
    if (!linear_solver_.factorize(std::move(matrix_), exact ? Factorization::lu : Factorization::cholesky))
        return false;
    linear_solver_.solve(right_side_, increment_);
    if (at.border.exists()) linear_solver_.solve(at.border.column, response_);
    return true;
}

/// Solves without a factor, by the factor in use with its changes, by a new one, of the tangent itself where points slide and else of the
/// symmetric one, or by one with pivoting, whichever is the first that works.
bool NewtonIncrement::solve_with_reuse(const NewtonPoint& at, TangentKind kind) {
    const EquilibriumProblem& problem = at.evaluator.problem();
    assemble(at, kind);
    if (solve_without_factor(at)) return true;
    if (factor_.is_left_out()) return solve_anew(at, kind);
    if (factor_.update(problem, at.q) && solve_refined(at)) return true;
    if (kind == TangentKind::exact && factor_.friction_is_costly() && has_friction_in_tangent(problem, at.q) &&
        factor_.renew_exact(problem, at.q, matrix_) && solve_refined(at))
        return true;
    assemble_symmetric(at);
    const bool renewed = factor_.renew(problem, at.q, std::move(matrix_));
    assemble(at, kind);
    if (renewed && solve_refined(at)) return true;
    factor_.note_failure();
    return solve_anew(at, kind);
}

/// Where much of the tangent is the mass-like term: in short steps of a motion, whose eta changes from one to the next.
bool NewtonIncrement::solve_without_factor(const NewtonPoint& at) {
    const EquilibriumProblem& problem = at.evaluator.problem();
    if (at.border.exists() || problem.body.kinematics == Kinematics::rigid) return false;
    if (mass_of(problem, at.damping) < least_mass_share * matrix_.trace()) return false;
    const SolveGoal goal{.residual = linear_residual(at, right_side_.norm())}; // (31)
    return linear_solver_.solve_by_blocks(matrix_, right_side_, goal, most_vectors_without_factor, increment_).accepted;
}

bool NewtonIncrement::solve_refined(const NewtonPoint& at) {
    const double residual = linear_residual(at, right_side_.norm());
    const SolveReport report = factor_.solve(matrix_, right_side_, residual, increment_);
    factor_.count(report.refinements);
    if (!report.accepted || !at.border.exists()) return report.accepted;
    const Eigen::VectorXd& column = at.border.column;
    return factor_.solve(matrix_, column, travel_residual * column.norm(), response_).accepted;
}

/// Scales the increment by one factor for all blocks: it stays Newton's direction.
void NewtonIncrement::limit_motions(const NewtonPoint& at) {
    limited_.clear();
    const std::vector<double> over = motions_over_limit(at.evaluator.problem(), at.evaluator.coordinates(), at.q,
                                                        increment_, options_.motion_limit); // (28a)
    for (int b = 0; b < static_cast<int>(over.size()); ++b)
        if (over[b] > 1.0) limited_.push_back(b);
    if (!limited_.empty()) increment_ /= *std::ranges::max_element(over);
}

bool NewtonIncrement::find(const NewtonPoint& at, TangentKind kind) {
    const EquilibriumProblem& problem = at.evaluator.problem();
    if (options_.reuse && kind != TangentKind::touching) {
        if (!solve_with_reuse(at, kind)) return false;
    } else {
        assemble(at, kind);
        if (!solve_anew(at, kind)) return false;
    }
    problem.body.loads->constraints.project(increment_);
    if (at.border.exists()) {
        problem.body.loads->constraints.project(response_);
        const double imbalance = platen_imbalance(problem, at.border, at.q, at.residual.forces);
        at.border.add_to(imbalance - at.border.row.dot(at.prescribed), response_, increment_);
    }
    increment_ += at.prescribed;
    limit_motions(at);
    return true;
}

} // namespace kluft

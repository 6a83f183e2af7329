#include "kluft/assembly/linear_solver.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "kluft/assembly/blas.hpp"
#include "kluft/assembly/block_columns.hpp"
#include "kluft/assembly/krylov.hpp"
#include "kluft/assembly/lu_factor.hpp"
#include "kluft/core/change_size.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double max_rank_factor = 3.0;     ///< of sqrt(unknowns); the design's figure
constexpr int usual_refinements = 15;       ///< vectors that CHOLMOD's factorization costs, at 600 blocks
constexpr int multifrontal_refinements = 8; ///< the multifrontal one: 5 at 2 000 blocks, 4 at 5 000, 9 at 50 000
constexpr int max_corrections = 3;          ///< restarts of the refinement, whose recurrence drifts
constexpr double safe_share = 0.97;         ///< of the goal, for the recurrence

double frobenius_norm(const BlockMatrix& matrix) { return std::sqrt(matrix.squared_norm()); }

} // namespace

struct LinearSolver::Backend {
    std::vector<int> position; ///< of each block in the elimination order
    int nu = n_block_unknowns; ///< unknowns per block
    SupernodalFactor supernodal;
    LuFactor lu;
    LowRankUpdate changes;
    Gmres gmres;
    std::vector<double> right_side, solution;
    Eigen::VectorXd residual, product;
    std::vector<Mat6> inverses; ///< of diagonal blocks
    Factorization kind = Factorization::cholesky;
    LinearSolverStatistics statistics;

    /// There is one factor at a time.
    void gather(const BlockMatrix& matrix, Factorization new_kind) {
        kind = new_kind;
        if (kind == Factorization::lu) {
            supernodal.forget();
            lu.gather(matrix);
        } else {
            lu.forget();
            if (supernodal.is_large()) gmres.release();
            supernodal.gather(matrix);
        }
    }

    bool factorize() {
        if (kind == Factorization::lu) return lu.factorize();
        changes.start(supernodal, position, nu);
        return supernodal.factorize(kind == Factorization::cholesky ? Precision::full : Precision::single);
    }

    /// Where single precision is enough; the matrix is read where it stands.
    bool factorize_in_single(const BlockMatrix& matrix, Factorization new_kind) {
        ++statistics.factorizations;
        if (new_kind != Factorization::rounded_cholesky && new_kind != Factorization::rounded_lu) return false;
        kind = new_kind;
        lu.forget();
        if (supernodal.is_large()) gmres.release();
        const bool is_symmetric = kind == Factorization::rounded_cholesky;
        if (!supernodal.factorize_in_single(matrix, is_symmetric ? Symmetry::symmetric : Symmetry::unsymmetric))
            return false;
        changes.start(supernodal, position, nu);
        return true;
    }

    void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
        right_side.resize(b.size());
        permute(position, nu, b, right_side.data());
        if (kind == Factorization::lu) {
            lu.solve(right_side, solution);
            unpermute(position, nu, solution.data(), x);
            return;
        }
        supernodal.solve_lower(right_side);
        changes.apply(right_side);
        supernodal.solve_upper(right_side);
        unpermute(position, nu, right_side.data(), x);
    }

    SolveReport refine(const BlockMatrix& matrix, const Gmres::Operator& precondition, const Eigen::VectorXd& b,
                       const SolveGoal& goal, int max_refinements, Eigen::VectorXd& x);
};

LinearSolver::LinearSolver() : backend_(std::make_unique<Backend>()) {}
LinearSolver::~LinearSolver() = default;

void LinearSolver::analyze(const BlockPattern& pattern) {
    prepare_blas();
    Backend& k = *backend_;
    const Stopwatch watch(k.statistics.analyze_seconds);
    k.position = elimination_order(pattern);
    k.nu = pattern.block_unknowns();
    k.supernodal.analyze(pattern, k.position);
    k.lu.analyze(pattern, k.position);
    ++k.statistics.analyses;
}

bool LinearSolver::factorize(const BlockMatrix& matrix, Factorization kind) {
    const Stopwatch watch(backend_->statistics.factorize_seconds);
    if (backend_->factorize_in_single(matrix, kind)) return true;
    if (kind == Factorization::rounded_lu) return false;
    backend_->gather(matrix, kind);
    return backend_->factorize();
}

bool LinearSolver::factorize(BlockMatrix&& matrix, Factorization kind) {
    const Stopwatch watch(backend_->statistics.factorize_seconds);
    if (backend_->factorize_in_single(matrix, kind)) {
        matrix.release();
        return true;
    }
    if (kind == Factorization::rounded_lu) return false;
    backend_->gather(matrix, kind);
    matrix.release();
    return backend_->factorize();
}

bool LinearSolver::update(const std::vector<StiffnessChange>& changes) {
    Backend& k = *backend_;
    const Stopwatch watch(k.statistics.update_seconds);
    if (k.changes.rank_with(changes) > max_rank()) return false;
    ++k.statistics.updates;
    const bool regular = k.changes.set(changes);
    k.statistics.rank = std::max(k.statistics.rank, k.changes.rank());
    return regular;
}

int LinearSolver::max_rank() const {
    const auto unknowns = static_cast<double>(backend_->nu * backend_->position.size());
    return static_cast<int>(max_rank_factor * std::sqrt(unknowns));
}

int LinearSolver::rank() const { return backend_->changes.rank(); }

void LinearSolver::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    const Stopwatch watch(backend_->statistics.solve_seconds);
    backend_->solve(b, x);
}

SolveReport LinearSolver::solve(const BlockMatrix& matrix, const Eigen::VectorXd& b, const SolveGoal& goal,
                                int max_refinements, Eigen::VectorXd& x) {
    const Stopwatch watch(backend_->statistics.solve_seconds);
    const auto precondition = [&](const Eigen::VectorXd& v, Eigen::VectorXd& y) { backend_->solve(v, y); };
    return backend_->refine(matrix, precondition, b, goal, max_refinements, x);
}

SolveReport LinearSolver::solve_by_blocks(const BlockMatrix& matrix, const Eigen::VectorXd& b, const SolveGoal& goal,
                                          int max_refinements, Eigen::VectorXd& x) {
    const Stopwatch watch(backend_->statistics.solve_seconds);
    const BlockPattern& pattern = *matrix.pattern;
    std::vector<Mat6>& inverses = backend_->inverses;
    inverses.resize(pattern.n_blocks());
    for (int row = 0; row < pattern.n_blocks(); ++row) inverses[row] = matrix.values[pattern.diagonal(row)].inverse();
    const auto precondition = [&](const Eigen::VectorXd& v, Eigen::VectorXd& y) {
        change_size(y, v.size());
        for (int row = 0; row < pattern.n_blocks(); ++row) {
            const auto rows = Eigen::seqN(n_block_unknowns * row, Eigen::fix<n_block_unknowns>);
            y(rows).noalias() = inverses[row] * v(rows);
        }
    };
    return backend_->refine(matrix, precondition, b, goal, max_refinements, x);
}

SolveReport LinearSolver::Backend::refine(const BlockMatrix& matrix, const Gmres::Operator& precondition,
                                          const Eigen::VectorXd& b, const SolveGoal& goal, int max_refinements,
                                          Eigen::VectorXd& x) {
    const auto multiply = [&](const Eigen::VectorXd& v, Eigen::VectorXd& y) { matrix.multiply(v, y); };
    double matrix_norm = -1.0; // when first needed
    const auto bound = [&](double x_norm) {
        if (goal.backward_error <= 0.0) return goal.residual;
        if (matrix_norm < 0.0) matrix_norm = frobenius_norm(matrix);
        return std::max(goal.residual, goal.backward_error * (matrix_norm * x_norm + b.norm()));
    };
    SolveReport report;
    x.setZero(b.size());
    residual = b;
    for (int i = 0; i < max_corrections && !report.accepted && report.refinements < max_refinements; ++i) {
        const double x_norm = x.norm();
        report.refinements += gmres.correct(
            multiply, precondition, max_refinements - report.refinements,
            [&](double correction) { return safe_share * bound(std::max(x_norm, correction)); }, residual, x);
        multiply(x, product);
        residual = b - product;
        const double error = residual.norm();
        report.accepted = error <= goal.residual || error <= bound(x.norm());
    }
    statistics.refinements += report.refinements;
    return report;
}

int LinearSolver::refinements_worth_a_factorization() const {
    return backend_->supernodal.is_multifrontal() ? multifrontal_refinements : usual_refinements;
}

const LinearSolverStatistics& LinearSolver::statistics() const { return backend_->statistics; }

FactorCost factor_cost(const BlockPattern& pattern, Factorization kind) {
    SupernodalFactor factor;
    factor.analyze(pattern, elimination_order(pattern));
    const bool in_single = kind == Factorization::rounded_cholesky || kind == Factorization::rounded_lu;
    return factor.cost(in_single ? Precision::single : Precision::full,
                       kind == Factorization::rounded_lu ? Symmetry::unsymmetric : Symmetry::symmetric);
}

} // namespace kluft

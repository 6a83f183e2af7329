#include "factored_body.hpp"

#include <stdexcept>
#include <vector>

#include "changed_points.hpp"

namespace kluft::bench {

namespace {

constexpr double residual_share = 1e-5; ///< of the right side: what the last iterations of a load step need
constexpr int max_refinements = 100;

} // namespace

FactoredBody::FactoredBody(const Body& body)
    : body_(body), evaluator_(body.problem(), body.pattern()), load_(body.load()) {
    solver_.analyze(body.pattern());
    assemble();
    factorize();
}

void FactoredBody::assemble() {
    body_.stiffness(evaluator_, matrix_);
    matrix_is_changed_ = false;
}

void FactoredBody::assemble(std::span<const StiffnessChange> changes) {
    assemble();
    add_changes(changes, matrix_);
    matrix_is_changed_ = true;
}

void FactoredBody::factorize() {
    factor_is_changed_ = true; // should it fail
    if (!solver_.factorize(matrix_, Factorization::rounded_cholesky))
        throw std::runtime_error("the stiffness is singular");
    factor_is_changed_ = matrix_is_changed_;
}

void FactoredBody::restore() {
    if (matrix_is_changed_) assemble();
    if (factor_is_changed_) factorize();
}

bool FactoredBody::update(std::span<const StiffnessChange> changes) {
    factor_is_changed_ = true;
    return solver_.update({changes.begin(), changes.end()});
}

void FactoredBody::solve() { solver_.solve(load_, solution_); }

int FactoredBody::solve_refined() {
    const SolveGoal goal{.residual = residual_share * load_.norm(), .backward_error = 0.0};
    const SolveReport report = solver_.solve(matrix_, load_, goal, max_refinements, solution_);
    if (!report.accepted) throw std::runtime_error("the solution is not exact enough");
    return report.refinements;
}

} // namespace kluft::bench

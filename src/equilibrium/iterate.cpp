#include "iterate.hpp"

#include "kluft/core/stopwatch.hpp"

namespace kluft {

void evaluate(Equations& equations, const Eigen::VectorXd& q, double& seconds, Residual& residual) {
    const Stopwatch watch(seconds);
    equations.evaluator.reduced_residual(q, residual);
}

void evaluate(Equations& equations, const Eigen::VectorXd& q, double& seconds, Iterate& at) {
    evaluate(equations, q, seconds, at.residual);
    const double roundoff = equations.evaluator.coordinates().roundoff(q);
    equations.problem.body.loads->constraints.correction(q, at.prescribed, roundoff);
    at.free_forces = at.residual.forces;
    keep_free_part(equations.problem, equations.border, q, at.free_forces);
    at.norm = at.free_forces.norm();
    at.held = at.prescribed.lpNorm<Eigen::Infinity>() <= roundoff;
    if (at.held) at.prescribed.setZero();
}

} // namespace kluft

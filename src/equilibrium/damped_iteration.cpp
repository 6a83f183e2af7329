#include "damped_iteration.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace kluft {

namespace {

constexpr int max_solves = 100;
constexpr double largest_part = 0.1;  ///< of the blocks: more are not put right by themselves
constexpr std::size_t n_compared = 3; ///< norms: an iterate may have more than the last, but not than all of them
constexpr double damped_linear_residual =
    1e-2; ///< of the forces, that a linear solve may leave (measured: 1e-4 is no better)
constexpr double least_damped_fall = 1e-3; ///< of the norm
constexpr double large_damped_fall = 0.3;  ///< of the norm
constexpr double first_damping = 1e-2;     ///< E/d2 of it (measured: 1e-3 to 1e-1)
constexpr double largest_damping = 1e3;    ///< the same: an increment is nothing then
constexpr double damping_decay = 0.2;      ///< of the damping, where the norm falls; twice where it falls much
constexpr double damping_growth = 6.0;     ///< where it does not

/// The stiffness of the stiffest material over the square of the spacing (Pa/m2).
double stiffness_per_mass(const LoadedBody& body) {
    double modulus = 0.0;
    for (const ElasticModuli& moduli : *body.moduli) modulus = std::max(modulus, 2.0 * moduli.mu + moduli.lambda);
    return modulus / (body.system->spacing * body.system->spacing);
}

} // namespace

bool DampedIteration::find(StoppingTest& stopping, int patience, int& n_solves, Eigen::VectorXd& q) {
    const double scale = stiffness_per_mass(equations_.problem.body);
    Iterate at;
    evaluate(equations_, q, seconds_, at);
    elimination_.improve(stopping.negligible_forces(equations_.problem, q, at), largest_part, at, q);
    std::array<double, n_compared> norms{};
    norms.fill(at.norm);
    std::size_t n_taken = 0;
    double damping = first_damping * scale;
    double least = at.norm;
    int least_at = 0;
    Eigen::VectorXd best = q;
    bool found = false;
    bool moved = true;
    for (int i = 0; i < max_solves && i - least_at <= patience && damping <= largest_damping * scale; ++i) {
        found = moved && (stopping.finds(equations_, q, at) || elimination_.balances(stopping, largest_part, at, q));
        if (found) break;
        newton_.forget_factor();
        const double largest_residual = std::min(stopping.largest_residual(), damped_linear_residual * at.norm);
        const NewtonPoint point{equations_.evaluator, equations_.border, q,      at.residual, at.prescribed,
                                stopping.tolerance(), largest_residual,  damping};
        if (!newton_.find(point, options_.tangent)) break;
        ++n_solves;
        Eigen::VectorXd next;
        equations_.evaluator.coordinates().move(q, newton_.increment(), 1.0, next);
        Iterate there;
        evaluate(equations_, next, seconds_, there);
        elimination_.improve(stopping.negligible_forces(equations_.problem, next, there), largest_part, there, next);
        moved = there.norm < (1.0 - least_damped_fall) * std::ranges::max(norms);
        if (!moved) {
            damping *= damping_growth;
            continue;
        }
        if (there.norm < at.norm)
            damping *= there.norm < large_damped_fall * at.norm ? damping_decay * damping_decay : damping_decay;
        norms[n_taken++ % norms.size()] = there.norm;
        if (there.norm < large_damped_fall * least) norms.fill(there.norm); // what is won stays
        q = std::move(next);
        if (there.norm < 0.5 * least) least_at = i;
        if (there.norm < least) best = q;
        least = std::min(least, there.norm);
        at = std::move(there);
    }
    newton_.forget_factor(); // it has the damping in it
    if (!found) q = std::move(best);
    return found;
}

} // namespace kluft

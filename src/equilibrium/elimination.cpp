#include "elimination.hpp"

#include <utility>

#include "kluft/core/stopwatch.hpp"

namespace kluft {

namespace {

constexpr int max_rounds_of_local = 20;
constexpr double local_share = 0.1; ///< of what is enough, on one group of blocks
constexpr double local_fall = 0.7;  ///< of the norm: what a further round must be worth

} // namespace

bool Elimination::improve(double enough, double largest_part, Iterate& at, Eigen::VectorXd& q) {
    const EquilibriumProblem& problem = equations_.problem;
    if (!at.held || problem.body.placement->contacts.empty() || equations_.evaluator.coordinates().are_rigid())
        return false;
    bool goes_on = true;
    bool moved = false;
    for (int round = 0; goes_on && round < max_rounds_of_local && at.norm > enough; ++round) {
        Eigen::VectorXd improved = q;
        {
            const Stopwatch watch(seconds_.local);
            if (!local_) local_.emplace(problem);
            if (!local_->improve(at.free_forces, largest_part, local_share * enough, improved)) return moved;
        }
        Iterate there;
        evaluate(equations_, improved, seconds_.residual, there);
        if (there.norm >= at.norm) {
            evaluate(equations_, q, seconds_.residual, at);
            return moved;
        }
        moved = true;
        goes_on = there.norm < local_fall * at.norm;
        q = std::move(improved);
        at = std::move(there);
    }
    return moved;
}

} // namespace kluft

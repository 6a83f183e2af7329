#include "elimination.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "kluft/core/stopwatch.hpp"
#include "kluft/equilibrium/motion_limit.hpp"

namespace kluft {

namespace {

constexpr int max_rounds_of_local = 20;
constexpr double local_share = 0.1; ///< of what is enough, on one group of blocks
constexpr double local_fall = 0.7;  ///< of the norm: what a further round must be worth
constexpr int rounds_of_balancing = 3;
constexpr double balancing_motion = 1e-3; ///< of neighbours, relative: a block that goes farther leaves what holds it
constexpr double share_on_blocks = 0.1;   ///< of what is allowed on the strictest of them

} // namespace

bool Elimination::improve(double enough, double largest_part, Iterate& at, Eigen::VectorXd& q) {
    if (!has_any(at)) return false;
    bool goes_on = true;
    bool moved = false;
    for (int round = 0; goes_on && round < max_rounds_of_local && at.norm > enough; ++round) {
        Eigen::VectorXd improved = q;
        {
            const Stopwatch watch(seconds_.local);
            if (!local().improve(at.free_forces, largest_part, local_share * enough, improved)) return moved;
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

bool Elimination::balances(StoppingTest& stopping, double largest_part, Iterate& at, Eigen::VectorXd& q) {
    const auto largest = static_cast<std::size_t>(
        std::max(1.0, largest_part * static_cast<double>(equations_.problem.body.system->blocks.size())));
    if (!has_any(at) || stopping.unbalanced().blocks.empty() || stopping.unbalanced().blocks.size() > largest)
        return false;
    Eigen::VectorXd improved = q;
    Iterate there;
    for (int round = 0; round < rounds_of_balancing && !stopping.unbalanced().blocks.empty(); ++round) {
        const UnbalancedBlocks unbalanced = stopping.unbalanced();
        {
            const Stopwatch watch(seconds_.local);
            local().improve(unbalanced.blocks, share_on_blocks * unbalanced.least_allowed, improved);
        }
        if (moves_far(q, improved)) break;
        evaluate(equations_, improved, seconds_.residual, there);
        if (!stopping.finds(equations_, improved, there)) continue;
        q = std::move(improved);
        at = std::move(there);
        return true;
    }
    evaluate(equations_, q, seconds_.residual, at);
    return stopping.finds(equations_, q, at);
}

bool Elimination::has_any(const Iterate& at) const {
    return at.held && !equations_.problem.body.placement->contacts.empty() &&
           !equations_.evaluator.coordinates().are_rigid();
}

bool Elimination::moves_far(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
    const std::vector<double> over =
        motions_over_limit(equations_.problem, equations_.evaluator.coordinates(), from, to - from, balancing_motion);
    return std::ranges::any_of(over, [](double motion) { return motion > 1.0; });
}

LocalIteration& Elimination::local() {
    if (!local_) local_.emplace(equations_.problem);
    return *local_;
}

} // namespace kluft

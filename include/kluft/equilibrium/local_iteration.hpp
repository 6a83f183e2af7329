// Newton's method on the few blocks that carry most of the forces that are left, while all others stay where they are
// (docs/theory.md, "Damped iteration").
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "kluft/equilibrium/part_of_body.hpp"

namespace kluft {

/// Moves blocks of one problem, which must outlive it; affine blocks only.
class LocalIteration {
public:
    explicit LocalIteration(const EquilibriumProblem& problem) : problem_(problem) {}

    /// Moves the blocks that carry most of the free forces at q, and those that they touch, so that they are left with less.
    /// What the others are left with may grow. `negligible`: forces that need not be smaller (N/m). False, and nothing is moved,
    /// where more than a `largest_part` of all blocks carries them.
    [[nodiscard]] bool improve(const Eigen::VectorXd& free_forces, double largest_part, double negligible,
                               Eigen::VectorXd& q);
    /// Moves these blocks and those that they touch in the same way.
    void improve(const std::vector<int>& blocks, double negligible, Eigen::VectorXd& q);

private:
    const EquilibriumProblem& problem_;
    std::optional<Surroundings> surroundings_; ///< found where they are needed
};

} // namespace kluft

// Newton's method on the few blocks that carry most of the forces that are left, while all others stay where they are
// (docs/theory.md, "Damped iteration").
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/equilibrium/part_of_body.hpp"

namespace kluft {

/// Moves blocks of one problem, which must outlive it; affine blocks only.
class LocalIteration {
public:
    explicit LocalIteration(const EquilibriumProblem& problem) : surroundings_(problem) {}

    /// Moves the blocks that carry most of the free forces at q, and those that they touch, so that they are left with less.
    /// What the others are left with may grow. `negligible`: forces that need not be smaller (N/m).
    void improve(const Eigen::VectorXd& free_forces, double negligible, Eigen::VectorXd& q) const;

private:
    [[nodiscard]] std::vector<int> chosen_blocks(const Eigen::VectorXd& free_forces) const;
    [[nodiscard]] std::vector<std::vector<int>> connected_groups(const std::vector<int>& blocks) const;

    Surroundings surroundings_;
};

} // namespace kluft

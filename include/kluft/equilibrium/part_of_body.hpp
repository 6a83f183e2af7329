// Some blocks of a body whose surroundings stay where they are: an equilibrium problem of its own.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// For each block the indices of the points, edges or loads that it has.
class IndicesOfBlocks {
public:
    /// `blocks_of(item)` gives the blocks of an item, a range.
    template <class Items, class BlocksOf> IndicesOfBlocks(int n_blocks, const Items& items, BlocksOf blocks_of) {
        std::vector<int> next(static_cast<std::size_t>(n_blocks) + 2, 0);
        for (const auto& item : items)
            for (const int b : blocks_of(item)) ++next[b + 2];
        for (int b = 0; b < n_blocks; ++b) next[b + 2] += next[b + 1];
        indices_.resize(next.back());
        for (int i = 0; i < static_cast<int>(items.size()); ++i)
            for (const int b : blocks_of(items[i])) indices_[next[b + 1]++] = i;
        starts_ = std::move(next);
    }
    [[nodiscard]] std::span<const int> of(int block) const {
        return std::span(indices_).subspan(starts_[block], starts_[block + 1] - starts_[block]);
    }

private:
    std::vector<int> starts_;
    std::vector<int> indices_;
};

/// What each block of a problem's body touches and bears. The problem must outlive it.
class Surroundings {
public:
    explicit Surroundings(const EquilibriumProblem& problem);

    [[nodiscard]] const EquilibriumProblem& problem() const { return problem_; }
    [[nodiscard]] const IndicesOfBlocks& contacts() const { return contacts_; }
    [[nodiscard]] const IndicesOfBlocks& bonds() const { return bonds_; }
    [[nodiscard]] const IndicesOfBlocks& pressure_edges() const { return pressure_edges_; }
    [[nodiscard]] const IndicesOfBlocks& point_loads() const { return point_loads_; }
    [[nodiscard]] const IndicesOfBlocks& friction() const { return friction_; }

    /// The blocks that share a bond or a contact point with `block`; one may come several times.
    [[nodiscard]] std::vector<int> neighbours(int block) const;

private:
    const EquilibriumProblem& problem_;
    IndicesOfBlocks contacts_, bonds_, pressure_edges_, point_loads_, friction_;
};

/// The equilibrium problem of some affine blocks: the `n_free` first of `blocks`; those behind them touch them and stay.
class PartOfBody {
public:
    /// `free`: blocks of the body; `q`: where all blocks are.
    PartOfBody(const Surroundings& surroundings, const std::vector<int>& free, const Eigen::VectorXd& q);
    PartOfBody(const PartOfBody&) = delete;
    PartOfBody& operator=(const PartOfBody&) = delete;

    [[nodiscard]] const EquilibriumProblem& problem() const { return problem_; }
    [[nodiscard]] int n_free() const { return n_free_; }
    /// Pairs of its blocks that have a bond or a contact point.
    [[nodiscard]] const std::vector<std::pair<int, int>>& pairs() const { return pairs_; }
    /// Where its blocks are, size 6 blocks.
    [[nodiscard]] const Eigen::VectorXd& start() const { return start_; }
    /// Puts the free blocks of the body where those of the part are.
    void copy_back(const Eigen::VectorXd& part, Eigen::VectorXd& q) const;

private:
    void take_interfaces(const Surroundings& surroundings);
    void take_loads(const Surroundings& surroundings);

    int n_free_;
    std::vector<int> blocks_; ///< of the body
    std::vector<std::pair<int, int>> pairs_;
    BlockSystem system_;
    Placement placement_;
    Loads loads_;
    Eigen::VectorXd start_;
    EquilibriumProblem problem_;
};

} // namespace kluft

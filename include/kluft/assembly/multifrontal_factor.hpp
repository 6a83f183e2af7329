// The factor L L' or L U of a large stiffness in single precision, by the multifrontal method (Duff and Reid 1983, Liu 1992)
// on the graph of blocks.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/block_supernodes.hpp"

namespace kluft {

enum class Symmetry {
    symmetric,  ///< and positive definite: L L'
    unsymmetric ///< L U without pivoting: what friction and following loads make of a stiffness
};

/// Positions are those of the elimination order, a postorder. The bits of the factor do not depend on the number of threads.
class MultifrontalFactor {
public:
    /// Forgets the earlier factor.
    void analyze(const BlockPattern& pattern, const std::vector<int>& position);

    /// With as many threads as the BLAS has. A pivot that rounding may have made of zero is raised to what rounding can
    /// make: so the motion of a whole body that nearly nothing holds, of which single precision leaves nothing, costs the
    /// refinement a vector. False if a matrix that should be is not positive definite, or there are more than six such
    /// pivots; there is no factor then. Throws ResourceError out of memory.
    [[nodiscard]] bool factorize(const BlockMatrix& matrix, Symmetry symmetry);

    /// Gives the memory of the factor back; the analysis stays.
    void forget() {
        values_.reset();
        upper_values_.reset();
    }

    [[nodiscard]] const BlockSupernodes& supernodes() const { return supernodes_; }
    /// Numbers of L where `supernodes().value_starts` says; nullptr if there is no factor. A few more may be read behind.
    [[nodiscard]] const float* values() const { return values_.get(); }
    /// The same of the transposed U; those of L for L L'.
    [[nodiscard]] const float* upper_values() const { return upper_values_ ? upper_values_.get() : values_.get(); }
    /// Bytes of the numbers of L L', and the most that fronts take besides while they are made, by one thread. Of L U
    /// both are twice as many.
    [[nodiscard]] double bytes() const;
    [[nodiscard]] double front_bytes() const;

private:
    struct Numbers;

    /// A branch of the tree, or above the branches a single supernode.
    struct Task {
        int first = 0; ///< supernode
        int last = 0;
    };
    /// Who eliminates what, and where the rest of each front stands until its parent takes it. In a branch, which is one
    /// task, parents and children have a stack each, so that a parent can take its room while those of the children
    /// are in use; the last front of a task leaves its rest in a room of its own.
    struct Plan {
        std::vector<Task> tasks;
        std::vector<int> task_parent;
        std::vector<int> first_child, next_child; ///< of supernodes, ascending; -1 at the end
        std::vector<double> least_ratio;          ///< of a pivot to its diagonal entry, of each supernode
        std::vector<char> stack;                  ///< of each supernode, 0 or 1
        std::vector<std::size_t> place;           ///< on it
        std::array<std::size_t, 2> stack_sizes{}; ///< largest of all branches
        std::size_t passed_on = 0;                ///< most numbers in rooms of their own at a time, with one thread
    };
    static Plan plan_for(const BlockSupernodes& supernodes);

    std::vector<int> position_; ///< of each block
    std::vector<int> block_at_; ///< at each position
    BlockSupernodes supernodes_;
    Plan plan_;
    // NOLINTBEGIN(modernize-avoid-c-arrays): their numbers are left unset
    std::unique_ptr<float[]> values_;
    std::unique_ptr<float[]> upper_values_; ///< of the transposed U; empty for L L'
    // NOLINTEND(modernize-avoid-c-arrays)
};

} // namespace kluft

// Symbolic analysis of a Cholesky factor on the graph of blocks. Rows are blocks there, six times fewer than unknowns.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kluft/assembly/block_matrix.hpp"

namespace kluft {

/// Columns of blocks of L that share their rows below them, and the tree along which they are eliminated. Positions are
/// those of the elimination order, which is a postorder: descendants of a supernode stand right before it.
struct BlockSupernodes {
    int nu = 6;                             ///< unknowns per block
    std::vector<int> first_block;           ///< of each supernode, and the number of blocks
    std::vector<std::int64_t> row_starts;   ///< in `rows`, of each supernode and one past the last
    std::vector<int> rows;                  ///< positions of blocks below the supernode, ascending
    std::vector<std::int64_t> value_starts; ///< of each supernode's numbers, stored by columns, and their number
    std::vector<int> parent;                ///< supernode of the first row below, -1 at a root
    double nonzeros = 0.0;                  ///< of L, without the zeros that supernodes share
    double flops = 0.0;                     ///< sum of the squares of the column lengths

    [[nodiscard]] int size() const { return static_cast<int>(parent.size()); }
    [[nodiscard]] int n_blocks(int k) const { return first_block[k + 1] - first_block[k]; }
    [[nodiscard]] int n_columns(int k) const { return nu * n_blocks(k); }
    [[nodiscard]] std::span<const int> rows_below(int k) const {
        return {rows.data() + row_starts[k], rows.data() + row_starts[k + 1]};
    }
    [[nodiscard]] int n_below(int k) const { return nu * static_cast<int>(row_starts[k + 1] - row_starts[k]); }
};

/// Supernodes with small children joined to their parents, where few zeros are stored for it (Ashcraft and Grimes 1989).
[[nodiscard]] BlockSupernodes block_supernodes(const BlockPattern& pattern, const std::vector<int>& position);

} // namespace kluft

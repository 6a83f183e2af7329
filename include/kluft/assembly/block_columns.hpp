// The stiffness matrix by columns, in elimination order: what sparse factorizations read.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_matrix.hpp"

namespace kluft {

/// New position of each block in a fill-reducing order: METIS's nested dissection of the graph of blocks, postordered
/// along the elimination tree. Throws ResourceError out of memory.
[[nodiscard]] std::vector<int> elimination_order(const BlockPattern& pattern);

/// Vectors with `nu` unknowns per block from the natural to the elimination order and back.
void permute(const std::vector<int>& position, int nu, const Eigen::VectorXd& natural, double* permuted);
void unpermute(const std::vector<int>& position, int nu, const double* permuted, Eigen::VectorXd& natural);

/// Compressed columns of a matrix on a block pattern, rows ascending; either complete or its lower triangle only. The
/// columns, which take 2 kB per block of a hexagon net for a triangle, exist from `gather` to `release`.
class BlockColumns {
public:
    enum class Part { all, lower };

    BlockColumns() = default;
    BlockColumns(const BlockPattern& pattern, const std::vector<int>& position, Part part);

    [[nodiscard]] std::int64_t size() const;                              ///< number of columns, all unknowns
    [[nodiscard]] std::vector<std::int64_t>& starts() { return starts_; } ///< per column and one past the last
    [[nodiscard]] std::vector<std::int64_t>& rows() { return rows_; }     ///< per nonzero
    [[nodiscard]] std::vector<double>& values() { return values_; }       ///< per nonzero

    /// Starts and rows alone.
    void gather_structure();
    /// Takes the values of a matrix on the same pattern.
    void gather(const BlockMatrix& matrix);
    void release();

private:
    /// A block of a column of blocks.
    struct Source {
        int entry = 0; ///< of the pattern
        int row = 0;   ///< position of its row of blocks
    };
    /// First row that counts in column j of a block: the lower triangle of diagonal blocks, if that is all.
    [[nodiscard]] int first_row(int column_of_blocks, const Source& source, int j) const {
        return part_ == Part::lower && source.row == column_of_blocks ? j : 0;
    }

    template <int n> void gather_structure_of();
    template <int n, class Entries> void gather_entries(const Entries& entries);

    Part part_ = Part::all;
    int nu_ = 6;                     ///< unknowns per block
    std::vector<Source> sources_;    ///< by column of blocks, in elimination order, rows ascending
    std::vector<int> source_starts_; ///< per column of blocks and one past the last
    std::vector<std::int64_t> starts_;
    std::vector<std::int64_t> rows_;
    std::vector<double> values_;
};

} // namespace kluft

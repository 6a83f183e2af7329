// The factors L U = K of an unsymmetric stiffness by UMFPACK, with pivoting inside fronts. UMFPACK is not seen outside
// this unit.
#pragma once

#include <memory>
#include <vector>

#include "kluft/assembly/block_columns.hpp"

namespace kluft {

/// Vectors here are in elimination order.
class LuFactor {
public:
    LuFactor();
    ~LuFactor();
    LuFactor(const LuFactor&) = delete;
    LuFactor& operator=(const LuFactor&) = delete;

    /// The symbolic analysis is left to the first factorization.
    void analyze(const BlockPattern& pattern, const std::vector<int>& position);
    /// Copies what the next `factorize` reads.
    void gather(const BlockMatrix& matrix);
    /// False if the gathered matrix is singular. Throws ResourceError out of memory.
    [[nodiscard]] bool factorize();
    /// Of the last factorization.
    [[nodiscard]] bool has_negative_determinant() const;
    /// x = K^-1 b, sizes 6 n_blocks.
    void solve(std::vector<double>& b, std::vector<double>& x);
    /// Gives the memory back; the next factorization needs `analyze` no more than before.
    void forget();

private:
    struct Umfpack;
    std::unique_ptr<Umfpack> umfpack_;
};

} // namespace kluft

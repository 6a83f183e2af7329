// The factor L L' = K of a symmetric positive definite stiffness or L U = K of an unsymmetric one, and its parts along a
// path of the elimination tree: by CHOLMOD's supernodal method in double precision, or by the multifrontal method in single
// precision where the body is large or the stiffness unsymmetric. CHOLMOD is not seen outside this unit.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "kluft/assembly/block_columns.hpp"
#include "kluft/assembly/multifrontal_factor.hpp"

namespace kluft {

/// Columns of L, and of the transposed U, that share their rows below the diagonal block.
struct Supernode {
    std::int64_t first_column = 0;
    int n_columns = 0;
    int n_rows = 0;                     ///< those of the diagonal block included
    const std::int64_t* rows = nullptr; ///< ascending; the first n_columns are the columns themselves
    std::int64_t first_value = 0; ///< of n_rows x n_columns, by columns; the upper triangle of the top is not used
};

/// Nonzeros of L, flops of one factorization, bytes of the stored factor and those that are taken besides while it is made,
/// by the symbolic count.
struct FactorCost {
    double nonzeros = 0.0;
    double flops = 0.0;
    double bytes = 0.0;
    double working_bytes = 0.0;
};

/// Precision in which a factor is kept.
enum class Precision {
    full,  ///< double
    single ///< rounded, but where the matrix is too ill-conditioned for it; for solutions that are refined
};

/// Vectors here are in elimination order.
class SupernodalFactor {
public:
    SupernodalFactor();
    ~SupernodalFactor();
    SupernodalFactor(const SupernodalFactor&) = delete;
    SupernodalFactor& operator=(const SupernodalFactor&) = delete;

    /// Forgets the earlier factor. A method's symbolic analysis is made when it is first used, but of a large body's now.
    /// Throws ResourceError out of memory.
    void analyze(const BlockPattern& pattern, const std::vector<int>& position);
    /// By the multifrontal method. False if the matrix is too ill-conditioned for single precision, or symmetric and the body
    /// too small for this to be faster, or L U would take too much memory; there is no factor then, and the other way remains. Throws ResourceError out of
    /// memory.
    [[nodiscard]] bool factorize_in_single(const BlockMatrix& matrix, Symmetry symmetry);
    /// Copies what the next `factorize` reads; there is no factor until then.
    void gather(const BlockMatrix& matrix);
    /// False if the gathered matrix is not positive definite. Throws ResourceError out of memory.
    [[nodiscard]] bool factorize(Precision precision);
    /// Gives the memory of the factor back; the analysis stays.
    void forget();
    /// x := L^-1 x and x := L'^-1 x or U^-1 x, size 6 n_blocks. Throw ResourceError out of memory.
    void solve_lower(std::vector<double>& x);
    void solve_upper(std::vector<double>& x);

    /// Of a factor of that precision, or of the one in double precision where the body is small; the operations are those
    /// of L L'.
    [[nodiscard]] FactorCost cost(Precision precision, Symmetry symmetry);
    /// Whether the factor is so large that memory is given up for it, rather than taken anew afterwards.
    [[nodiscard]] bool is_large() const;
    [[nodiscard]] bool is_multifrontal() const { return is_multifrontal_; }
    /// Whether it is L L'.
    [[nodiscard]] bool is_symmetric() const { return rounded_upper_ == nullptr; }

    /// Of the factor that there is.
    [[nodiscard]] int n_supernodes() const { return static_cast<int>(parent_.size()); }
    [[nodiscard]] Supernode supernode(int k) const;
    /// The numbers of a supernode, n_rows x n_columns by columns; `room` holds them if they are kept rounded.
    const double* values(const Supernode& supernode, std::vector<double>& room) const;
    /// The same of the transposed U; those of L for L L'.
    const double* upper_values(const Supernode& supernode, std::vector<double>& room) const;
    [[nodiscard]] int supernode_of_column(std::int64_t column) const { return of_column_[column]; }
    /// The next supernode on the path to the root, -1 at the root.
    [[nodiscard]] int parent(int k) const { return parent_[k]; }

private:
    struct Cholmod;
    std::unique_ptr<Cholmod> cholmod_;
    void analyze_for_cholmod();
    void analyze_for_multifrontal(const BlockPattern& pattern);
    void set_method(bool multifrontal);
    [[nodiscard]] bool has_finite_pivots() const;
    [[nodiscard]] double least_pivot_ratio();

    BlockColumns columns_;
    std::vector<int> position_;                        ///< of each block
    std::unique_ptr<MultifrontalFactor> multifrontal_; ///< of a large body, or once L U was asked for
    bool is_multifrontal_ = false;                     ///< the factor that there is, or will be
    std::vector<std::int64_t> rows_;                   ///< unknowns of the supernodes of the multifrontal factor
    const float* rounded_ = nullptr;                   ///< the numbers of the factor, if it is kept in single precision
    const float* rounded_upper_ = nullptr;             ///< of the transposed U
    std::vector<float> copy_;                          ///< those of a small one, which is kept in double precision too
    std::vector<double> work_;                         ///< for one supernode
    std::vector<int> parent_;
    std::vector<int> of_column_;
};

} // namespace kluft

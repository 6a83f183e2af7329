// Low-rank changes of a factored stiffness by the formula of Sherman, Morrison and Woodbury, with solves along paths of
// the elimination tree (Hager, SIAM Review 31, 1989; docs/theory.md, "Reuse of the factor").
#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "kluft/assembly/supernodal_factor.hpp"

namespace kluft {

/// A change of stiffness between two blocks: sum over i, j of stiffness(i, j) row_i' row_j. The rows are linear in the
/// unknowns of the two blocks, which must have an entry in the pattern; of rigid blocks only the first three count.
struct StiffnessChange {
    long patch = 0; ///< identity of the rows: the same number has the same rows until the next factorization
    int block_a = 0;
    int block_b = 0;
    int n_rows = 4;
    Eigen::Matrix<double, 4, 6> rows_a = Eigen::Matrix<double, 4, 6>::Zero();
    Eigen::Matrix<double, 4, 6> rows_b = Eigen::Matrix<double, 4, 6>::Zero();
    Eigen::Matrix4d stiffness = Eigen::Matrix4d::Zero(); ///< may be unsymmetric
};

/// K = L U + B' D B for the rows B of all patches seen since `start`; U is L' of a symmetric factor. Vectors are in elimination order.
class LowRankUpdate {
public:
    /// Forgets all rows: the factor is new. `nu`: unknowns per block.
    void start(const SupernodalFactor& factor, const std::vector<int>& position, int nu);

    /// D of the complete list of changes; rows seen for the first time are appended, those of zero stiffness left out.
    /// False if the changed matrix is singular to working precision.
    [[nodiscard]] bool set(const std::vector<StiffnessChange>& changes);

    /// Between the two triangular solutions: z := z - W (I + D G)^-1 D V' z with W = L^-1 B', V = U'^-1 B', G = V' W.
    void apply(std::vector<double>& z);

    /// Rows seen since `start`.
    [[nodiscard]] int rank() const { return rank_; }
    /// What `set` would make of it.
    [[nodiscard]] int rank_with(const std::vector<StiffnessChange>& changes) const;

private:
    static constexpr int batch_width = 16;

    /// Columns of W and V, stored along the union of their paths.
    struct Batch {
        std::vector<int> supernodes; ///< ascending
        std::vector<int> offsets;    ///< of the first row of each supernode's columns, and the length
        int first = 0;               ///< row of B of the first column
        bool is_active = false;      ///< has a row that D changes
        Eigen::MatrixXd w;
        Eigen::MatrixXd v; ///< empty for L L', where it is W
        [[nodiscard]] const Eigen::MatrixXd& of_upper() const { return v.size() > 0 ? v : w; }
    };
    struct NewRow {
        int supernode = 0; ///< where the path starts
        int change = 0;    ///< in the list of changes
        int row = 0;       ///< in the patch
    };
    using PatchRows = std::array<int, 4>; ///< place of each row in B, -1 if not seen

    void append(const std::vector<StiffnessChange>& changes, const std::vector<NewRow>& rows, std::size_t first,
                std::size_t last);
    [[nodiscard]] bool set_small(const std::vector<StiffnessChange>& changes);
    void solve_along_path(const Batch& batch, bool upper, Eigen::MatrixXd& w);
    void extend_gram(const Batch& batch);

    const SupernodalFactor* factor_ = nullptr;
    const std::vector<int>* position_ = nullptr;
    int nu_ = 0;
    std::map<long, PatchRows> patches_;
    std::vector<Batch> batches_;
    int rank_ = 0;
    std::vector<int> active_; ///< rows of B that D changes, ascending
    Eigen::MatrixXd gram_;    ///< G, at least rank x rank
    Eigen::MatrixXd d_;       ///< D on the active rows
    Eigen::PartialPivLU<Eigen::MatrixXd> small_;
    Eigen::VectorXd t_, t_active_, y_;
    std::vector<int> packed_of_; ///< per supernode of the batch in work
    Eigen::MatrixXd below_;
    std::vector<double> values_; ///< of one supernode
    std::vector<double> packed_; ///< along the path of a batch
};

} // namespace kluft

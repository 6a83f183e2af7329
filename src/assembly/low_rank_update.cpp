#include "kluft/assembly/low_rank_update.hpp"

#include <algorithm>
#include <cmath>

#include "kluft/assembly/blas.hpp"
#include "kluft/core/change_size.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double least_pivot_ratio =
    1e-11; ///< of the small matrix: below, the changed stiffness is as good as singular

bool counts(const StiffnessChange& change, int row) {
    return change.stiffness.row(row).head(change.n_rows).cwiseAbs().maxCoeff() > 0.0 ||
           change.stiffness.col(row).head(change.n_rows).cwiseAbs().maxCoeff() > 0.0;
}

} // namespace

void LowRankUpdate::start(const SupernodalFactor& factor, const std::vector<int>& position, int nu) {
    factor_ = &factor;
    position_ = &position;
    nu_ = nu;
    patches_.clear();
    batches_.clear();
    rank_ = 0;
    active_.clear();
    packed_of_.assign(factor.n_supernodes(), -1);
}

int LowRankUpdate::rank_with(const std::vector<StiffnessChange>& changes) const {
    int rank = rank_;
    for (const StiffnessChange& change : changes) {
        const auto known = patches_.find(change.patch);
        for (int row = 0; row < change.n_rows; ++row) {
            if (counts(change, row) && (known == patches_.end() || known->second[row] < 0)) ++rank;
        }
    }
    return rank;
}

bool LowRankUpdate::set(const std::vector<StiffnessChange>& changes) {
    std::vector<NewRow> rows;
    for (int c = 0; c < static_cast<int>(changes.size()); ++c) {
        const StiffnessChange& change = changes[c];
        PatchRows& known = patches_.try_emplace(change.patch, PatchRows{-1, -1, -1, -1}).first->second;
        const int start = std::min((*position_)[change.block_a], (*position_)[change.block_b]);
        for (int row = 0; row < change.n_rows; ++row) {
            if (known[row] < 0 && counts(change, row))
                rows.push_back({factor_->supernode_of_column(static_cast<std::int64_t>(nu_) * start), c, row});
        }
    }
    // Neighbours in the postorder share most of their paths.
    std::ranges::stable_sort(rows, {}, &NewRow::supernode);
    for (std::size_t first = 0; first < rows.size(); first += batch_width) {
        const std::size_t last = std::min(rows.size(), first + batch_width);
        for (std::size_t i = first; i < last; ++i) {
            patches_.at(changes[rows[i].change].patch)[rows[i].row] = rank_ + static_cast<int>(i - first);
        }
        append(changes, rows, first, last);
    }

    return set_small(changes);
}

/// D and I + D G on the rows that D changes: those that have come back to what is in the factor count for nothing.
bool LowRankUpdate::set_small(const std::vector<StiffnessChange>& changes) {
    active_.clear();
    for (const StiffnessChange& change : changes) {
        const PatchRows& at = patches_.at(change.patch);
        for (int i = 0; i < change.n_rows; ++i)
            if (counts(change, i)) active_.push_back(at[i]);
    }
    std::ranges::sort(active_);
    const auto n = static_cast<Eigen::Index>(active_.size());
    for (Batch& batch : batches_) {
        const auto next = std::ranges::lower_bound(active_, batch.first);
        batch.is_active = next != active_.end() && *next < batch.first + batch.w.cols();
    }
    if (n == 0) return true;
    std::vector<int> place(rank_, -1);
    for (Eigen::Index i = 0; i < n; ++i) place[active_[i]] = static_cast<int>(i);
    change_size(d_, n, n);
    d_.setZero();
    Eigen::MatrixXd small = Eigen::MatrixXd::Identity(n, n);
    for (const StiffnessChange& change : changes) {
        const PatchRows& at = patches_.at(change.patch);
        for (int i = 0; i < change.n_rows; ++i) {
            for (int j = 0; j < change.n_rows; ++j) {
                const double stiffness = change.stiffness(i, j);
                if (stiffness == 0.0) continue;
                d_(place[at[i]], place[at[j]]) = stiffness;
                for (Eigen::Index k = 0; k < n; ++k) small(place[at[i]], k) += stiffness * gram_(at[j], active_[k]);
            }
        }
    }
    small_ = Eigen::PartialPivLU<Eigen::MatrixXd>(small);
    const auto pivots = small_.matrixLU().diagonal().cwiseAbs();
    return pivots.allFinite() && pivots.minCoeff() > least_pivot_ratio * pivots.maxCoeff();
}

void LowRankUpdate::append(const std::vector<StiffnessChange>& changes, const std::vector<NewRow>& rows,
                           std::size_t first, std::size_t last) {
    Batch batch;
    batch.first = rank_;
    const int width = static_cast<int>(last - first);
    for (std::size_t i = first; i < last; ++i) {
        for (int k = rows[i].supernode; k >= 0 && packed_of_[k] < 0; k = factor_->parent(k)) {
            packed_of_[k] = 0;
            batch.supernodes.push_back(k);
        }
    }
    std::ranges::sort(batch.supernodes);
    int length = 0;
    for (const int k : batch.supernodes) {
        packed_of_[k] = length;
        batch.offsets.push_back(length);
        length += factor_->supernode(k).n_columns;
    }
    batch.offsets.push_back(length);

    batch.w.setZero(length, width);
    const auto place = [&](int block, const auto& row, int column) {
        const std::int64_t at = static_cast<std::int64_t>(nu_) * (*position_)[block];
        for (int i = 0; i < nu_; ++i) { // the unknowns of a block may be in two supernodes
            const int k = factor_->supernode_of_column(at + i);
            batch.w(packed_of_[k] + static_cast<int>(at + i - factor_->supernode(k).first_column), column) += row[i];
        }
    };
    for (std::size_t i = first; i < last; ++i) {
        const StiffnessChange& change = changes[rows[i].change];
        const int column = static_cast<int>(i - first);
        place(change.block_a, change.rows_a.row(rows[i].row), column);
        place(change.block_b, change.rows_b.row(rows[i].row), column);
    }
    if (!factor_->is_symmetric()) {
        batch.v = batch.w;
        solve_along_path(batch, true, batch.v);
    }
    solve_along_path(batch, false, batch.w);
    for (const int k : batch.supernodes) packed_of_[k] = -1;
    rank_ += width;
    batches_.push_back(std::move(batch));
    extend_gram(batches_.back());
}

/// w := L^-1 w, or U'^-1 w, of which only the supernodes of the path are not zero.
void LowRankUpdate::solve_along_path(const Batch& batch, bool upper, Eigen::MatrixXd& w) {
    const int width = static_cast<int>(w.cols());
    const int length = static_cast<int>(w.rows());
    for (std::size_t s = 0; s < batch.supernodes.size(); ++s) {
        const Supernode node = factor_->supernode(batch.supernodes[s]);
        double* top = w.data() + batch.offsets[s];
        const double* const values = upper ? factor_->upper_values(node, values_) : factor_->values(node, values_);
        solve_lower_triangle(node.n_columns, width, values, node.n_rows, top, length);
        const int n_below = node.n_rows - node.n_columns;
        if (n_below == 0) continue;
        change_size(below_, n_below, width);
        multiply(n_below, width, node.n_columns, values + node.n_columns, node.n_rows, top, length, below_.data(),
                 n_below);
        for (int i = 0; i < n_below;) { // runs of rows in one supernode
            const std::int64_t row = node.rows[node.n_columns + i];
            const int k = factor_->supernode_of_column(row);
            const Supernode above = factor_->supernode(k);
            const std::int64_t end = above.first_column + above.n_columns;
            for (; i < n_below && node.rows[node.n_columns + i] < end; ++i) {
                const int at = packed_of_[k] + static_cast<int>(node.rows[node.n_columns + i] - above.first_column);
                w.row(at) -= below_.row(i);
            }
        }
    }
}

/// The rows and columns of G that a new batch brings: the products with all batches over common supernodes.
void LowRankUpdate::extend_gram(const Batch& batch) {
    if (gram_.rows() < rank_) gram_.conservativeResize(2 * rank_, 2 * rank_);
    const int width = static_cast<int>(batch.w.cols());
    const bool is_symmetric = factor_->is_symmetric();
    for (const Batch& other : batches_) {
        auto product = gram_.block(other.first, batch.first, other.w.cols(), width);
        auto transposed = gram_.block(batch.first, other.first, width, other.w.cols());
        const bool is_other = &other != &batch;
        product.setZero();
        if (is_other) transposed.setZero();
        for (std::size_t i = 0, j = 0; i < other.supernodes.size() && j < batch.supernodes.size();) {
            if (other.supernodes[i] != batch.supernodes[j]) {
                ++(other.supernodes[i] < batch.supernodes[j] ? i : j);
                continue;
            }
            std::size_t n = 1; // a run of common supernodes is one product
            while (i + n < other.supernodes.size() && j + n < batch.supernodes.size() &&
                   other.supernodes[i + n] == batch.supernodes[j + n]) {
                ++n;
            }
            const int length = other.offsets[i + n] - other.offsets[i];
            const auto rows_of_other = [&](const Eigen::MatrixXd& of) {
                return of.middleRows(other.offsets[i], length);
            };
            const auto rows = [&](const Eigen::MatrixXd& of) { return of.middleRows(batch.offsets[j], length); };
            product.noalias() += rows_of_other(other.of_upper()).transpose() * rows(batch.w);
            if (is_other && !is_symmetric)
                transposed.noalias() += rows(batch.of_upper()).transpose() * rows_of_other(other.w);
            i += n;
            j += n;
        }
        if (is_other && is_symmetric) transposed = product.transpose();
    }
}

void LowRankUpdate::apply(std::vector<double>& z) {
    if (active_.empty()) return;
    const auto n = static_cast<Eigen::Index>(active_.size());
    change_size(t_, rank_);
    change_size(t_active_, n);
    change_size(y_, n);
    for (const Batch& batch : batches_) {
        if (!batch.is_active) continue;
        const int length = static_cast<int>(batch.w.rows());
        packed_.resize(length);
        for (std::size_t s = 0; s < batch.supernodes.size(); ++s) {
            std::copy_n(z.data() + factor_->supernode(batch.supernodes[s]).first_column,
                        batch.offsets[s + 1] - batch.offsets[s], packed_.begin() + batch.offsets[s]);
        }
        multiply_transposed(length, static_cast<int>(batch.w.cols()), batch.of_upper().data(), length, packed_.data(),
                            t_.data() + batch.first);
    }
    for (Eigen::Index i = 0; i < n; ++i) t_active_[i] = t_[active_[i]];
    y_.noalias() = d_ * t_active_;
    y_ = small_.solve(y_);
    t_.setZero();
    for (Eigen::Index i = 0; i < n; ++i) t_[active_[i]] = y_[i];
    for (const Batch& batch : batches_) {
        if (!batch.is_active) continue;
        const int length = static_cast<int>(batch.w.rows());
        packed_.resize(length);
        multiply(length, static_cast<int>(batch.w.cols()), batch.w.data(), length, t_.data() + batch.first,
                 packed_.data());
        for (std::size_t s = 0; s < batch.supernodes.size(); ++s) {
            double* const at = z.data() + factor_->supernode(batch.supernodes[s]).first_column;
            for (int i = batch.offsets[s]; i < batch.offsets[s + 1]; ++i) at[i - batch.offsets[s]] -= packed_[i];
        }
    }
}

} // namespace kluft

#include "kluft/assembly/block_columns.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <cholmod.h>
#include <csignal>
#include <metis.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

/// Keeps METIS from the signals of this program. While it works it handles SIGTERM and SIGABRT itself: it takes one that
/// comes from outside for an error of its own, leaves its work, wherever that is, and reports a lack of memory; and it
/// restores the handlers in System V's way, for one signal only. SIGTERM waits until METIS is done.
class SignalsKept {
public:
    SignalsKept() {
        sigset_t termination;
        sigemptyset(&termination);
        sigaddset(&termination, SIGTERM);
        pthread_sigmask(SIG_BLOCK, &termination, &blocked_);
        sigaction(SIGTERM, nullptr, &on_termination_);
        sigaction(SIGABRT, nullptr, &on_abort_);
    }
    ~SignalsKept() {
        sigaction(SIGTERM, &on_termination_, nullptr);
        sigaction(SIGABRT, &on_abort_, nullptr);
        pthread_sigmask(SIG_SETMASK, &blocked_, nullptr);
    }
    SignalsKept(const SignalsKept&) = delete;
    SignalsKept& operator=(const SignalsKept&) = delete;

private:
    sigset_t blocked_{};
    struct sigaction on_termination_ {};
    struct sigaction on_abort_ {};
};

/// METIS's new position of each block.
std::vector<int> nested_dissection(const BlockPattern& pattern) {
    const int n = pattern.n_blocks();
    std::vector<int> position(n);
    std::iota(position.begin(), position.end(), 0);
    if (n < 3) return position;
    std::vector<idx_t> starts(n + 1, 0);
    std::vector<idx_t> neighbours;
    neighbours.reserve(pattern.n_entries() - n);
    for (int row = 0; row < n; ++row) {
        for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
            if (pattern.column(entry) != row) neighbours.push_back(pattern.column(entry));
        }
        starts[row + 1] = static_cast<idx_t>(neighbours.size());
    }
    if (neighbours.empty()) return position;
    idx_t count = n;
    std::vector<idx_t> perm(n);
    std::vector<idx_t> inverse(n);
    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    options[METIS_OPTION_SEED] = 1;
    const SignalsKept kept;
    if (METIS_NodeND(&count, starts.data(), neighbours.data(), nullptr, options, perm.data(), inverse.data()) !=
        METIS_OK) {
        throw ResourceError("out of memory while ordering the blocks");
    }
    std::copy(inverse.begin(), inverse.end(), position.begin());
    return position;
}

std::vector<int> inverse_of(const std::vector<int>& position) {
    std::vector<int> block_at(position.size());
    for (std::size_t b = 0; b < position.size(); ++b) block_at[position[b]] = static_cast<int>(b);
    return block_at;
}

/// Postorder of the elimination tree of the permuted graph of blocks: the place k is taken by position postorder[k].
/// Descendants then stand before their ancestors and next to each other, and supernodes are runs of columns.
std::vector<std::int64_t> postorder(const BlockPattern& pattern, const std::vector<int>& position) {
    const int n = pattern.n_blocks();
    const auto block_at = inverse_of(position);
    std::vector<std::int64_t> starts{0};
    std::vector<std::int64_t> rows;
    for (int p = 0; p < n; ++p) { // the upper triangle by columns
        const int b = block_at[p];
        for (int entry = pattern.row_start(b); entry < pattern.row_start(b + 1); ++entry) {
            const int row = position[pattern.column(entry)];
            if (row <= p) rows.push_back(row);
        }
        starts.push_back(static_cast<std::int64_t>(rows.size()));
    }
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = n;
    graph.nzmax = rows.size();
    graph.p = starts.data();
    graph.i = rows.data();
    graph.stype = 1;
    graph.itype = CHOLMOD_LONG;
    graph.xtype = CHOLMOD_PATTERN;
    graph.packed = 1;

    cholmod_common common{};
    cholmod_l_start(&common);
    common.print = 0;
    std::vector<std::int64_t> parent(n);
    std::vector<std::int64_t> order(n);
    const bool done = cholmod_l_etree(&graph, parent.data(), &common) != 0 &&
                      cholmod_l_postorder(parent.data(), n, nullptr, order.data(), &common) == n;
    cholmod_l_finish(&common);
    if (!done) throw ResourceError("out of memory while ordering the blocks");
    return order;
}

} // namespace

std::vector<int> elimination_order(const BlockPattern& pattern) {
    std::vector<int> position = nested_dissection(pattern);
    const auto order = postorder(pattern, position);
    std::vector<int> place(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
    for (int& p : position) p = place[p];
    return position;
}

void permute(const std::vector<int>& position, int nu, const Eigen::VectorXd& natural, double* permuted) {
    for (std::size_t b = 0; b < position.size(); ++b) {
        std::copy_n(natural.data() + nu * b, nu, permuted + static_cast<std::size_t>(nu) * position[b]);
    }
}

void unpermute(const std::vector<int>& position, int nu, const double* permuted, Eigen::VectorXd& natural) {
    natural.resize(static_cast<Eigen::Index>(nu * position.size()));
    for (std::size_t b = 0; b < position.size(); ++b) {
        std::copy_n(permuted + static_cast<std::size_t>(nu) * position[b], nu, natural.data() + nu * b);
    }
}

BlockColumns::BlockColumns(const BlockPattern& pattern, const std::vector<int>& position, Part part)
    : part_(part), nu_(pattern.block_unknowns()) {
    const int n = pattern.n_blocks();
    const auto block_at = inverse_of(position);
    sources_.reserve(part == Part::all ? pattern.n_entries() : (pattern.n_entries() + n) / 2);
    source_starts_.reserve(static_cast<std::size_t>(n) + 1);
    source_starts_.push_back(0);
    for (int p = 0; p < n; ++p) { // by structural symmetry the column has the rows of the row
        const int b = block_at[p];
        const auto first = static_cast<std::ptrdiff_t>(sources_.size());
        for (int entry = pattern.row_start(b); entry < pattern.row_start(b + 1); ++entry) {
            const int row = pattern.column(entry);
            if (part == Part::all || position[row] >= p) sources_.push_back({pattern.find(row, b), position[row]});
        }
        std::sort(sources_.begin() + first, sources_.end(),
                  [](const Source& x, const Source& y) { return x.row < y.row; });
        source_starts_.push_back(static_cast<int>(sources_.size()));
    }
}

std::int64_t BlockColumns::size() const { return nu_ * (static_cast<std::int64_t>(source_starts_.size()) - 1); }

void BlockColumns::gather_structure() {
    if (!rows_.empty()) return;
    if (nu_ == n_rigid_unknowns) return gather_structure_of<n_rigid_unknowns>();
    gather_structure_of<n_block_unknowns>();
}

template <int nu> void BlockColumns::gather_structure_of() {
    const int n = static_cast<int>(source_starts_.size()) - 1;
    starts_.reserve(static_cast<std::size_t>(nu) * n + 1);
    starts_.push_back(0);
    rows_.reserve(sources_.size() * nu * nu -
                  (part_ == Part::all ? 0 : static_cast<std::size_t>(n) * nu * (nu - 1) / 2));
    for (int p = 0; p < n; ++p) {
        for (int j = 0; j < nu; ++j) {
            for (int k = source_starts_[p]; k < source_starts_[p + 1]; ++k) {
                for (int i = first_row(p, sources_[k], j); i < nu; ++i) rows_.push_back(nu * sources_[k].row + i);
            }
            starts_.push_back(static_cast<std::int64_t>(rows_.size()));
        }
    }
}

void BlockColumns::gather(const BlockMatrix& matrix) {
    gather_structure();
    if (matrix.is_rigid()) return gather_entries<n_rigid_unknowns>(matrix.rigid_values);
    gather_entries<n_block_unknowns>(matrix.values);
}

template <int nu, class Entries> void BlockColumns::gather_entries(const Entries& entries) {
    values_.resize(rows_.size());
    const int n = static_cast<int>(source_starts_.size()) - 1;
    double* value = values_.data();
    for (int p = 0; p < n; ++p) {
        for (int j = 0; j < nu; ++j) {
            for (int k = source_starts_[p]; k < source_starts_[p + 1]; ++k) {
                const int first = first_row(p, sources_[k], j);
                value = std::copy_n(entries[sources_[k].entry].data() + nu * j + first, nu - first, value);
            }
        }
    }
}

void BlockColumns::release() {
    starts_ = std::vector<std::int64_t>(); // clearing would keep the room
    rows_ = std::vector<std::int64_t>();
    values_ = std::vector<double>();
}

} // namespace kluft

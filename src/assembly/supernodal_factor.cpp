#include "kluft/assembly/supernodal_factor.hpp"

#include <algorithm>
#include <cmath>

#include <cholmod.h>

#include "kluft/assembly/rounded_supernode.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/memory.hpp"

namespace kluft {

namespace {

/// Bytes beyond which the last factor is given up before the next one is prepared, so that it is never held together
/// with two copies of the matrix. Below, fresh pages would cost more than they are worth.
constexpr double large_factor = 8e6;

/// Unknowns from which on a body has a multifrontal factor, where single precision is enough.
constexpr std::int64_t multifrontal_unknowns = 1'500;

/// Bytes of L beyond which memory matters more than the vectors that U saves.
constexpr double largest_with_u = 1e9;

/// Least share of a diagonal entry that elimination may leave for the factor to be rounded: rounding to 6e-8 of the
/// diagonal then stays far below it.
constexpr double roundable_pivot_ratio = 1e-5;

} // namespace

struct SupernodalFactor::Cholmod {
    Cholmod() {
        cholmod_l_start(&common);
        common.itype = CHOLMOD_LONG;
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_NATURAL; // the matrix comes in elimination order: no copy, no permutation
        common.postorder = 0;
        common.print = 0;
        common.error_handler = nullptr;
    }
    ~Cholmod() {
        cholmod_l_free_factor(&factor, &common);
        cholmod_l_free_dense(&solution, &common);
        cholmod_l_free_dense(&work_y, &common);
        cholmod_l_free_dense(&work_e, &common);
        cholmod_l_finish(&common);
    }
    Cholmod(const Cholmod&) = delete;
    Cholmod& operator=(const Cholmod&) = delete;

    void require_memory() const {
        if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) {
            throw ResourceError("out of memory in the factorization");
        }
    }

    /// Room for the numbers of the factor, as CHOLMOD would take it, but of huge pages if it is large: the system hands
    /// them out much faster.
    void allocate_factor() {
        if (factor->xtype != CHOLMOD_PATTERN) return;
        constexpr int yes = 1;
        cholmod_l_change_factor(CHOLMOD_REAL, yes, yes, yes, yes, factor, &common);
        require_memory();
        prefer_huge_pages(factor->x, sizeof(double) * factor->xsize);
    }

    void free_numbers() {
        constexpr int yes = 1;
        if (factor != nullptr && factor->xtype != CHOLMOD_PATTERN)
            cholmod_l_change_factor(CHOLMOD_PATTERN, yes, yes, yes, yes, factor, &common);
    }

    void solve(int system, std::vector<double>& x) {
        cholmod_dense view{};
        view.nrow = view.d = view.nzmax = x.size();
        view.ncol = 1;
        view.x = x.data();
        view.xtype = CHOLMOD_REAL;
        view.dtype = CHOLMOD_DOUBLE;
        if (cholmod_l_solve2(system, factor, &view, nullptr, &solution, nullptr, &work_y, &work_e, &common) == 0) {
            throw ResourceError("out of memory in the solution");
        }
        const auto* values = static_cast<const double*>(solution->x);
        std::copy(values, values + x.size(), x.begin());
    }

    cholmod_common common{};
    cholmod_factor* factor = nullptr;
    cholmod_dense* solution = nullptr;
    cholmod_dense* work_y = nullptr;
    cholmod_dense* work_e = nullptr;
};

namespace {

cholmod_sparse lower_triangle(BlockColumns& columns) {
    cholmod_sparse view{};
    view.nrow = view.ncol = columns.size();
    view.nzmax = columns.rows().size();
    view.p = columns.starts().data();
    view.i = columns.rows().data();
    view.x = columns.values().data();
    view.stype = -1;
    view.itype = CHOLMOD_LONG;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
}

/// Of each supernode its own columns and the rows below.
std::vector<std::int64_t> unknowns_of(const BlockSupernodes& s) {
    std::vector<std::int64_t> rows;
    rows.reserve(s.nu * (s.first_block.back() + s.rows.size()));
    for (int k = 0; k < s.size(); ++k) {
        const auto add = [&](int block) {
            for (int i = 0; i < s.nu; ++i) rows.push_back(static_cast<std::int64_t>(s.nu) * block + i);
        };
        for (int block = s.first_block[k]; block < s.first_block[k + 1]; ++block) add(block);
        for (const int block : s.rows_below(k)) add(block);
    }
    return rows;
}

} // namespace

SupernodalFactor::SupernodalFactor() : cholmod_(std::make_unique<Cholmod>()) {}
SupernodalFactor::~SupernodalFactor() = default;

void SupernodalFactor::analyze(const BlockPattern& pattern, const std::vector<int>& position) {
    cholmod_l_free_factor(&cholmod_->factor, &cholmod_->common);
    columns_ = BlockColumns(pattern, position, BlockColumns::Part::lower);
    position_ = position;
    multifrontal_.reset();
    rounded_ = rounded_upper_ = nullptr;
    is_multifrontal_ = columns_.size() >= multifrontal_unknowns;
    parent_.clear();
    if (is_multifrontal_) analyze_for_multifrontal(pattern);
}

void SupernodalFactor::analyze_for_multifrontal(const BlockPattern& pattern) {
    if (multifrontal_) return;
    multifrontal_ = std::make_unique<MultifrontalFactor>();
    multifrontal_->analyze(pattern, position_);
    rows_ = unknowns_of(multifrontal_->supernodes());
}

void SupernodalFactor::analyze_for_cholmod() {
    if (cholmod_->factor != nullptr) return;
    columns_.gather_structure();
    cholmod_sparse matrix = lower_triangle(columns_);
    matrix.xtype = CHOLMOD_PATTERN;
    cholmod_->factor = cholmod_l_analyze(&matrix, &cholmod_->common);
    columns_.release();
    cholmod_->require_memory();
    if (cholmod_->factor == nullptr || cholmod_->factor->is_super == 0) {
        throw ResourceError("the symbolic analysis failed");
    }
}

/// The factor that there will be: its paths are those of one method.
void SupernodalFactor::set_method(bool multifrontal) {
    if (is_multifrontal_ == multifrontal && !parent_.empty()) return;
    is_multifrontal_ = multifrontal;
    const int n = is_multifrontal_ ? multifrontal_->supernodes().size() : static_cast<int>(cholmod_->factor->nsuper);
    parent_.assign(n, -1);
    of_column_.assign(columns_.size(), 0);
    for (int k = 0; k < n; ++k) {
        const Supernode s = supernode(k);
        std::fill_n(of_column_.begin() + s.first_column, s.n_columns, k);
    }
    for (int k = 0; k < n; ++k) {
        const Supernode s = supernode(k);
        if (s.n_rows > s.n_columns) parent_[k] = of_column_[s.rows[s.n_columns]];
    }
}

bool SupernodalFactor::factorize_in_single(const BlockMatrix& matrix, Symmetry symmetry) {
    const bool is_symmetric = symmetry == Symmetry::symmetric;
    if (is_symmetric && columns_.size() < multifrontal_unknowns) return false;
    analyze_for_multifrontal(*matrix.pattern);
    if (!is_symmetric && multifrontal_->bytes() > largest_with_u) return false;
    if (!is_multifrontal_) forget();
    rounded_ = rounded_upper_ = nullptr; // where memory runs out, too
    if (!multifrontal_->factorize(matrix, symmetry)) return false;
    rounded_ = multifrontal_->values();
    rounded_upper_ = is_symmetric ? nullptr : multifrontal_->upper_values();
    set_method(true);
    return true;
}

void SupernodalFactor::gather(const BlockMatrix& matrix) {
    if (is_large()) forget();
    analyze_for_cholmod();
    set_method(false);
    columns_.gather(matrix);
}

bool SupernodalFactor::factorize(Precision precision) {
    rounded_ = rounded_upper_ = nullptr;
    cholmod_->allocate_factor();
    cholmod_sparse view = lower_triangle(columns_);
    cholmod_l_factorize(&view, cholmod_->factor, &cholmod_->common);
    const bool regular =
        cholmod_->common.status == CHOLMOD_OK && cholmod_->factor->minor == cholmod_->factor->n && has_finite_pivots();
    const bool rounded = regular && precision == Precision::single && least_pivot_ratio() >= roundable_pivot_ratio;
    columns_.release();
    cholmod_l_free_work(&cholmod_->common);
    cholmod_->require_memory();
    if (!rounded) return regular;
    auto* const numbers = static_cast<double*>(cholmod_->factor->x);
    const std::size_t n = cholmod_->factor->xsize;
    if (is_large()) {
        rounded_ = round_in_place(numbers, n);
    } else { // paths read it in double precision, many times
        copy_.resize(n + rounded_padding);
        for (std::size_t i = 0; i < n; ++i) copy_[i] = static_cast<float>(numbers[i]);
        rounded_ = copy_.data();
    }
    return regular;
}

/// A number that is none in a row of L makes the pivot of that row one too; the BLAS takes it for positive.
bool SupernodalFactor::has_finite_pivots() const {
    const auto* values = static_cast<const double*>(cholmod_->factor->x);
    double sum = 0.0;
    for (int k = 0; k < n_supernodes(); ++k) {
        const Supernode s = supernode(k);
        for (int j = 0; j < s.n_columns; ++j)
            sum += values[s.first_value + static_cast<std::int64_t>(j) * (s.n_rows + 1)];
    }
    return std::isfinite(sum);
}

/// Of the diagonal entries of K, what elimination has left of them.
double SupernodalFactor::least_pivot_ratio() {
    const auto* values = static_cast<const double*>(cholmod_->factor->x);
    double least = 1.0;
    for (int k = 0; k < n_supernodes(); ++k) {
        const Supernode s = supernode(k);
        for (int j = 0; j < s.n_columns; ++j) {
            const double pivot = values[s.first_value + static_cast<std::int64_t>(j) * (s.n_rows + 1)];
            const double diagonal = columns_.values()[columns_.starts()[s.first_column + j]];
            least = std::min(least, pivot * pivot / diagonal);
        }
    }
    return least;
}

void SupernodalFactor::forget() {
    rounded_ = rounded_upper_ = nullptr;
    if (multifrontal_) multifrontal_->forget();
    cholmod_->free_numbers();
}

void SupernodalFactor::solve_lower(std::vector<double>& x) {
    if (rounded_ == nullptr) return cholmod_->solve(CHOLMOD_L, x);
    for (int k = 0; k < n_supernodes(); ++k) {
        const Supernode s = supernode(k);
        double* const top = x.data() + s.first_column;
        work_.assign(s.n_rows + rounded_padding, 0.0);
        std::copy_n(top, s.n_columns, work_.begin());
        eliminate_forward(s.n_columns, s.n_rows, rounded_ + s.first_value, work_.data());
        std::copy_n(work_.begin(), s.n_columns, top);
        for (int i = s.n_columns; i < s.n_rows; ++i) x[s.rows[i]] += work_[i];
    }
}

void SupernodalFactor::solve_upper(std::vector<double>& x) {
    if (rounded_ == nullptr) return cholmod_->solve(CHOLMOD_Lt, x);
    const float* const values = is_symmetric() ? rounded_ : rounded_upper_;
    for (int k = n_supernodes() - 1; k >= 0; --k) {
        const Supernode s = supernode(k);
        double* const top = x.data() + s.first_column;
        work_.resize(s.n_rows + rounded_padding);
        std::copy_n(top, s.n_columns, work_.begin());
        for (int i = s.n_columns; i < s.n_rows; ++i) work_[i] = x[s.rows[i]];
        substitute_back(s.n_columns, s.n_rows, values + s.first_value, work_.data());
        std::copy_n(work_.begin(), s.n_columns, top);
    }
}

namespace {

const double* widened(const Supernode& supernode, const float* values, std::vector<double>& room) {
    const float* const first = values + supernode.first_value;
    const std::size_t n = static_cast<std::size_t>(supernode.n_rows) * supernode.n_columns;
    if (room.size() < n) room.resize(n);
    for (std::size_t i = 0; i < n; ++i) room[i] = first[i];
    return room.data();
}

} // namespace

const double* SupernodalFactor::values(const Supernode& supernode, std::vector<double>& room) const {
    if (rounded_ == nullptr || rounded_ == copy_.data())
        return static_cast<const double*>(cholmod_->factor->x) + supernode.first_value;
    return widened(supernode, rounded_, room);
}

const double* SupernodalFactor::upper_values(const Supernode& supernode, std::vector<double>& room) const {
    return is_symmetric() ? values(supernode, room) : widened(supernode, rounded_upper_, room);
}

bool SupernodalFactor::is_large() const {
    if (is_multifrontal_) return multifrontal_->bytes() >= large_factor;
    return cholmod_->factor != nullptr && sizeof(double) * static_cast<double>(cholmod_->factor->xsize) >= large_factor;
}

FactorCost SupernodalFactor::cost(Precision precision, Symmetry symmetry) {
    if (is_multifrontal_ && precision == Precision::single) {
        const BlockSupernodes& supernodes = multifrontal_->supernodes();
        const double bytes = multifrontal_->bytes();
        const bool has_u = symmetry == Symmetry::unsymmetric && bytes <= largest_with_u;
        const double n_triangles = has_u ? 2.0 : 1.0;
        return {supernodes.nonzeros, supernodes.flops, n_triangles * bytes, n_triangles * multifrontal_->front_bytes()};
    }
    analyze_for_cholmod();
    const cholmod_common& common = cholmod_->common;
    const double bytes = static_cast<double>(sizeof(double)) * static_cast<double>(cholmod_->factor->xsize);
    return {common.lnz, common.fl, bytes, 0.0};
}

Supernode SupernodalFactor::supernode(int k) const {
    Supernode s;
    if (is_multifrontal_) {
        const BlockSupernodes& all = multifrontal_->supernodes();
        s.first_column = static_cast<std::int64_t>(all.nu) * all.first_block[k];
        s.n_columns = all.n_columns(k);
        s.n_rows = s.n_columns + all.n_below(k);
        s.rows = rows_.data() + s.first_column + all.nu * all.row_starts[k];
        s.first_value = all.value_starts[k];
        return s;
    }
    const cholmod_factor& f = *cholmod_->factor;
    const auto* first = static_cast<const std::int64_t*>(f.super);
    const auto* row_starts = static_cast<const std::int64_t*>(f.pi);
    const auto* value_starts = static_cast<const std::int64_t*>(f.px);
    s.first_column = first[k];
    s.n_columns = static_cast<int>(first[k + 1] - first[k]);
    s.n_rows = static_cast<int>(row_starts[k + 1] - row_starts[k]);
    s.rows = static_cast<const std::int64_t*>(f.s) + row_starts[k];
    s.first_value = value_starts[k];
    return s;
}

} // namespace kluft

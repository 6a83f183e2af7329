#include "kluft/assembly/linear_solver.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <vector>

#include <cholmod.h>
#include <metis.h>
#include <sys/mman.h>
#include <umfpack.h>

#include "kluft/core/diagnostics.hpp"

extern "C" void openblas_set_num_threads(int n_threads);
// NOLINTNEXTLINE(readability-identifier-naming): of the BLAS
extern "C" void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a,
                       const int* lda, double* x, const int* incx);

namespace kluft {

namespace {

constexpr int nu = n_block_unknowns;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Nested dissection of the graph of blocks: new position of each block.
std::vector<int> fill_reducing_order(const BlockPattern& pattern) {
    const int n = pattern.n_blocks();
    std::vector<int> position(n);
    std::iota(position.begin(), position.end(), 0);
    if (n < 3) return position;
    std::vector<idx_t> starts(n + 1, 0);
    std::vector<idx_t> neighbours;
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
    if (METIS_NodeND(&count, starts.data(), neighbours.data(), nullptr, options, perm.data(), inverse.data()) !=
        METIS_OK) {
        throw ResourceError("out of memory while ordering the blocks");
    }
    for (int b = 0; b < n; ++b) position[b] = inverse[b];
    return position;
}

/// The permuted matrix by columns, and where each 6 x 6 block of the pattern goes.
struct ColumnLayout {
    std::vector<int> position;            ///< of each block in the elimination order
    std::vector<SuiteSparse_long> starts; ///< per column, size 6 n_blocks + 1
    std::vector<SuiteSparse_long> rows;   ///< per nonzero
    std::vector<SuiteSparse_long> offset; ///< per pattern entry: first nonzero of the block, relative to its column

    void build(const BlockPattern& pattern) {
        const int n = pattern.n_blocks();
        position = fill_reducing_order(pattern);
        std::vector<int> block_at(n);
        for (int b = 0; b < n; ++b) block_at[position[b]] = b;
        starts.assign(static_cast<std::size_t>(nu) * n + 1, 0);
        rows.assign(static_cast<std::size_t>(nu) * nu * pattern.n_entries(), 0);
        offset.assign(pattern.n_entries(), 0);

        std::vector<std::pair<int, int>> column; // (position of the row, row), by structural symmetry
        SuiteSparse_long next = 0;
        for (int p = 0; p < n; ++p) {
            const int b = block_at[p];
            column.clear();
            for (int entry = pattern.row_start(b); entry < pattern.row_start(b + 1); ++entry) {
                column.emplace_back(position[pattern.column(entry)], pattern.column(entry));
            }
            std::sort(column.begin(), column.end());
            for (int k = 0; k < static_cast<int>(column.size()); ++k) {
                offset[pattern.find(column[k].second, b)] = static_cast<SuiteSparse_long>(nu) * k;
            }
            for (int j = 0; j < nu; ++j) {
                starts[nu * p + j] = next;
                for (const auto& [row_position, row] : column) {
                    for (int i = 0; i < nu; ++i) rows[next++] = nu * row_position + i;
                }
            }
        }
        starts.back() = next;
    }

    void scatter(const BlockMatrix& matrix, std::vector<double>& values) const {
        const BlockPattern& pattern = *matrix.pattern;
        values.resize(rows.size());
        for (int row = 0; row < pattern.n_blocks(); ++row) {
            for (int entry = pattern.row_start(row); entry < pattern.row_start(row + 1); ++entry) {
                const Mat6& block = matrix.values[entry];
                const int first_column = nu * position[pattern.column(entry)];
                for (int j = 0; j < nu; ++j) {
                    std::copy_n(block.data() + nu * j, nu, values.data() + starts[first_column + j] + offset[entry]);
                }
            }
        }
    }

    void permute(const Eigen::VectorXd& natural, std::vector<double>& permuted) const {
        permuted.resize(natural.size());
        for (std::size_t b = 0; b < position.size(); ++b) {
            std::copy_n(natural.data() + nu * b, nu, permuted.data() + nu * position[b]);
        }
    }

    void unpermute(const double* permuted, Eigen::VectorXd& natural) const {
        natural.resize(static_cast<Eigen::Index>(nu * position.size()));
        for (std::size_t b = 0; b < position.size(); ++b) {
            std::copy_n(permuted + nu * position[b], nu, natural.data() + nu * b);
        }
    }
};

} // namespace

struct LinearSolver::Backend {
    Backend() {
        cholmod_l_start(&common);
        common.itype = CHOLMOD_LONG;
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_NATURAL; // the matrix comes permuted
        common.postorder = 1;
        common.print = 0;
        common.error_handler = nullptr;
        umfpack_dl_defaults(control);
        control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
        control[UMFPACK_PRL] = 0;
        control[UMFPACK_IRSTEP] = 0; // Newton corrects
    }

    ~Backend() {
        forget();
        cholmod_l_finish(&common);
    }

    Backend(const Backend&) = delete;
    Backend& operator=(const Backend&) = delete;

    void forget() {
        cholmod_l_free_factor(&factor, &common);
        factor = nullptr;
        if (numeric != nullptr) umfpack_dl_free_numeric(&numeric);
        if (symbolic != nullptr) umfpack_dl_free_symbolic(&symbolic);
        numeric = nullptr;
        symbolic = nullptr;
    }

    cholmod_sparse cholmod_view() {
        cholmod_sparse view{};
        view.nrow = view.ncol = layout.starts.size() - 1;
        view.nzmax = layout.rows.size();
        view.p = layout.starts.data();
        view.i = layout.rows.data();
        view.x = values.data();
        view.stype = -1;
        view.itype = CHOLMOD_LONG;
        view.xtype = CHOLMOD_REAL;
        view.dtype = CHOLMOD_DOUBLE;
        view.sorted = 1;
        view.packed = 1;
        return view;
    }

    void require_cholmod_memory() const {
        if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) {
            throw ResourceError("out of memory in the factorization");
        }
    }

    bool factorize_cholesky() {
        cholmod_sparse matrix = cholmod_view();
        if (factor == nullptr) {
            factor = cholmod_l_analyze(&matrix, &common);
            require_cholmod_memory();
            if (factor == nullptr) return false;
        }
        cholmod_l_factorize(&matrix, factor, &common);
        require_cholmod_memory();
        return common.status == CHOLMOD_OK && factor->minor == factor->n;
    }

    bool factorize_lu() {
        const auto n = static_cast<SuiteSparse_long>(layout.starts.size()) - 1;
        if (symbolic == nullptr) {
            std::vector<SuiteSparse_long> identity(n);
            std::iota(identity.begin(), identity.end(), 0);
            const auto status = umfpack_dl_qsymbolic(n, n, layout.starts.data(), layout.rows.data(), values.data(),
                                                     identity.data(), &symbolic, control, info);
            if (status == UMFPACK_ERROR_out_of_memory) throw ResourceError("out of memory in the analysis");
            if (status != UMFPACK_OK) return false;
        }
        if (numeric != nullptr) umfpack_dl_free_numeric(&numeric);
        const auto status = umfpack_dl_numeric(layout.starts.data(), layout.rows.data(), values.data(), symbolic,
                                               &numeric, control, info);
        if (status == UMFPACK_ERROR_out_of_memory) throw ResourceError("out of memory in the factorization");
        return status == UMFPACK_OK;
    }

    cholmod_common common{};
    cholmod_factor* factor = nullptr;
    double control[UMFPACK_CONTROL]{};
    double info[UMFPACK_INFO]{};
    void* symbolic = nullptr;
    void* numeric = nullptr;
    ColumnLayout layout;
    std::vector<double> values;
    std::vector<double> right_side;
    std::vector<double> solution;
    Factorization kind = Factorization::cholesky;
    LinearSolverStatistics statistics;
};

LinearSolver::LinearSolver() : backend_(std::make_unique<Backend>()) {}
LinearSolver::~LinearSolver() = default;

namespace {

/// OpenBLAS maps its work space of 128 MB at its first use and tries for ever where the system refuses it.
/// Throws ResourceError instead.
void take_blas_work_space() {
    constexpr std::size_t work_space_bytes = 136U << 20U;
    static bool taken = false;
    if (taken) return;
    void* const space = mmap(nullptr, work_space_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (space == MAP_FAILED) throw ResourceError("out of memory: no address space for the work space of the BLAS");
    munmap(space, work_space_bytes);
    const int one = 1;
    const double a = 1.0;
    double x = 1.0;
    dtrsv_("L", "N", "N", &one, &a, &one, &x, &one);
    taken = true;
}

} // namespace

void LinearSolver::analyze(const BlockPattern& pattern) {
    take_blas_work_space();
    const auto start = std::chrono::steady_clock::now();
    backend_->forget();
    backend_->layout.build(pattern);
    ++backend_->statistics.analyses;
    backend_->statistics.analyze_seconds += seconds_since(start);
}

bool LinearSolver::factorize(const BlockMatrix& matrix, Factorization kind) {
    const auto start = std::chrono::steady_clock::now();
    backend_->layout.scatter(matrix, backend_->values);
    backend_->kind = kind;
    const bool done = kind == Factorization::cholesky ? backend_->factorize_cholesky() : backend_->factorize_lu();
    ++backend_->statistics.factorizations;
    backend_->statistics.factorize_seconds += seconds_since(start);
    return done;
}

void LinearSolver::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
    const auto start = std::chrono::steady_clock::now();
    Backend& k = *backend_;
    k.layout.permute(b, k.right_side);
    if (k.kind == Factorization::cholesky) {
        cholmod_dense view{};
        view.nrow = view.d = view.nzmax = k.right_side.size();
        view.ncol = 1;
        view.x = k.right_side.data();
        view.xtype = CHOLMOD_REAL;
        view.dtype = CHOLMOD_DOUBLE;
        cholmod_dense* result = cholmod_l_solve(CHOLMOD_A, k.factor, &view, &k.common);
        if (result == nullptr) throw ResourceError("out of memory in the solution");
        k.layout.unpermute(static_cast<const double*>(result->x), x);
        cholmod_l_free_dense(&result, &k.common);
    } else {
        k.solution.resize(k.right_side.size());
        umfpack_dl_solve(UMFPACK_A, k.layout.starts.data(), k.layout.rows.data(), k.values.data(), k.solution.data(),
                         k.right_side.data(), k.numeric, k.control, k.info);
        k.layout.unpermute(k.solution.data(), x);
    }
    k.statistics.solve_seconds += seconds_since(start);
}

const LinearSolverStatistics& LinearSolver::statistics() const { return backend_->statistics; }

FactorCost factor_cost(const BlockPattern& pattern) {
    ColumnLayout layout;
    layout.build(pattern);
    cholmod_common common{};
    cholmod_l_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.print = 0;
    cholmod_sparse view{};
    view.nrow = view.ncol = layout.starts.size() - 1;
    view.nzmax = layout.rows.size();
    view.p = layout.starts.data();
    view.i = layout.rows.data();
    view.stype = -1;
    view.itype = CHOLMOD_LONG;
    view.xtype = CHOLMOD_PATTERN;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    cholmod_factor* factor = cholmod_l_analyze(&view, &common);
    if (factor == nullptr) {
        cholmod_l_finish(&common);
        throw ResourceError("out of memory in the symbolic analysis");
    }
    const FactorCost cost{common.lnz, common.fl, 8.0 * static_cast<double>(factor->xsize)};
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_finish(&common);
    return cost;
}

void set_blas_threads(int n_threads) { openblas_set_num_threads(n_threads); }

} // namespace kluft

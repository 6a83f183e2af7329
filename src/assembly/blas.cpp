#include "kluft/assembly/blas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <random>
#include <ranges>
#include <string_view>
#include <vector>

#include <sys/mman.h>

#include "kluft/core/diagnostics.hpp"

// NOLINTBEGIN(readability-identifier-naming): names of the BLAS
extern "C" {
void openblas_set_num_threads(int n_threads);
int openblas_get_num_threads();
char* openblas_get_corename();
[[gnu::weak]] int blas_thread_shutdown_(); // a BLAS without threads has none
void* blas_memory_alloc(int which);
void blas_memory_free(void* space);
void omp_set_max_active_levels(int n_levels);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n,
            const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void dgemm_(const char* trans_a, const char* trans_b, const int* m, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta, double* c,
            const int* ldc);
void dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* a, const int* lda,
            const double* x, const int* incx, const double* beta, double* y, const int* incy);
void sgemm_(const char* trans_a, const char* trans_b, const int* m, const int* n, const int* k, const float* alpha,
            const float* a, const int* lda, const float* b, const int* ldb, const float* beta, float* c,
            const int* ldc);
void ssyrk_(const char* uplo, const char* trans, const int* n, const int* k, const float* alpha, const float* a,
            const int* lda, const float* beta, float* c, const int* ldc);
}
// NOLINTEND(readability-identifier-naming)

namespace kluft {

namespace {

/// True if the kernels of a core of OpenBLAS 0.3 use the vectors of four numbers, or of eight, of x86-64. Eight are no faster
/// in a run than four (50 000 blocks: factorization within 5 %).
bool has_wide_kernels(std::string_view core) {
    constexpr std::array<std::string_view, 6> wide = {"Haswell",  "Zen",        "Excavator",
                                                      "SkylakeX", "Cooperlake", "SapphireRapids"};
    return std::ranges::find(wide, core) != wide.end();
}

bool has_room_for_work_spaces(int n) {
    const std::size_t bytes = static_cast<std::size_t>(n) * (136U << 20U);
    void* const space = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (space == MAP_FAILED) return false;
    munmap(space, bytes);
    return true;
}

constexpr int max_own_threads = 32;
std::mutex own_threads_mutex;
int n_own_threads = 0;       ///< how many exist
int threads_before = 1;      ///< of the BLAS, before the first of them
bool has_no_threads = false; ///< of the BLAS itself: they have been ended

/// A BLAS whose threads have been ended would start them again.
void give_blas(int n_threads) {
    if (!has_no_threads) openblas_set_num_threads(n_threads);
}

/// The place of an entry of an n x n matrix that is stored by columns.
std::size_t place(int n, int row, int column) {
    return static_cast<std::size_t>(n) * static_cast<std::size_t>(column) + static_cast<std::size_t>(row);
}

std::vector<double> random_matrix(int n, std::mt19937& random) {
    std::vector<double> matrix(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    for (double& each : matrix) each = static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 0.5;
    return matrix;
}

/// C - A B by plain loops, or C - L B with the lower triangle L of A; largest entry.
double largest_difference(int n, const std::vector<double>& a, const std::vector<double>& b,
                          const std::vector<double>& c, bool lower) {
    double largest = 0.0;
    for (int column = 0; column < n; ++column) {
        for (int row = 0; row < n; ++row) {
            double sum = 0.0;
            const int n_terms = lower ? row + 1 : n;
            for (int k = 0; k < n_terms; ++k) sum += a[place(n, row, k)] * b[place(n, k, column)];
            const double difference = std::abs(c[place(n, row, column)] - sum);
            if (!(difference <= largest)) largest = difference;
        }
    }
    return largest;
}

/// The same of products in single precision, -A B' and the lower triangle of -A A'.
bool single_products_are_right(int n, const std::vector<double>& a, const std::vector<double>& b) {
    constexpr double roundoff = 1e-5;
    const std::vector<float> single_a(a.begin(), a.end());
    const std::vector<float> single_b(b.begin(), b.end());
    std::vector<float> product(a.size());
    std::vector<float> square(a.size());
    subtract_product(n, n, n, single_a.data(), n, single_b.data(), n, product.data(), n);
    subtract_square(n, n, single_a.data(), n, square.data(), n);
    for (int column = 0; column < n; ++column) {
        for (int row = column; row < n; ++row) {
            double of_both = product[place(n, row, column)];
            double of_a = square[place(n, row, column)];
            for (int k = 0; k < n; ++k) {
                of_both += a[place(n, row, k)] * b[place(n, column, k)];
                of_a += a[place(n, row, k)] * a[place(n, column, k)];
            }
            if (!(std::abs(of_both) < n * roundoff && std::abs(of_a) < n * roundoff * n)) return false;
        }
    }
    return true;
}

} // namespace

void solve_lower_triangle(int n, int width, const double* l, int ldl, double* x, int ldx) {
    const double one = 1.0;
    dtrsm_("L", "L", "N", "N", &n, &width, &one, l, &ldl, x, &ldx);
}

void multiply(int m, int n, int k, const double* a, int lda, const double* b, int ldb, double* c, int ldc) {
    const double one = 1.0;
    const double zero = 0.0;
    dgemm_("N", "N", &m, &n, &k, &one, a, &lda, b, &ldb, &zero, c, &ldc);
}

void multiply_transposed(int m, int n, const double* a, int lda, const double* x, double* y) {
    const double one = 1.0;
    const double zero = 0.0;
    const int next = 1;
    dgemv_("T", &m, &n, &one, a, &lda, x, &next, &zero, y, &next);
}

void multiply(int m, int n, const double* a, int lda, const double* x, double* y) {
    const double one = 1.0;
    const double zero = 0.0;
    const int next = 1;
    dgemv_("N", &m, &n, &one, a, &lda, x, &next, &zero, y, &next);
}

void subtract_product(int m, int n, int k, const float* a, int lda, const float* b, int ldb, float* c, int ldc) {
    const float one = 1.0F;
    const float minus_one = -1.0F;
    sgemm_("N", "T", &m, &n, &k, &minus_one, a, &lda, b, &ldb, &one, c, &ldc);
}

void subtract_square(int n, int k, const float* a, int lda, float* c, int ldc) {
    const float one = 1.0F;
    const float minus_one = -1.0F;
    ssyrk_("L", "N", &n, &k, &minus_one, a, &lda, &one, c, &ldc);
}

void prepare_blas() {
    // CHOLMOD's own loops ask for four threads whatever the number of processors, to move a few numbers each: without
    // them a factorization takes half the time at 600 blocks, three quarters at 50 000.
    omp_set_max_active_levels(0);
    static bool taken = false;
    if (taken) return;
    if (!has_room_for_work_spaces(1))
        throw ResourceError("out of memory: no address space for the work space of the BLAS");
    const double a = 1.0;
    double x = 1.0;
    solve_lower_triangle(1, 1, &a, 1, &x, 1);
    taken = true;
}

OwnThreads::OwnThreads(int n_threads) {
    const std::lock_guard lock(own_threads_mutex);
    if (n_own_threads++ == 0 && !has_no_threads) threads_before = openblas_get_num_threads();
    give_blas(1);
    number_ = std::clamp(n_threads, 1, max_own_threads);
    if (number_ > 1 && !has_room_for_work_spaces(number_)) number_ = 1;
    if (number_ == 1) return;
    std::array<void*, max_own_threads> spaces{};
    for (int i = 0; i < number_; ++i) spaces[i] = blas_memory_alloc(0); // all at once, or it would be the same one
    for (int i = 0; i < number_; ++i) blas_memory_free(spaces[i]);
}

OwnThreads::~OwnThreads() {
    const std::lock_guard lock(own_threads_mutex);
    if (--n_own_threads == 0) give_blas(threads_before);
}

bool end_blas_threads() {
    const std::lock_guard lock(own_threads_mutex);
    if (has_no_threads) return true;
    const int n_threads = openblas_get_num_threads(); // with that of the program
    if (n_threads > 1 && !has_room_for_work_spaces(n_threads)) return false;
    if (n_own_threads == 0) threads_before = n_threads;
    openblas_set_num_threads(1);
    if (blas_thread_shutdown_ != nullptr) blas_thread_shutdown_();
    has_no_threads = true;
    return true;
}

void set_blas_threads(int n_threads) {
    const std::lock_guard lock(own_threads_mutex);
    threads_before = n_threads;
    if (n_own_threads == 0) give_blas(n_threads);
}

int blas_threads() {
    const std::lock_guard lock(own_threads_mutex);
    return n_own_threads == 0 && !has_no_threads ? openblas_get_num_threads() : threads_before;
}

std::string blas_core() { return openblas_get_corename(); }

std::string wider_blas_core() {
#if defined(__x86_64__)
    const bool has_vectors_of_four = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    if (has_vectors_of_four && !has_wide_kernels(blas_core())) return "Haswell";
#endif
    return {};
}

bool blas_computes_rightly() {
    prepare_blas();
    constexpr double roundoff = 1e-12; // of sums of some hundred products below one; solutions grow to some 1e2
    std::mt19937 random;
    for (const int n : {3, 6, 17, 40, 128}) {
        std::vector<double> a = random_matrix(n, random);
        for (int k = 0; k < n; ++k) a[place(n, k, k)] += n; // far from singular
        const std::vector<double> b = random_matrix(n, random);
        std::vector<double> c(a.size());
        multiply(n, n, n, a.data(), n, b.data(), n, c.data(), n);
        if (!(largest_difference(n, a, b, c, false) < n * roundoff)) return false;
        std::vector<double> x = b;
        solve_lower_triangle(n, n, a.data(), n, x.data(), n);
        if (!(largest_difference(n, a, x, b, true) < n * roundoff)) return false;
        if (!single_products_are_right(n, a, b)) return false;
    }
    return true;
}

} // namespace kluft

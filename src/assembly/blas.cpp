#include "kluft/assembly/blas.hpp"

#include <cstddef>

#include <sys/mman.h>

#include "kluft/core/diagnostics.hpp"

// NOLINTBEGIN(readability-identifier-naming): names of the BLAS
extern "C" {
void openblas_set_num_threads(int n_threads);
void omp_set_max_active_levels(int n_levels);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n,
            const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void dgemm_(const char* trans_a, const char* trans_b, const int* m, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta, double* c,
            const int* ldc);
void dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* a, const int* lda,
            const double* x, const int* incx, const double* beta, double* y, const int* incy);
}
// NOLINTEND(readability-identifier-naming)

namespace kluft {

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

void prepare_blas() {
    // CHOLMOD's own loops ask for four threads whatever the number of processors, to move a few numbers each: without
    // them a factorization takes half the time at 600 blocks, three quarters at 50 000.
    omp_set_max_active_levels(0);
    constexpr std::size_t work_space_bytes = 136U << 20U;
    static bool taken = false;
    if (taken) return;
    void* const space = mmap(nullptr, work_space_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (space == MAP_FAILED) throw ResourceError("out of memory: no address space for the work space of the BLAS");
    munmap(space, work_space_bytes);
    const double a = 1.0;
    double x = 1.0;
    solve_lower_triangle(1, 1, &a, 1, &x, 1);
    taken = true;
}

void set_blas_threads(int n_threads) { openblas_set_num_threads(n_threads); }

} // namespace kluft

// The few routines of the BLAS that Kluft calls itself, on matrices stored by columns.
#pragma once

#include <string>

namespace kluft {

/// X := L^-1 X with the lower triangle L (n x n, leading dimension ldl); X has n rows and `width` columns.
void solve_lower_triangle(int n, int width, const double* l, int ldl, double* x, int ldx);

/// C := A B; A is m x k, B is k x n.
void multiply(int m, int n, int k, const double* a, int lda, const double* b, int ldb, double* c, int ldc);

/// y := A' x and y := A x; A is m x n.
void multiply_transposed(int m, int n, const double* a, int lda, const double* x, double* y);
void multiply(int m, int n, const double* a, int lda, const double* x, double* y);

/// C := C - A B' and the lower triangle of C := C - A A', in single precision; A is m x k, B is n x k, C m x n.
void subtract_product(int m, int n, int k, const float* a, int lda, const float* b, int ldb, float* c, int ldc);
void subtract_square(int n, int k, const float* a, int lda, float* c, int ldc);

/// To be called before the first use. The BLAS maps its work space then and tries for ever where the system refuses it:
/// takes it now. Leaves all threads to the BLAS. Throws ResourceError out of memory.
void prepare_blas();

/// While one exists, each call of the BLAS is computed by the thread that calls. Threads that call at the same time then need
/// a work space each: they are taken here, for as many threads as asked for, or fewer.
class OwnThreads {
public:
    explicit OwnThreads(int n_threads);
    ~OwnThreads();
    OwnThreads(const OwnThreads&) = delete;
    OwnThreads& operator=(const OwnThreads&) = delete;

    /// For how many threads there is a work space; at least one.
    [[nodiscard]] int number() const { return number_; }

private:
    int number_ = 1;
};

/// For a program, at its start: ends the threads that OpenBLAS starts when it is loaded. They wait for work in a loop, a tenth
/// of a second of processor time, and a run gives them none. From then on each call of the BLAS is computed by the thread that
/// calls; blas_threads() stays what it was. False, and nothing is done, where there is no address space for their work spaces: they
/// try for ever to take it, and OpenBLAS waits for them before it starts another process (fork) and at the end of the program.
[[nodiscard]] bool end_blas_threads();

/// Number of threads for the whole process: of a large factorization, and of the BLAS (OpenBLAS) where there are no OwnThreads
/// and its own have not been ended.
void set_blas_threads(int n_threads);
[[nodiscard]] int blas_threads();

/// The processor for which the kernels in use were written, by OpenBLAS's name, e.g. "Haswell".
[[nodiscard]] std::string blas_core();

/// The core of OpenBLAS whose kernels use the vectors of this processor, where those in use do not; "" where they do. OpenBLAS
/// chooses its kernels when it is loaded, and takes old ones for a processor that is younger than itself; another choice
/// needs OPENBLAS_CORETYPE in the environment of a new start.
[[nodiscard]] std::string wider_blas_core();

/// True if products and triangular solutions agree with plain loops up to round-off, for matrices of several sizes. Throws
/// ResourceError out of memory.
[[nodiscard]] bool blas_computes_rightly();

} // namespace kluft

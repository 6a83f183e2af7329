#include "blas_threads.hpp"

#include <cstdlib>

#include <unistd.h>

#include "kluft/assembly/blas.hpp"
#include "kluft/core/diagnostics.hpp"

namespace kluft {

void do_without_blas_threads(char** words) {
    if (end_blas_threads()) return;
    setenv("OPENBLAS_NUM_THREADS", "1", 1);
    execv("/proc/self/exe", words);
    throw ResourceError("out of memory: no address space for the work spaces of the threads of the BLAS");
}

} // namespace kluft

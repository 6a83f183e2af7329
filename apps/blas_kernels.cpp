#include "blas_kernels.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

#include <unistd.h>

#include "kluft/assembly/blas.hpp"

namespace kluft {

namespace {

constexpr const char* chosen_core = "OPENBLAS_CORETYPE";
constexpr const char* own_core = "KLUFT_OWN_BLAS_CORE"; ///< of the second start: what the BLAS would choose itself

void start_again_with(const std::string& core, char** words) {
    setenv(chosen_core, core.c_str(), 1);
    execv("/proc/self/exe", words);
    unsetenv(chosen_core); // it goes on as it is
    unsetenv(own_core);
}

} // namespace

void choose_blas_kernels(char** words) {
    if (const char* const own = std::getenv(own_core)) {
        if (blas_computes_rightly()) return;
        const std::string core = own;
        std::fprintf(stderr,
                     "warning: the BLAS's kernels for %s compute wrongly on this processor; those for %s are used\n",
                     blas_core().c_str(), core.c_str());
        unsetenv(own_core);
        return start_again_with(core, words);
    }
    if (std::getenv(chosen_core) != nullptr) return;
    const std::string wider = wider_blas_core();
    if (wider.empty()) return;
    setenv(own_core, blas_core().c_str(), 1);
    start_again_with(wider, words);
}

} // namespace kluft

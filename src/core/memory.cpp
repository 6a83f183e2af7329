#include "kluft/core/memory.hpp"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace kluft {

void return_freed_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void return_large_pieces() {
#ifdef __GLIBC__
    constexpr int large = 1 << 20;
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_TRIM_THRESHOLD, large);
#endif
}

} // namespace kluft

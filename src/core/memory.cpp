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

} // namespace kluft

#include "kluft/core/memory.hpp"

#include <atomic>
#include <cstdint>
#include <cstdlib>

#include <sys/mman.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "kluft/core/diagnostics.hpp"

namespace kluft {

namespace {

std::atomic<bool> lacks_memory{false};

/// On the whole pages of a large piece of memory.
[[maybe_unused]] void advise(void* begin, std::size_t size, int advice) {
    constexpr std::size_t large = 8U << 20U;
    if (size < large) return;
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const std::uintptr_t skipped = (page - reinterpret_cast<std::uintptr_t>(begin) % page) % page;
    madvise(static_cast<char*>(begin) + skipped, (size - skipped) / page * page, advice);
}

} // namespace

void return_freed_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void return_large_pieces() {
#ifdef __GLIBC__
    constexpr int large = 1 << 22; // contacts detected anew took a third of the time of a wall of 1 021 bricks below it
    constexpr int kept = 1 << 24;  // a wall of 1 021 bricks took a tenth of its time to get back what it had just given
    mallopt(M_MMAP_THRESHOLD, large);
    mallopt(M_TRIM_THRESHOLD, kept);
#endif
}

void prefer_huge_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t size) {
#ifdef MADV_HUGEPAGE
    advise(begin, size, MADV_HUGEPAGE);
#endif
}

void give_back_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t size) {
#ifdef MADV_DONTNEED
    advise(begin, size, MADV_DONTNEED);
#endif
}

void note_lack_of_memory() noexcept { lacks_memory = true; }
bool memory_ran_out() noexcept { return lacks_memory; }
void require_memory() {
    if (memory_ran_out()) throw ResourceError("out of memory");
}

} // namespace kluft

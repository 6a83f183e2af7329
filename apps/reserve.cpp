// The program's own malloc: that of the C library, and where this finds no memory, a reserve that is part of the
// program. Libraries that end the program, wait for ever or forget what they hold when an allocation fails then never see
// one fail, and a run has what it needs to save its last state; it ends as soon as it asks whether memory_ran_out().
// Large pieces are not taken from the reserve: their allocation fails as ever.
#include <cstdlib>

#ifdef __GLIBC__

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <utility>

#include <dlfcn.h>

#include "kluft/core/memory.hpp"

namespace {

constexpr std::size_t reserve_bytes = 64U << 20U; ///< of address space; pages count when they are written
constexpr std::size_t largest_piece = 1U << 20U;
constexpr std::size_t least_piece = 32;
constexpr std::size_t alignment = alignof(std::max_align_t);

alignas(alignment)
    std::byte room[reserve_bytes]; // NOLINT(modernize-avoid-c-arrays): it costs no space in the program's file

/// Before each piece of the reserve.
struct alignas(alignment) Head {
    std::size_t size;   ///< of the room behind it: a power of two, or 0 of one that is not used again
    std::size_t usable; ///< bytes behind it
};

class SpinLock {
public:
    void lock() {
        while (taken_.test_and_set(std::memory_order_acquire)) {
        }
    }
    void unlock() { taken_.clear(std::memory_order_release); }

private:
    std::atomic_flag taken_;
};

/// Pieces of powers of two; those that are given back are linked by their first bytes.
class Reserve {
public:
    [[nodiscard]] bool owns(const void* memory) const {
        const auto at = reinterpret_cast<std::uintptr_t>(memory);
        const auto begin = reinterpret_cast<std::uintptr_t>(room);
        return at - begin < reserve_bytes;
    }

    /// Null where nothing is left, or for a large piece.
    void* take(std::size_t size) {
        if (size > largest_piece) return nullptr;
        const std::size_t rounded = std::bit_ceil(std::max(size, least_piece));
        const std::lock_guard lock(lock_);
        void*& first = free_[std::countr_zero(rounded)];
        if (first != nullptr) return std::exchange(first, *static_cast<void**>(first));
        if (reserve_bytes - used_ < sizeof(Head) + rounded) return nullptr;
        std::byte* const at = room + used_;
        used_ += sizeof(Head) + rounded;
        *reinterpret_cast<Head*>(at) = {rounded, rounded};
        return at + sizeof(Head);
    }

    /// A piece whose address is a multiple of `step`; it is not used again.
    void* take_aligned(std::size_t step, std::size_t size) {
        if (step > largest_piece) return nullptr;
        auto* const piece = static_cast<std::byte*>(take(size + step));
        if (piece == nullptr) return nullptr;
        const auto over = reinterpret_cast<std::uintptr_t>(piece) % step;
        if (over == 0) return piece;
        std::byte* const at = piece + (step - over);
        *head(at) = {0, usable(piece) - (step - over)};
        return at;
    }

    void give_back(void* memory) {
        const std::size_t size = head(memory)->size;
        if (size == 0) return;
        const std::lock_guard lock(lock_);
        void*& first = free_[std::countr_zero(size)];
        *static_cast<void**>(memory) = std::exchange(first, memory);
    }

    [[nodiscard]] static std::size_t usable(void* memory) { return head(memory)->usable; }

private:
    static Head* head(void* memory) { return static_cast<Head*>(memory) - 1; }

    std::size_t used_ = 0;
    std::array<void*, 8 * sizeof(std::size_t)> free_{}; ///< by the exponent of the size
    SpinLock lock_;
};

// Of static storage and zero before any code runs: memory is asked for before anything is constructed.
constinit Reserve reserve{};

/// The allocator that would have been called without this one.
struct Allocator {
    void* (*malloc)(std::size_t);
    void* (*calloc)(std::size_t, std::size_t);
    void* (*realloc)(void*, std::size_t);
    void* (*memalign)(std::size_t, std::size_t);
    void (*free)(void*);
    std::size_t (*usable)(void*);
};

template <class Function> void find(Function& function, const char* name) {
    function = reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Null while it is looked for, which may ask for memory itself; that is before there are threads.
const Allocator* library() {
    static constinit Allocator found{};
    static constinit enum { unknown, looking, known } state = unknown;
    if (state == known) return &found;
    if (state == looking) return nullptr;
    state = looking;
    find(found.malloc, "malloc");
    find(found.calloc, "calloc");
    find(found.realloc, "realloc");
    find(found.memalign, "memalign");
    find(found.free, "free");
    find(found.usable, "malloc_usable_size");
    state = known;
    return &found;
}

/// What a call of the library has found, or a piece of the reserve.
template <class Take> void* or_of_reserve(void* found, Take take) {
    if (found != nullptr) return found;
    void* const piece = take();
    if (piece == nullptr)
        errno = ENOMEM;
    else if (library() != nullptr)
        kluft::note_lack_of_memory();
    return piece;
}

void* moved_to_reserve(void* old, std::size_t size, std::size_t old_size) {
    void* const piece = reserve.take(size);
    if (piece != nullptr) std::memcpy(piece, old, std::min(size, old_size));
    return piece;
}

} // namespace

// NOLINTBEGIN(readability-identifier-naming, readability-inconsistent-declaration-parameter-name): names of the C library
extern "C" {

void* malloc(std::size_t size) noexcept {
    const Allocator* const c = library();
    return or_of_reserve(c != nullptr ? c->malloc(size) : nullptr, [&] { return reserve.take(size); });
}

void* calloc(std::size_t count, std::size_t size) noexcept {
    const Allocator* const c = library();
    return or_of_reserve(c != nullptr ? c->calloc(count, size) : nullptr, [&]() -> void* {
        if (size != 0 && count > largest_piece / size) return nullptr;
        void* const piece = reserve.take(count * size);
        return piece == nullptr ? piece : std::memset(piece, 0, count * size);
    });
}

void free(void* memory) noexcept {
    if (reserve.owns(memory)) return reserve.give_back(memory);
    if (const Allocator* const c = library()) c->free(memory);
}

void* realloc(void* old, std::size_t size) noexcept {
    if (old == nullptr) return malloc(size);
    if (reserve.owns(old)) {
        if (size <= Reserve::usable(old)) return old;
        void* const fresh = malloc(size);
        if (fresh == nullptr) return nullptr;
        std::memcpy(fresh, old, Reserve::usable(old));
        reserve.give_back(old);
        return fresh;
    }
    const Allocator& c = *library();
    void* const found = c.realloc(old, size);
    if (found != nullptr || size == 0) return found;
    return or_of_reserve(nullptr, [&] {
        void* const piece = moved_to_reserve(old, size, c.usable(old));
        if (piece != nullptr) c.free(old);
        return piece;
    });
}

void* memalign(std::size_t step, std::size_t size) noexcept {
    const Allocator* const c = library();
    return or_of_reserve(c != nullptr ? c->memalign(step, size) : nullptr,
                         [&] { return reserve.take_aligned(step, size); });
}

void* aligned_alloc(std::size_t step, std::size_t size) noexcept { return memalign(step, size); }

int posix_memalign(void** memory, std::size_t step, std::size_t size) noexcept {
    if (!std::has_single_bit(step) || step % sizeof(void*) != 0) return EINVAL;
    const int before = errno;
    void* const piece = memalign(step, size);
    errno = before;
    if (piece == nullptr) return ENOMEM;
    *memory = piece;
    return 0;
}

std::size_t malloc_usable_size(void* memory) noexcept {
    if (reserve.owns(memory)) return Reserve::usable(memory);
    const Allocator* const c = library();
    return c != nullptr && memory != nullptr ? c->usable(memory) : 0;
}

} // extern "C"
// NOLINTEND(readability-identifier-naming, readability-inconsistent-declaration-parameter-name)

#endif

/* Preloaded into a program (LD_PRELOAD), it lets allocations of memory fail as they do where there is none left.
 *
 *   KLUFT_FAIL_AT=N      the N-th allocation of the process fails (1: the first)
 *   KLUFT_FAIL_FOR=K     so do the K - 1 after it (default 1); 0: all after it
 *   KLUFT_FAIL_ABOVE=B   those fail that would let the process hold more than B bytes
 *   KLUFT_FAIL_COUNT=F   appends the number of allocations to the file F when the process ends
 *   KLUFT_FAIL_TRACE=F   appends the calls that led to the first failure to the file F
 *
 * Operator new of the standard library takes its memory from malloc, so that it fails too; mmap does not.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* The allocator of the GNU C library by its own names. */
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);

static atomic_long n_allocations;
static atomic_long bytes_held;
static atomic_int n_traces;
static long fail_at, fail_for = 1, fail_above;
static const char *count_file, *trace_file;

static long number(const char* name, long otherwise) {
    const char* const text = getenv(name);
    return text == NULL ? otherwise : atol(text);
}

__attribute__((constructor)) static void begin(void) {
    void* frame;
    backtrace(&frame, 1); /* takes its memory now */
    count_file = getenv("KLUFT_FAIL_COUNT");
    trace_file = getenv("KLUFT_FAIL_TRACE");
    fail_for = number("KLUFT_FAIL_FOR", 1);
    fail_above = number("KLUFT_FAIL_ABOVE", 0);
    atomic_store(&n_allocations, 0);
    fail_at = number("KLUFT_FAIL_AT", 0);
}

__attribute__((destructor)) static void end(void) {
    if (count_file == NULL) return;
    const int file = open(count_file, O_WRONLY | O_CREAT | O_APPEND, 0644);
    dprintf(file, "%ld\n", atomic_load(&n_allocations));
    close(file);
}

static void trace(void) {
    if (trace_file == NULL || atomic_fetch_add(&n_traces, 1) > 0) return;
    void* frames[60];
    const int n = backtrace(frames, 60);
    const int file = open(trace_file, O_WRONLY | O_CREAT | O_APPEND, 0644);
    backtrace_symbols_fd(frames, n, file);
    close(file);
}

/* Whether the next allocation is to fail. */
static int fails(size_t size) {
    const long n = atomic_fetch_add(&n_allocations, 1) + 1;
    const int chosen = fail_at > 0 && n >= fail_at && (fail_for == 0 || n < fail_at + fail_for);
    const int too_much = fail_above > 0 && atomic_load(&bytes_held) + (long)size > fail_above;
    if (!chosen && !too_much) return 0;
    trace();
    errno = ENOMEM;
    return 1;
}

static void* held(void* memory) {
    if (fail_above > 0 && memory != NULL) atomic_fetch_add(&bytes_held, (long)malloc_usable_size(memory));
    return memory;
}

static void let_go(void* memory) {
    if (fail_above > 0 && memory != NULL) atomic_fetch_sub(&bytes_held, (long)malloc_usable_size(memory));
}

void* malloc(size_t size) { return fails(size) ? NULL : held(__libc_malloc(size)); }

void* calloc(size_t count, size_t size) { return fails(count * size) ? NULL : held(__libc_calloc(count, size)); }

void* realloc(void* old, size_t size) {
    if (size > 0 && fails(size)) return NULL;
    let_go(old);
    return held(__libc_realloc(old, size));
}

void* memalign(size_t alignment, size_t size) { return fails(size) ? NULL : held(__libc_memalign(alignment, size)); }

void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }

int posix_memalign(void** memory, size_t alignment, size_t size) {
    void* const piece = memalign(alignment, size);
    if (piece == NULL) return ENOMEM;
    *memory = piece;
    return 0;
}

void free(void* memory) {
    let_go(memory);
    __libc_free(memory);
}

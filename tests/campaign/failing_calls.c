/* Preloaded into a program (LD_PRELOAD), it lets system calls on files fail as they do on a full or broken disk, or kills the
 * program there.
 *
 *   KLUFT_CALL=NAME        the calls that count: write, fsync, rename, close, ftruncate, open (of a file to be written) or any
 *   KLUFT_CALL_BELOW=PATH  only those on files whose absolute path begins so
 *   KLUFT_CALL_AT=N        the N-th of them fails (1: the first)
 *   KLUFT_CALL_FOR=K       so do the K - 1 after it (default 1); 0: all after it
 *   KLUFT_CALL_ERRNO=E     with this error (default ENOSPC); 0: the program is killed instead
 *   KLUFT_CALL_HALF=1      a write that fails writes the first half
 *   KLUFT_CALL_COUNT=F     appends the number of calls to the file F when the process ends
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static atomic_long n_calls;

static long number(const char* name, long otherwise) {
    const char* const text = getenv(name);
    return text == NULL ? otherwise : atol(text);
}

static int is_below(const char* path) {
    const char* const place = getenv("KLUFT_CALL_BELOW");
    char whole[8192];
    if (path[0] != '/' && getcwd(whole, 4000) != NULL) {
        strcat(whole, "/");
        path = strncat(whole, path, 4000);
    }
    return place == NULL || strncmp(path, place, strlen(place)) == 0;
}

static int is_of(int descriptor) {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t n = readlink(link, path, sizeof path - 1);
    if (n < 0) return 0;
    path[n] = 0;
    return is_below(path);
}

/* Whether this call is to fail; errno says how. */
static int fails(const char* call, int concerned) {
    const char* const chosen = getenv("KLUFT_CALL");
    if (!concerned || chosen == NULL || (strcmp(chosen, call) != 0 && strcmp(chosen, "any") != 0)) return 0;
    const long n = atomic_fetch_add(&n_calls, 1) + 1, at = number("KLUFT_CALL_AT", 0), how_many = number("KLUFT_CALL_FOR", 1);
    if (at == 0 || n < at || (how_many > 0 && n >= at + how_many)) return 0;
    errno = (int)number("KLUFT_CALL_ERRNO", ENOSPC);
    return 1;
}

/* What a call that fails returns, unless the program ends here. */
static int failure(void) {
    if (errno == 0) kill(getpid(), SIGKILL);
    return -1;
}

__attribute__((destructor)) static void tell(void) {
    const char* const path = getenv("KLUFT_CALL_COUNT");
    const int file = path == NULL ? -1 : REAL(open)(path, O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (file < 0) return;
    dprintf(file, "%ld\n", atomic_load(&n_calls));
    REAL(close)(file);
}

ssize_t write(int descriptor, const void* bytes, size_t n) {
    if (!fails("write", is_of(descriptor))) return REAL(write)(descriptor, bytes, n);
    const int error = errno;
    const int half = number("KLUFT_CALL_HALF", 0) && n > 1;
    const ssize_t written = half ? REAL(write)(descriptor, bytes, n / 2) : -1;
    errno = error;
    return half && error != 0 ? written : failure();
}

ssize_t writev(int descriptor, const struct iovec* pieces, int n) {
    return fails("write", is_of(descriptor)) ? failure() : REAL(writev)(descriptor, pieces, n);
}

int fsync(int descriptor) { return fails("fsync", is_of(descriptor)) ? failure() : REAL(fsync)(descriptor); }

int ftruncate(int descriptor, off_t size) {
    return fails("ftruncate", is_of(descriptor)) ? failure() : REAL(ftruncate)(descriptor, size);
}

int rename(const char* from, const char* to) { return fails("rename", is_below(to)) ? failure() : REAL(rename)(from, to); }

int close(int descriptor) {
    if (!fails("close", is_of(descriptor))) return REAL(close)(descriptor);
    const int error = errno;
    REAL(close)(descriptor);
    errno = error;
    return failure();
}

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = (flags & O_CREAT) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    return fails("open", (flags & O_CREAT) && is_below(path)) ? failure() : REAL(open)(path, flags, mode);
}

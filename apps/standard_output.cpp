#include "standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace kluft {

namespace {

int first_reason = 0; ///< of what could not be written

void note_result(bool written) {
    if (!written && first_reason == 0) first_reason = errno;
}

} // namespace

void say_text(const std::string& text) { note_result(std::fwrite(text.data(), 1, text.size(), stdout) == text.size()); }

void tell_text(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

std::string lost_output() {
    note_result(std::fflush(stdout) == 0);
    if (first_reason == 0 || first_reason == EPIPE) return {};
    return "standard output: cannot write: " + std::generic_category().message(first_reason);
}

void open_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        const bool is_closed = fcntl(stream, F_GETFD) < 0 && errno == EBADF;
        if (is_closed) (void)open("/dev/null", O_RDWR); // the lowest free number is this one
    }
}

} // namespace kluft

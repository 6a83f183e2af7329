#include "stop_request.hpp"

#include <csignal>

namespace kluft {

std::atomic<bool> stop_requested{false};

namespace {

std::atomic<int> first_signal{SIGINT};

void request_stop(int signal) {
    if (!stop_requested.exchange(true)) first_signal = signal;
}

/// What was blocked when this program was started.
sigset_t blocked_at_start;

/// Runs before the libraries start threads of their own, which inherit what is blocked.
void block_termination() {
    sigset_t termination;
    sigemptyset(&termination);
    sigaddset(&termination, SIGTERM);
    sigprocmask(SIG_BLOCK, &termination, &blocked_at_start);
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = block_termination;

} // namespace

void take_termination() { sigprocmask(SIG_SETMASK, &blocked_at_start, nullptr); }

void listen_for_stop() {
    for (const int signal : {SIGINT, SIGTERM})
        std::signal(signal, request_stop); // scripts start children without SIGINT
    for (const int signal : {SIGHUP, SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM})
        if (std::signal(signal, request_stop) == SIG_IGN) std::signal(signal, SIG_IGN);
}

ExitCode exit_code_of_stop() {
    constexpr int of_signals = 128;
    return static_cast<ExitCode>(of_signals + first_signal);
}

void leave_writing_to_its_result() {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

} // namespace kluft

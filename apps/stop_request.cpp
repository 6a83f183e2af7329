#include "stop_request.hpp"

#include <csignal>

#include <unistd.h>

namespace kluft {

std::atomic<bool> stop_requested{false};

namespace {

std::atomic<int> first_signal{SIGINT};

void request_stop(int signal) {
    if (!stop_requested.exchange(true)) first_signal = signal;
}

/// What was blocked when this program was started, and what became of SIGINT.
sigset_t blocked_at_start;
struct sigaction interrupt_at_start;

/// OpenBLAS interrupts its own process where it cannot start its threads.
void tell_missing_threads(int signal, siginfo_t* information, void* /*context*/) {
    if (information->si_pid == getpid()) {
        constexpr char message[] = "out of memory: no room for the threads of the BLAS\n";
        (void)!write(STDERR_FILENO, message, sizeof message - 1);
        _exit(static_cast<int>(ExitCode::out_of_resources));
    }
    sigaction(SIGINT, &interrupt_at_start, nullptr); // from outside: as if nobody had listened
    raise(signal);
}

/// Runs before the libraries start threads of their own, which inherit what is blocked.
void prepare_for_libraries() {
    sigset_t termination;
    sigemptyset(&termination);
    sigaddset(&termination, SIGTERM);
    sigprocmask(SIG_BLOCK, &termination, &blocked_at_start);
    struct sigaction action {};
    action.sa_sigaction = tell_missing_threads;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGINT, &action, &interrupt_at_start);
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = prepare_for_libraries;

} // namespace

void take_signals() {
    sigaction(SIGINT, &interrupt_at_start, nullptr);
    sigprocmask(SIG_SETMASK, &blocked_at_start, nullptr);
}

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

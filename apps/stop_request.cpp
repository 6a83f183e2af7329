#include "stop_request.hpp"

#include <csignal>

namespace kluft {

std::atomic<bool> stop_requested{false};

namespace {

std::atomic<int> first_signal{SIGINT};

void request_stop(int signal) {
    if (!stop_requested.exchange(true)) first_signal = signal;
}

} // namespace

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

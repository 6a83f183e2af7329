#include "stop_request.hpp"

#include <csignal>

namespace kluft {

std::atomic<bool> stop_requested{false};

void listen_for_stop() {
    const auto request_stop = [](int) { stop_requested = true; };
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow is a full disk: the write fails
}

} // namespace kluft

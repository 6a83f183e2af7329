// Ctrl-C and SIGTERM.
#pragma once

#include <atomic>

namespace kluft {

/// Whether the user has asked to stop since `listen_for_stop`.
extern std::atomic<bool> stop_requested;

/// From now on SIGINT and SIGTERM set `stop_requested`.
void listen_for_stop();

} // namespace kluft

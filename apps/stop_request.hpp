// Signals: those that ask to stop, and those that are left to the results of writing.
#pragma once

#include <atomic>

#include "commands.hpp"

namespace kluft {

/// Whether a signal has asked to stop since `listen_for_stop`.
extern std::atomic<bool> stop_requested;

/// From now on SIGTERM reaches this thread, for which it has waited since the program's start. The threads that libraries
/// have started by then never take it: while METIS works it has a handler that must run in the thread of its caller. SIGINT does
/// again what it did when the program was started; until then it is one of a library that has no memory for its threads.
void take_signals();

/// From now on SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2 and SIGALRM set `stop_requested`. Who started
/// the program with one of the last six ignored, as nohup does, has it ignored.
void listen_for_stop();

/// 128 and the number of the first signal that asked to stop, as shells say it.
[[nodiscard]] ExitCode exit_code_of_stop();

/// What nobody reads, and a file that may not grow, are found by the result of writing and end nothing by themselves.
void leave_writing_to_its_result();

} // namespace kluft

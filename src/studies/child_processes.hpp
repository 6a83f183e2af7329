// Programs that run side by side, each within its time.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace kluft {

[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point then);

struct EndedProcess {
    std::size_t tag = 0; ///< what the process was started as
    int exit_code = -1;  ///< -1 if a signal ended it
    int signal = 0;
    bool out_of_time = false;
    double cpu_s = 0.0;
    double elapsed_s = 0.0;
};

/// Children in process groups of their own, so that Ctrl-C reaches them only through `interrupt`; they are asked to
/// stop when this program dies.
class ChildProcesses {
public:
    ChildProcesses() = default;
    ChildProcesses(const ChildProcesses&) = delete;
    ChildProcesses& operator=(const ChildProcesses&) = delete;
    /// Kills what still runs.
    ~ChildProcesses();

    /// Starts a program with its standard error in `messages` and without input and output. After `time_limit` seconds
    /// (0: never) it is asked to stop (SIGINT), and some seconds later it is killed. Throws ResourceError.
    void start(std::size_t tag, const std::vector<std::string>& words, const std::filesystem::path& messages,
               double time_limit);

    /// Those that have ended since the last call; waits a moment if there are none.
    [[nodiscard]] std::vector<EndedProcess> wait();

    /// Asks all to stop (SIGINT); those that go on for long are killed.
    void interrupt();

    [[nodiscard]] std::size_t n_running() const { return running_.size(); }
    [[nodiscard]] std::vector<std::size_t> tags() const;
    /// Wall-clock time of all that run together (s).
    [[nodiscard]] double seconds_so_far() const;

private:
    using Clock = std::chrono::steady_clock;

    struct Process {
        std::size_t tag = 0;
        pid_t pid = 0;
        double time_limit = 0.0;
        Clock::time_point started{};
        Clock::time_point asked{}; ///< to stop
        bool is_asked = false;
        bool out_of_time = false;
    };

    static void ask_to_stop(Process& process);
    static void keep_to_time(Process& process);

    std::vector<Process> running_;
};

} // namespace kluft

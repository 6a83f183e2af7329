#include "child_processes.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

namespace {

constexpr std::chrono::milliseconds pause{10};
constexpr double grace = 60.0; ///< for saving a state after being asked to stop (s)
constexpr double grace_out_of_time = 10.0;
constexpr int cannot_start = 127; ///< as of shells

double seconds_of(const timeval& time) {
    constexpr double micro = 1e-6;
    return static_cast<double>(time.tv_sec) + micro * static_cast<double>(time.tv_usec);
}

void open_as(int descriptor, const char* path, int flags) {
    constexpr mode_t readable = 0644;
    const int file = open(path, flags, readable);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(cannot_start);
    if (file != descriptor) close(file);
}

/// While it lives, signals wait: a child that is asked to stop before it has left this program's handlers would take the
/// request for one to this program.
class SignalsWait {
public:
    SignalsWait() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    SignalsWait(const SignalsWait&) = delete;
    SignalsWait& operator=(const SignalsWait&) = delete;
    ~SignalsWait() { end(); }
    void end() const { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

private:
    sigset_t before_{};
};

/// In the child: nothing that allocates memory.
[[noreturn]] void become(char* const* words, const char* messages, pid_t parent, const SignalsWait& signals) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGINT);
    if (getppid() != parent) _exit(cannot_start);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    signals.end();
    open_as(STDIN_FILENO, "/dev/null", O_RDONLY);
    open_as(STDOUT_FILENO, "/dev/null", O_WRONLY);
    open_as(STDERR_FILENO, messages, O_WRONLY | O_CREAT | O_TRUNC);
    execv(words[0], words);
    constexpr char message[] = "cannot be started\n";
    (void)!write(STDERR_FILENO, message, sizeof message - 1);
    _exit(cannot_start);
}

EndedProcess ended_process(int status, const rusage& usage) {
    EndedProcess ended;
    if (WIFEXITED(status))
        ended.exit_code = WEXITSTATUS(status);
    else
        ended.signal = WTERMSIG(status);
    ended.cpu_s = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    return ended;
}

} // namespace

double seconds_since(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

ChildProcesses::~ChildProcesses() {
    for (const Process& process : running_) {
        kill(process.pid, SIGKILL);
        waitpid(process.pid, nullptr, 0);
    }
}

void ChildProcesses::start(std::size_t tag, const std::vector<std::string>& words,
                           const std::filesystem::path& messages, double time_limit) {
    std::vector<std::string> copies = words;
    std::vector<char*> pointers;
    for (auto& word : copies) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const pid_t parent = getpid();
    const SignalsWait signals;
    const pid_t pid = fork();
    if (pid < 0)
        throw ResourceError(fmt::format("{}: cannot start another process: {}", words.front(), std::strerror(errno)));
    if (pid == 0) become(pointers.data(), messages.c_str(), parent, signals);
    running_.push_back({tag, pid, time_limit, Clock::now(), {}, false, false});
}

void ChildProcesses::ask_to_stop(Process& process) {
    if (process.is_asked) return;
    kill(process.pid, SIGINT);
    process.asked = Clock::now();
    process.is_asked = true;
}

void ChildProcesses::keep_to_time(Process& process) {
    if (process.time_limit > 0.0 && !process.is_asked && seconds_since(process.started) > process.time_limit) {
        process.out_of_time = true;
        ask_to_stop(process);
    }
    if (process.is_asked && seconds_since(process.asked) > (process.out_of_time ? grace_out_of_time : grace))
        kill(process.pid, SIGKILL);
}

std::vector<EndedProcess> ChildProcesses::wait() {
    std::vector<EndedProcess> all;
    for (std::size_t i = 0; i < running_.size();) {
        Process& process = running_[i];
        int status = 0;
        rusage usage{};
        if (wait4(process.pid, &status, WNOHANG, &usage) != process.pid) {
            keep_to_time(process);
            ++i;
            continue;
        }
        EndedProcess ended = ended_process(status, usage);
        ended.tag = process.tag;
        ended.out_of_time = process.out_of_time;
        ended.elapsed_s = seconds_since(process.started);
        all.push_back(ended);
        running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (all.empty()) std::this_thread::sleep_for(pause);
    return all;
}

void ChildProcesses::interrupt() {
    for (Process& process : running_) ask_to_stop(process);
}

std::vector<std::size_t> ChildProcesses::tags() const {
    std::vector<std::size_t> all;
    for (const Process& process : running_) all.push_back(process.tag);
    return all;
}

double ChildProcesses::seconds_so_far() const {
    double sum = 0.0;
    for (const Process& process : running_) sum += seconds_since(process.started);
    return sum;
}

} // namespace kluft

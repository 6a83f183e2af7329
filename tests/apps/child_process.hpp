// Runs the built program as a user does, with its outputs in files.
#pragma once

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kluft::testing {

inline std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

struct Limits {
    rlim_t largest_file = RLIM_INFINITY;  ///< bytes; more fails as on a full disk
    rlim_t address_space = RLIM_INFINITY; ///< bytes
};

class ChildProcess {
public:
    /// Starts `kluft arguments...` in `directory`, which takes stdout.txt and stderr.txt.
    ChildProcess(std::filesystem::path directory, const std::vector<std::string>& arguments, const Limits& limits = {})
        : directory_(std::move(directory)) {
        pid_ = fork();
        if (pid_ == 0) become(arguments, limits);
    }
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;
    ~ChildProcess() {
        if (pid_ > 0) {
            kill(pid_, SIGKILL);
            waitpid(pid_, nullptr, 0);
        }
    }

    void interrupt() const { kill(pid_, SIGINT); }

    /// Waits for the end. The exit code, or minus the signal that killed it.
    int wait() {
        int status = 0;
        waitpid(pid_, &status, 0);
        pid_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }

    [[nodiscard]] std::string output() const { return text_of(directory_ / "stdout.txt"); }
    [[nodiscard]] std::string errors() const { return text_of(directory_ / "stderr.txt"); }

private:
    [[noreturn]] void become(const std::vector<std::string>& arguments, const Limits& limits) const {
        std::vector<std::string> words{KLUFT_PROGRAM};
        words.insert(words.end(), arguments.begin(), arguments.end());
        std::vector<char*> argv;
        for (auto& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const rlimit file{limits.largest_file, limits.largest_file};
        const rlimit memory{limits.address_space, limits.address_space};
        signal(SIGXFSZ, SIG_IGN); // the write fails instead
        const bool ready = chdir(directory_.c_str()) == 0 && freopen("stdout.txt", "w", stdout) != nullptr &&
                           freopen("stderr.txt", "w", stderr) != nullptr && setrlimit(RLIMIT_FSIZE, &file) == 0 &&
                           setrlimit(RLIMIT_AS, &memory) == 0;
        if (ready) execv(argv[0], argv.data());
        _exit(127);
    }

    std::filesystem::path directory_;
    pid_t pid_ = -1;
};

struct Outcome {
    int exit_code = 0;
    std::string output;
    std::string errors;
};

inline Outcome run_kluft(const std::filesystem::path& directory, const std::vector<std::string>& arguments,
                         const Limits& limits = {}) {
    ChildProcess child(directory, arguments, limits);
    const int code = child.wait();
    return {code, child.output(), child.errors()};
}

} // namespace kluft::testing

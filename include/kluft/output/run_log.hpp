// run.log: what a run did, line by line with its time.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace kluft {

/// Each line reaches the file at once. A log that can no longer be written does not end a run.
class RunLog {
public:
    /// Opens `path`; a resumed run goes on behind the old lines. A symbolic link of that name is replaced by a new log.
    /// Throws ResourceError when it cannot be opened.
    explicit RunLog(const std::filesystem::path& path, bool resume = false);
    RunLog(RunLog&&) noexcept;
    RunLog& operator=(RunLog&&) noexcept;
    ~RunLog();

    void info(std::string_view message);
    void warning(std::string_view message);
    void error(std::string_view message);

private:
    struct Sink;
    std::unique_ptr<Sink> sink_;
};

} // namespace kluft

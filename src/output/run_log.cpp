#include "kluft/output/run_log.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/basic_file_sink.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

struct RunLog::Sink {
    spdlog::logger logger;
};

namespace {

spdlog::sink_ptr open_sink(const std::filesystem::path& path, bool resume) {
    make_directory(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
    std::error_code error;
    const auto kind = std::filesystem::symlink_status(path, error).type();
    using std::filesystem::file_type;
    if (kind == file_type::symlink || kind == file_type::fifo || kind == file_type::socket)
        remove_file(path); // the file that it leads to is not the run's, and nobody may read at the other end
    try {
        return std::make_shared<spdlog::sinks::basic_file_sink_st>(path.string(), !resume);
    } catch (const spdlog::spdlog_ex& failure) {
        throw ResourceError(path.string() + ": cannot open: " + failure.what());
    }
}

} // namespace

RunLog::RunLog(const std::filesystem::path& path, bool resume)
    : sink_(std::make_unique<Sink>(Sink{spdlog::logger("run", open_sink(path, resume))})) {
    sink_->logger.set_pattern("%Y-%m-%d %H:%M:%S.%e %-7l %v");
    sink_->logger.flush_on(spdlog::level::info);
    sink_->logger.set_error_handler([](const std::string&) {});
}

RunLog::RunLog(RunLog&&) noexcept = default;
RunLog& RunLog::operator=(RunLog&&) noexcept = default;
RunLog::~RunLog() = default;

void RunLog::info(std::string_view message) { sink_->logger.log(spdlog::level::info, message); }
void RunLog::warning(std::string_view message) { sink_->logger.log(spdlog::level::warn, message); }
void RunLog::error(std::string_view message) { sink_->logger.log(spdlog::level::err, message); }

} // namespace kluft

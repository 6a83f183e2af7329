#include "kluft/output/append_table.hpp"

#include <cerrno>
#include <charconv>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "file_descriptor.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

struct AppendTable::File {
    fs::path path;
    FileDescriptor descriptor;
    off_t size;

    explicit File(const fs::path& name)
        : path(name), descriptor(name, O_WRONLY | O_APPEND), size(::lseek(descriptor.number(), 0, SEEK_END)) {}
};

namespace {

int step_of_row(const fs::path& path, std::string_view row) {
    int step = 0;
    const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), step);
    if (error != std::errc() || end == row.data() + row.size() || *end != ',')
        throw InputError(path.string() + ": expected a row that begins with a load step, found '" +
                         std::string(row.substr(0, 40)) + "'");
    return step;
}

/// Size of the part of `content` that stays: the header and the rows up to `last_step`.
std::size_t kept_size(const fs::path& path, std::string_view content, int last_step) {
    std::size_t begin = content.find('\n') + 1;
    while (true) {
        const std::size_t end = content.find('\n', begin);
        if (end == std::string_view::npos) return begin;
        if (step_of_row(path, content.substr(begin, end - begin)) > last_step) return begin;
        begin = end + 1;
    }
}

} // namespace

AppendTable::AppendTable(std::unique_ptr<File> file) : file_(std::move(file)) {}
AppendTable::AppendTable(AppendTable&&) noexcept = default;
AppendTable& AppendTable::operator=(AppendTable&&) noexcept = default;
AppendTable::~AppendTable() = default;

AppendTable AppendTable::create(const fs::path& path, std::string_view header) {
    write_file(path, std::string(header) + '\n');
    return AppendTable(std::make_unique<File>(path));
}

AppendTable AppendTable::resume(const fs::path& path, std::string_view header, int last_step) {
    cut_table(path, header, last_step);
    return AppendTable(std::make_unique<File>(path));
}

void AppendTable::append(std::string_view row) {
    const std::string line = std::string(row) + '\n';
    try {
        file_->descriptor.write(line);
    } catch (...) {
        // Best effort: a reader also ignores an unfinished last line.
        [[maybe_unused]] const int result = ::ftruncate(file_->descriptor.number(), file_->size);
        throw;
    }
    file_->size += static_cast<off_t>(line.size());
}

void AppendTable::sync() { file_->descriptor.sync(); }

void cut_table(const fs::path& path, std::string_view header, int last_step) {
    const std::string content = read_file(path);
    const std::string first_line = content.substr(0, content.find('\n'));
    if (first_line != header || content.find('\n') == std::string::npos)
        throw InputError(path.string() + ":1: expected the columns '" + std::string(header) + "', found '" +
                         first_line.substr(0, 200) + "'");
    const std::size_t size = kept_size(path, content, last_step);
    if (size == content.size()) return;
    FileDescriptor file(path, O_WRONLY);
    if (::ftruncate(file.number(), static_cast<off_t>(size)) != 0) throw_system_error(path, "cannot cut", errno);
    file.sync();
}

} // namespace kluft

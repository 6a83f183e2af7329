#include "kluft/output/append_table.hpp"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "file_descriptor.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/digest.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

struct AppendTable::File {
    fs::path path;
    FileDescriptor descriptor;
    off_t size;
    Digest digest;        ///< of the lines
    bool is_whole = true; ///< false: a part of a row is behind `size`

    File(const fs::path& name, Digest lines)
        : path(name), descriptor(name, O_WRONLY | O_APPEND), size(::lseek(descriptor.number(), 0, SEEK_END)),
          digest(lines) {}

    void cut_back() {
        if (::ftruncate(descriptor.number(), size) != 0) throw_system_error(path, "cannot cut", errno);
        is_whole = true;
    }
};

namespace {

Digest digest_of(std::string_view lines) {
    Digest digest;
    while (!lines.empty()) {
        const std::size_t end = lines.find('\n');
        digest.add(lines.substr(0, end));
        lines.remove_prefix(end == std::string_view::npos ? lines.size() : end + 1);
    }
    return digest;
}

void require_header(const fs::path& path, std::string_view content, std::string_view header) {
    const std::string_view first_line = content.substr(0, content.find('\n'));
    if (first_line != header || content.size() == first_line.size())
        throw InputError(fmt::format("{}:1: expected the columns '{}', found '{}'", path.string(), header,
                                     first_line.substr(0, 200)));
}

/// The digest of the table up to the mark, where it is as it was.
Digest require_unchanged(const fs::path& path, std::string_view content, const TableMark& mark) {
    const Digest digest = digest_of(content.substr(0, mark.bytes));
    if (content.size() < mark.bytes || digest.text() != mark.digest)
        throw InputError(fmt::format(
            "{}: expected the {} bytes that it had when the state was saved, found {}; the run cannot be gone on with "
            "from this state, run it anew without --resume",
            path.string(), mark.bytes,
            content.size() < mark.bytes ? fmt::format("{}: rows are missing", content.size()) : "other ones"));
    return digest;
}

} // namespace

AppendTable::AppendTable(std::unique_ptr<File> file) : file_(std::move(file)) {}
AppendTable::AppendTable(AppendTable&&) noexcept = default;
AppendTable& AppendTable::operator=(AppendTable&&) noexcept = default;
AppendTable::~AppendTable() = default;

AppendTable AppendTable::create(const fs::path& path, std::string_view header) {
    const std::string line = std::string(header) + '\n';
    write_file(path, line);
    return AppendTable(std::make_unique<File>(path, digest_of(line)));
}

AppendTable AppendTable::resume(const fs::path& path, std::string_view header, const TableMark& mark) {
    const std::string content = read_file(path);
    require_header(path, content, header);
    auto file = std::make_unique<File>(path, require_unchanged(path, content, mark));
    file->size = static_cast<off_t>(mark.bytes);
    file->cut_back();
    return AppendTable(std::move(file));
}

void AppendTable::append(std::string_view row) {
    const std::string line = std::string(row) + '\n';
    if (!file_->is_whole) file_->cut_back();
    file_->is_whole = false;
    try {
        file_->descriptor.write(line);
    } catch (...) {
        // Best effort: a reader also ignores an unfinished last line.
        if (::ftruncate(file_->descriptor.number(), file_->size) == 0) file_->is_whole = true;
        throw;
    }
    file_->is_whole = true;
    file_->size += static_cast<off_t>(line.size());
    file_->digest.add(row);
}

void AppendTable::sync() { file_->descriptor.sync(); }

TableMark AppendTable::mark() const { return {static_cast<std::uint64_t>(file_->size), file_->digest.text()}; }

} // namespace kluft

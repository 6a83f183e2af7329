#include "file_descriptor.hpp"

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

void throw_system_error(const std::filesystem::path& path, std::string_view action, int error) {
    throw ResourceError(path.string() + ": " + std::string(action) + ": " + std::generic_category().message(error));
}

FileDescriptor::FileDescriptor(const std::filesystem::path& path, int flags) : path_(path) {
    constexpr mode_t everyone_by_umask = 0666;
    do {
        number_ = ::open(path.c_str(), flags | O_CLOEXEC, everyone_by_umask);
    } while (number_ < 0 && errno == EINTR);
    if (number_ < 0) throw_system_error(path, "cannot open", errno);
}

FileDescriptor::FileDescriptor(FileDescriptor&& other) noexcept
    : path_(std::move(other.path_)), number_(std::exchange(other.number_, -1)) {}

FileDescriptor::~FileDescriptor() {
    if (number_ >= 0) ::close(number_);
}

void FileDescriptor::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(number_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_system_error(path_, "cannot write", errno);
        if (written == 0) throw_system_error(path_, "cannot write", EIO);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void FileDescriptor::empty() {
    if (::ftruncate(number_, 0) != 0) throw_system_error(path_, "cannot empty", errno);
}

void FileDescriptor::sync() {
    // EINVAL and ENOTSUP: a device or a file system that has nothing to bring to a disk.
    int result = 0;
    do {
        result = ::fsync(number_);
    } while (result != 0 && errno == EINTR);
    if (result != 0 && errno != EINVAL && errno != ENOTSUP) throw_system_error(path_, "cannot sync", errno);
}

void FileDescriptor::close() {
    const int number = std::exchange(number_, -1);
    if (::close(number) != 0 && errno != EINTR) throw_system_error(path_, "cannot close", errno);
}

} // namespace kluft

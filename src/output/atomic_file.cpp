#include "kluft/output/atomic_file.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "file_descriptor.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/input_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

fs::path directory_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

using Write = std::function<void(const Put& put)>;

void write_directly(const fs::path& path, const Write& write) {
    FileDescriptor file(path, O_WRONLY);
    write([&](std::string_view bytes) { file.write(bytes); });
    file.close();
}

/// Whether the open file still has this name.
bool has_name(const FileDescriptor& file, const fs::path& path) {
    struct stat opened {};
    struct stat named {};
    return ::fstat(file.number(), &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

/// The unfinished file, for this process alone; one that was killed may have left something in it, and one that writes the
/// same file at this time has given it its name before this returns.
FileDescriptor own_part(const fs::path& part) {
    constexpr std::chrono::milliseconds pause{10};
    constexpr int n_tries = 1000;
    for (int i = 0; i < n_tries; ++i) {
        FileDescriptor file(part, O_WRONLY | O_CREAT);
        const bool is_locked = ::flock(file.number(), LOCK_EX | LOCK_NB) == 0;
        const bool has_no_locks = !is_locked && errno != EWOULDBLOCK && errno != EINTR; // some network file systems
        if (has_no_locks || (is_locked && has_name(file, part))) return file;
        if (!is_locked) std::this_thread::sleep_for(pause);
    }
    throw_system_error(part, "another process does not finish it", EBUSY);
}

void write_and_rename(const fs::path& path, const Write& write) {
    const fs::path part = partial_name(path);
    FileDescriptor file = own_part(part);
    try {
        file.empty();
        write([&](std::string_view bytes) { file.write(bytes); });
        file.sync();
        if (std::rename(part.c_str(), path.c_str()) != 0) throw_system_error(path, "cannot rename to it", errno);
    } catch (...) {
        std::error_code ignored;
        fs::remove(part, ignored);
        throw;
    }
    file.close();
    FileDescriptor(directory_of(path), O_RDONLY | O_DIRECTORY).sync();
}

/// The file that a symbolic link leads to, also when that does not exist yet.
fs::path followed(const fs::path& path) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
    const fs::path target = fs::weakly_canonical(path, error);
    return error ? path : target;
}

} // namespace

fs::path partial_name(const fs::path& path) { return path.string() + ".part"; }

void write_file(const fs::path& path, std::string_view content) {
    write_file(path, [&](const Put& put) { put(content); });
}

void write_file(const fs::path& path, const Write& write) {
    const fs::path target = followed(path);
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        write_directly(target, write);
    else
        write_and_rename(target, write);
}

std::string read_file(const fs::path& path) {
    constexpr std::size_t largest = 8'000'000'000; // of what a run writes
    return read_input_file(path, "a file", largest);
}

void make_directory(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error == std::errc::no_such_file_or_directory || error == std::errc::operation_not_permitted) // /proc, /sys
        throw InputError(path.string() + ": expected a place where a directory can be made, found none");
    if (error) throw_system_error(path, "cannot make the directory", error.value());
    if (!fs::is_directory(path, error)) throw_system_error(path, "cannot make the directory", ENOTDIR);
}

void remove_file(const fs::path& path) {
    for (const fs::path& each : {path, partial_name(path)}) {
        std::error_code error;
        fs::remove(each, error);
        if (error && error != std::errc::not_a_directory) throw_system_error(each, "cannot remove", error.value());
    }
}

} // namespace kluft

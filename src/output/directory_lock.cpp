#include "kluft/output/directory_lock.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <string>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "file_descriptor.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

/// A process that was killed frees its memory before its locks.
constexpr std::chrono::milliseconds patience{100};
constexpr std::chrono::milliseconds between_attempts{5};

fs::path lock_file(const fs::path& directory) { return directory / ".lock"; }

/// 0, or the system's reason. A file system without locks gives none, and refuses none.
int try_lock(int descriptor, int how) {
    while (::flock(descriptor, how | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        return errno == EWOULDBLOCK ? EWOULDBLOCK : 0;
    }
    return 0;
}

bool lock_patiently(int descriptor) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (try_lock(descriptor, LOCK_EX) != 0) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(between_attempts);
    }
    return true;
}

/// "process 4711 on node7 (kluft run scene.yaml)"
std::string this_process(std::string_view what) {
    std::array<char, 256> host{};
    if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
    return fmt::format("process {}{}{} ({})", ::getpid(), host[0] == '\0' ? "" : " on ", host.data(), what);
}

/// For those who come later only: a lock is one without it, so that a full disk does not matter.
void write_holder(int descriptor, const std::string& holder) {
    if (::ftruncate(descriptor, 0) != 0) return;
    [[maybe_unused]] const ssize_t written = ::pwrite(descriptor, holder.data(), holder.size(), 0);
}

std::string holder_in(int descriptor) {
    std::array<char, 1000> text{};
    const ssize_t n = ::pread(descriptor, text.data(), text.size(), 0);
    return n > 0 ? std::string(text.data(), static_cast<std::size_t>(n)) : "another process";
}

} // namespace

DirectoryLock::DirectoryLock(const fs::path& directory, std::string_view what, std::string_view advice) {
    make_directory(directory);
    file_ = std::make_unique<FileDescriptor>(lock_file(directory), O_RDWR | O_CREAT | O_NOFOLLOW);
    if (!lock_patiently(file_->number()))
        throw InputError(fmt::format("{}: expected a directory that no other process writes to, found {} in it{}{}",
                                     directory.string(), holder_in(file_->number()), advice.empty() ? "" : "; ",
                                     advice));
    write_holder(file_->number(), this_process(what));
}

DirectoryLock::~DirectoryLock() = default;

bool is_locked(const fs::path& directory) {
    const int descriptor = ::open(lock_file(directory).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) return false;
    const bool locked = try_lock(descriptor, LOCK_SH) != 0; // those who lock meanwhile are patient
    ::close(descriptor);
    return locked;
}

} // namespace kluft

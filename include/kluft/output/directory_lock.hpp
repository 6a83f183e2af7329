// One process at a time in a directory of results.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace kluft {

class FileDescriptor;

/// Keeps other runs, studies and calibrations out of a directory for its life. The lock is the operating system's: it
/// ends with the process, however that ends. On a file system without locks there is none.
class DirectoryLock {
public:
    /// Makes the directory where there is none. `what` tells those who come later what has it: "kluft run scene.yaml".
    /// Throws InputError, which names the process that has the directory and ends with `advice`; ResourceError when the
    /// lock cannot be made.
    DirectoryLock(const std::filesystem::path& directory, std::string_view what, std::string_view advice = {});
    DirectoryLock(const DirectoryLock&) = delete;
    DirectoryLock& operator=(const DirectoryLock&) = delete;
    ~DirectoryLock();

private:
    std::unique_ptr<FileDescriptor> file_;
};

/// Whether some process has locked the directory.
[[nodiscard]] bool is_locked(const std::filesystem::path& directory);

} // namespace kluft

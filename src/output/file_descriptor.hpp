// An open file of the operating system, with every result checked.
#pragma once

#include <filesystem>
#include <string_view>

namespace kluft {

/// Throws ResourceError: "<path>: <action>: <reason of errno>".
[[noreturn]] void throw_system_error(const std::filesystem::path& path, std::string_view action, int error);

/// Owns a file descriptor. Errors throw ResourceError.
class FileDescriptor {
public:
    FileDescriptor(const std::filesystem::path& path, int flags);
    FileDescriptor(FileDescriptor&& other) noexcept;
    FileDescriptor& operator=(FileDescriptor&&) = delete;
    ~FileDescriptor();

    /// One write call where the system allows it; repeats after interruptions and partial writes.
    void write(std::string_view bytes);
    /// Cuts the file to no bytes.
    void empty();
    void sync();
    /// Closes now, so that an error of the close is seen.
    void close();

    [[nodiscard]] int number() const { return number_; }

private:
    std::filesystem::path path_;
    int number_ = -1;
};

} // namespace kluft

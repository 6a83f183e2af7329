// What a reader may do with any bytes: take them, or refuse them as bad input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft::fuzz {

/// Calls read(). True where it took the input, false where it threw InputError. Everything else that it throws, and what the
/// sanitizers see, ends the program.
template <class Read> bool is_taken(Read&& read) {
    try {
        read();
        return true;
    } catch (const InputError&) {
        return false;
    }
}

inline std::string_view text_of(const std::uint8_t* bytes, std::size_t size) {
    return {reinterpret_cast<const char*>(bytes), size};
}

/// A file in memory for readers that take files only.
class MemoryFile {
public:
    explicit MemoryFile(std::string_view bytes) : descriptor_(memfd_create("input", 0)) {
        if (descriptor_ < 0 || write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
            throw std::runtime_error("no file in memory");
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    ~MemoryFile() { close(descriptor_); }

    [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
    int descriptor_;
};

} // namespace kluft::fuzz

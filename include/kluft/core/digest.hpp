// A number that tells texts apart.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kluft {

/// FNV-1a, 64 bits, of texts one after the other.
class Digest {
public:
    Digest& add(std::string_view text) {
        for (const char c : text) step(static_cast<unsigned char>(c));
        step(0x100U); // an end, which no character is
        return *this;
    }
    /// 16 hexadecimal digits.
    [[nodiscard]] std::string text() const;

private:
    void step(std::uint64_t symbol) { state_ = (state_ ^ symbol) * 0x100000001B3U; }

    std::uint64_t state_ = 0xCBF29CE484222325U;
};

/// The name with eight digits of what was wanted behind it: a short name that differs from those of others with the same beginning.
[[nodiscard]] std::string told_apart(const std::string& name, std::string_view wanted);

} // namespace kluft

// Arrays of numbers inside a page: few bytes each, compressed, as text.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kluft {

/// Arrays by name. Their text is one object of JSON: `arrays`, a list of {`name`, `type`, `n`} and what the type needs;
/// `data`, the bytes of all one after the other, compressed by zlib, in base64. Numbers are little-endian; of two-byte
/// ones all low bytes come first, then all high ones, which compresses better. What is not finite is taken as zero.
class PackedArrays {
public:
    /// Type `int32`.
    void add_integers(const std::string& name, std::span<const int> numbers);
    /// Type `uint8`: from 0 to 255.
    void add_bytes(const std::string& name, std::span<const std::uint8_t> numbers);
    /// Type `float32`.
    void add_floats(const std::string& name, std::span<const double> numbers);
    /// Type `even`, two bytes each: low + step q. Off by at most 1/131070 of the range of the numbers.
    void add_even(const std::string& name, std::span<const double> numbers);
    /// Type `half`, two bytes each: scale times a half-precision float (IEEE 754). Off by at most a 2048th of each number
    /// that is not below 1e-9 of the largest.
    void add_halves(const std::string& name, std::span<const double> numbers);

    /// Before compression.
    [[nodiscard]] std::size_t n_bytes() const { return bytes_.size(); }
    [[nodiscard]] std::string json() const;

private:
    void describe(const std::string& name, const std::string& type, std::size_t n, const std::string& more = {});
    void append_planes(const std::vector<std::uint16_t>& numbers);

    std::string descriptions_;
    std::string bytes_;
};

/// The half-precision float nearest to a number between -65504 and 65504.
[[nodiscard]] std::uint16_t half_precision(double number);

} // namespace kluft

#include "kluft/report/packed_arrays.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>

#include <fmt/format.h>
#include <zlib.h>

#include "kluft/report/report_document.hpp"

namespace kluft {

namespace {

double finite_or_zero(double number) { return std::isfinite(number) ? number : 0.0; }

void append_word(std::string& bytes, std::uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 255U);
}

std::string compressed(const std::string& bytes) {
    uLongf size = ::compressBound(bytes.size());
    std::string result(size, '\0');
    auto* const to = reinterpret_cast<Bytef*>(result.data());              // NOLINT: bytes are bytes
    const auto* const from = reinterpret_cast<const Bytef*>(bytes.data()); // NOLINT: bytes are bytes
    if (::compress2(to, &size, from, bytes.size(), Z_DEFAULT_COMPRESSION) != Z_OK) throw std::bad_alloc();
    result.resize(size);
    return result;
}

} // namespace

std::uint16_t half_precision(double number) {
    constexpr int mantissa_bits = 10;
    constexpr int least_exponent = -14; // of a normal number
    const unsigned sign = std::signbit(number) ? 0x8000U : 0U;
    const double size = std::abs(number);
    int exponent = 0;
    (void)std::frexp(size, &exponent); // size = f 2^exponent, 1/2 <= f < 1
    const int power = size > 0.0 ? std::max(exponent - 1, least_exponent) : least_exponent;
    // With the hidden bit, which counts as one more exponent; rounding up to the next power of two is right that way too.
    const auto mantissa = static_cast<unsigned>(std::lround(std::ldexp(size, mantissa_bits - power)));
    const auto steps = static_cast<unsigned>(power - least_exponent) << static_cast<unsigned>(mantissa_bits);
    return static_cast<std::uint16_t>(sign | (steps + mantissa));
}

void PackedArrays::describe(const std::string& name, const std::string& type, std::size_t n, const std::string& more) {
    if (!descriptions_.empty()) descriptions_ += ',';
    descriptions_ += fmt::format(R"({{"name":"{}","type":"{}","n":{}{}}})", name, type, n, more);
}

void PackedArrays::append_planes(const std::vector<std::uint16_t>& numbers) {
    for (const std::uint16_t number : numbers) bytes_ += static_cast<char>(number & 255U);
    for (const std::uint16_t number : numbers) bytes_ += static_cast<char>(number >> 8U);
}

void PackedArrays::add_integers(const std::string& name, std::span<const int> numbers) {
    describe(name, "int32", numbers.size());
    for (const int number : numbers) append_word(bytes_, static_cast<std::uint32_t>(number));
}

void PackedArrays::add_bytes(const std::string& name, std::span<const std::uint8_t> numbers) {
    describe(name, "uint8", numbers.size());
    for (const std::uint8_t number : numbers) bytes_ += static_cast<char>(number);
}

void PackedArrays::add_floats(const std::string& name, std::span<const double> numbers) {
    describe(name, "float32", numbers.size());
    for (const double number : numbers)
        append_word(bytes_, std::bit_cast<std::uint32_t>(static_cast<float>(finite_or_zero(number))));
}

void PackedArrays::add_even(const std::string& name, std::span<const double> numbers) {
    constexpr double n_steps = 65535.0;
    double low = 0.0;
    double high = 0.0;
    if (!numbers.empty()) low = high = finite_or_zero(numbers.front());
    for (const double number : numbers) {
        low = std::min(low, finite_or_zero(number));
        high = std::max(high, finite_or_zero(number));
    }
    const double step = (high - low) / n_steps;
    std::vector<std::uint16_t> places;
    places.reserve(numbers.size());
    for (const double number : numbers)
        places.push_back(step > 0.0 ? static_cast<std::uint16_t>(std::lround((finite_or_zero(number) - low) / step))
                                    : 0);
    describe(name, "even", numbers.size(), fmt::format(R"(,"low":{:.17g},"step":{:.17g})", low, step));
    append_planes(places);
}

void PackedArrays::add_halves(const std::string& name, std::span<const double> numbers) {
    constexpr int largest_power = 15; // numbers below 2^15 are well below the largest half-precision float
    double largest = 0.0;
    for (const double number : numbers) largest = std::max(largest, std::abs(finite_or_zero(number)));
    int exponent = 0;
    (void)std::frexp(largest, &exponent);
    const double scale = largest > 0.0 ? std::ldexp(1.0, exponent - largest_power) : 1.0;
    std::vector<std::uint16_t> halves;
    halves.reserve(numbers.size());
    for (const double number : numbers) halves.push_back(half_precision(finite_or_zero(number) / scale));
    describe(name, "half", numbers.size(), fmt::format(R"(,"scale":{:.17g})", scale));
    append_planes(halves);
}

std::string PackedArrays::json() const {
    return fmt::format(R"({{"arrays":[{}],"data":"{}"}})", descriptions_, base64(compressed(bytes_)));
}

} // namespace kluft

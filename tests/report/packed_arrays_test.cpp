#include "kluft/report/packed_arrays.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

namespace kluft {
namespace {

/// Base64 as in RFC 4648, letter by letter.
std::string bytes_of(const std::string& base64) {
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int n_bits = 0;
    for (const char letter : base64) {
        if (letter == '=') break;
        bits = bits << 6U | static_cast<unsigned>(letters.find(letter));
        n_bits += 6;
        if (n_bits < 8) continue;
        n_bits -= 8;
        bytes += static_cast<char>(bits >> static_cast<unsigned>(n_bits) & 255U);
    }
    return bytes;
}

struct Unpacked {
    nlohmann::json arrays;
    std::string bytes;

    [[nodiscard]] unsigned byte(std::size_t at) const { return static_cast<unsigned char>(bytes.at(at)); }
    [[nodiscard]] std::uint32_t word(std::size_t at) const {
        return byte(at) | byte(at + 1) << 8U | byte(at + 2) << 16U | byte(at + 3) << 24U;
    }
    /// Number i of n two-byte ones from the byte `at` on.
    [[nodiscard]] unsigned pair(std::size_t at, std::size_t n, std::size_t i) const {
        return byte(at + i) | byte(at + n + i) << 8U;
    }
};

Unpacked unpacked(const PackedArrays& arrays) {
    Unpacked result;
    const auto json = nlohmann::json::parse(arrays.json());
    result.arrays = json["arrays"];
    const std::string packed = bytes_of(json["data"].get<std::string>());
    result.bytes.resize(arrays.n_bytes());
    uLongf size = result.bytes.size();
    EXPECT_EQ(::uncompress(reinterpret_cast<Bytef*>(result.bytes.data()), &size,
                           reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
              Z_OK);
    EXPECT_EQ(size, result.bytes.size());
    return result;
}

/// IEEE 754: 5 bits of exponent with bias 15, 10 of mantissa.
double value_of_half(unsigned bits) {
    const int exponent = static_cast<int>(bits >> 10U & 31U);
    const double mantissa = bits & 1023U;
    const double size = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024.0 + mantissa, exponent - 25);
    return (bits & 0x8000U) != 0 ? -size : size;
}

TEST(PackedArrays, KeepWholeNumbersBytesAndFloatsAsTheyAre) {
    PackedArrays arrays;
    const std::vector<int> integers{0, -1, 70000, std::numeric_limits<int>::min()};
    const std::vector<std::uint8_t> bytes{0, 7, 255};
    const std::vector<double> floats{0.5, -3.25, 1e30};
    arrays.add_integers("n", integers);
    arrays.add_bytes("b", bytes);
    arrays.add_floats("f", floats);
    const Unpacked found = unpacked(arrays);
    ASSERT_EQ(found.bytes.size(), 4 * 4 + 3 + 4 * 3U);
    for (std::size_t i = 0; i < integers.size(); ++i) EXPECT_EQ(static_cast<int>(found.word(4 * i)), integers[i]);
    for (std::size_t i = 0; i < bytes.size(); ++i) EXPECT_EQ(found.byte(16 + i), bytes[i]);
    for (std::size_t i = 0; i < floats.size(); ++i)
        EXPECT_EQ(std::bit_cast<float>(found.word(19 + 4 * i)), static_cast<float>(floats[i]));
    EXPECT_EQ(found.arrays[1]["name"], "b");
    EXPECT_EQ(found.arrays[1]["type"], "uint8");
    EXPECT_EQ(found.arrays[1]["n"], 3);
}

TEST(PackedArrays, EvenStepsAreOffByHalfAStepOfTheRangeAtMost) {
    PackedArrays arrays;
    std::vector<double> numbers;
    for (int i = 0; i < 1000; ++i) numbers.push_back(std::sin(0.37 * i) * 4e-3 - 1.0);
    arrays.add_even("u", numbers);
    const Unpacked found = unpacked(arrays);
    const double low = found.arrays[0]["low"];
    const double step = found.arrays[0]["step"];
    const double range = 8e-3; // of the sine
    EXPECT_LE(step * 65535.0, range);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        EXPECT_NEAR(low + step * found.pair(0, numbers.size(), i), numbers[i], range / 131070.0 * (1.0 + 1e-9)) << i;
}

TEST(PackedArrays, EvenStepsOfEqualNumbersAreThatNumber) {
    PackedArrays arrays;
    const std::vector<double> numbers{2.5, 2.5};
    arrays.add_even("u", numbers);
    const Unpacked found = unpacked(arrays);
    EXPECT_EQ(found.arrays[0]["low"], 2.5);
    EXPECT_EQ(found.arrays[0]["step"], 0.0);
}

TEST(PackedArrays, HalvesAreOffByA2048thOfEachNumberFromTheLargestToABillionthOfIt) {
    PackedArrays arrays;
    std::vector<double> numbers;
    for (int i = 0; i < 60; ++i) numbers.push_back((i % 2 == 0 ? 1.0 : -1.0) * 7.3e7 * std::pow(0.71, i));
    arrays.add_halves("s", numbers);
    const Unpacked found = unpacked(arrays);
    const double scale = found.arrays[0]["scale"];
    ASSERT_GT(std::abs(numbers.back()), 1e-9 * numbers.front());
    for (std::size_t i = 0; i < numbers.size(); ++i)
        EXPECT_NEAR(scale * value_of_half(found.pair(0, numbers.size(), i)), numbers[i], std::abs(numbers[i]) / 2048.0)
            << i;
}

TEST(PackedArrays, HalvesThatAreRepresentableComeBackAsTheyAre) {
    for (unsigned bits = 0; bits < 0x7C00U; ++bits) {
        ASSERT_EQ(half_precision(value_of_half(bits)), bits);
        ASSERT_EQ(half_precision(value_of_half(bits | 0x8000U)), bits | 0x8000U);
    }
}

TEST(PackedArrays, TakeWhatIsNotFiniteAsZero) {
    PackedArrays arrays;
    const std::vector<double> numbers{std::numeric_limits<double>::infinity(), 1.0,
                                      std::numeric_limits<double>::quiet_NaN()};
    arrays.add_halves("s", numbers);
    const Unpacked found = unpacked(arrays);
    EXPECT_EQ(found.pair(0, 3, 0), 0U);
    EXPECT_EQ(found.arrays[0]["scale"].get<double>() * value_of_half(found.pair(0, 3, 1)), 1.0);
    EXPECT_EQ(found.pair(0, 3, 2), 0U);
}

TEST(PackedArrays, OfNothingAreNone) {
    PackedArrays arrays;
    arrays.add_even("u", {});
    arrays.add_halves("s", {});
    EXPECT_EQ(arrays.n_bytes(), 0U);
    EXPECT_EQ(unpacked(arrays).arrays.size(), 2U);
}

} // namespace
} // namespace kluft

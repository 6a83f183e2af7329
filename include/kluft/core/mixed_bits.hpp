// Random numbers that are a function of their indices, the same on every machine.
#pragma once

#include <cstdint>

namespace kluft {

/// The finalizer of splitmix64 (Steele, Lea and Flood 2014): a bijection of 64 bits without visible order.
[[nodiscard]] constexpr std::uint64_t mixed_bits(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31U);
}

} // namespace kluft

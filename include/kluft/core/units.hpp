// Factors between SI units and those that users read.
#pragma once

#include <numbers>

namespace kluft {

inline constexpr double mega = 1e6;                         ///< Pa in MPa
inline constexpr double percent = 100.0;                    ///< per cent in one
inline constexpr double degrees = 180.0 / std::numbers::pi; ///< degrees in one radian

} // namespace kluft

// Angles of formulas in degrees.
#pragma once

#include <numbers>

namespace kluft {

inline constexpr double degree = std::numbers::pi / 180.0;

} // namespace kluft

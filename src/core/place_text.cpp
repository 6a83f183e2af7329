#include "kluft/core/place_text.hpp"

#include <cmath>

#include <fmt/format.h>

namespace kluft {

namespace {

std::string coordinate_text(double x) {
    constexpr double six_digits_reach_millimetres = 1e3;
    if (!(std::abs(x) >= six_digits_reach_millimetres)) return fmt::format("{:.6g}", x);
    constexpr double millimetres = 1e3;
    return fmt::format("{:.16g}", std::round(x * millimetres) / millimetres);
}

} // namespace

std::string place_text(const Vec2& place) {
    return fmt::format("({}, {})", coordinate_text(place.x()), coordinate_text(place.y()));
}

} // namespace kluft

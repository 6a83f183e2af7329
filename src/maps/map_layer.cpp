#include "kluft/maps/map_layer.hpp"

#include <fmt/format.h>

namespace kluft {

std::string map_value_text(const MapValue& value) {
    if (const auto* const whole = std::get_if<long long>(&value)) return fmt::format("{}", *whole);
    if (const auto* const number = std::get_if<double>(&value)) return fmt::format("{}", *number);
    if (const auto* const text = std::get_if<std::string>(&value)) return *text;
    return {};
}

} // namespace kluft

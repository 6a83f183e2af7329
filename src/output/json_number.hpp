// Numbers of JSON files that may be unknown.
#pragma once

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace kluft {

/// null for what is unknown or not finite.
[[nodiscard]] inline nlohmann::ordered_json json_number(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

} // namespace kluft

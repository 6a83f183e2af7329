// Places in messages.
#pragma once

#include <string>

#include "kluft/core/vector.hpp"

namespace kluft {

/// "(0.125, 0.0333333)", "(466013.25, 6692131.053)": six digits, and on maps with large coordinates (m) down to the millimetre.
[[nodiscard]] std::string place_text(const Vec2& place);

} // namespace kluft

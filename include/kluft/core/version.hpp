// The version of the library.
#pragma once

#include <string_view>

namespace kluft {

/// Major, minor and patch number as in "0.1.0".
[[nodiscard]] std::string_view version();

} // namespace kluft

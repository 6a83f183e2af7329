// The version of the library.
#pragma once

#include <string_view>

namespace kluft {

/// Major, minor and patch number as in "0.1.0".
[[nodiscard]] std::string_view version();

/// The commit that was built, as in "3252e9e", "3252e9e-dirty" with changes; "" where it was not built from a checkout.
[[nodiscard]] std::string_view commit();

} // namespace kluft

// Texts in tables.
#pragma once

#include <string>

namespace kluft {

/// The text as one cell of a table with commas: in double quotes where it has commas, quotes or line ends in it.
[[nodiscard]] std::string csv_text(const std::string& text);

} // namespace kluft

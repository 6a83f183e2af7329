// JSON Schema of a table of keys, from which editors complete and check files.
#pragma once

#include <string>
#include <string_view>

#include "kluft/scene/key_table.hpp"

namespace kluft {

/// Whether a file may take another one and change it: `null` then removes a key, and what is required is asked for only of a
/// file that extends none.
enum class Extending { never, possible };

/// JSON Schema (2020-12) of a kind of file. References by name, dimensions of units and keys that exclude each other are left to
/// the reader.
[[nodiscard]] std::string json_schema(const KeyTable& keys, std::string_view title, Extending extending);

} // namespace kluft

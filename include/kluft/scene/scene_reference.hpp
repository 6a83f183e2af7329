// The scene format written out: a page for people and a JSON Schema for editors. Both come from the table of keys.
#pragma once

#include <string>

namespace kluft {

/// The page docs/scene.md. A test compares the two; with KLUFT_WRITE_DOCS=1 in the environment it writes the page anew.
[[nodiscard]] std::string scene_reference_markdown();

/// JSON Schema (2020-12) of a scene file. Required keys are asked for only where a file extends no other one; references
/// by name, dimensions of units and keys that exclude each other are left to the reader.
[[nodiscard]] std::string scene_json_schema();

} // namespace kluft

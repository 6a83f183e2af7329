// The scene format written out: a page for people, made from the table of keys.
#pragma once

#include <string>

namespace kluft {

/// The page docs/scene.md. A test compares the two; with KLUFT_WRITE_DOCS=1 in the environment it writes the page anew.
[[nodiscard]] std::string scene_reference_markdown();

} // namespace kluft

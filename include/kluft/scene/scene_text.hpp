// From files and overrides to one merged tree.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// Whether all of `text` is UTF-8 without control characters other than tab and line ends.
[[nodiscard]] bool is_scene_text(std::string_view text);

/// Whether the bytes are characters in UTF-8, whichever.
[[nodiscard]] bool is_utf8(std::string_view text);

/// The bytes of a scene or of another file of keys, which `what` names as in "a scene": at most 1 MB of text. Throws
/// InputError for what is missing, no file, too large or binary.
[[nodiscard]] std::string read_scene_bytes(const std::filesystem::path& file, std::string_view what = "a scene");

/// Parses a scene's text, merges it over what it extends (whose file names are relative to its own) and applies
/// overrides. What is wrong goes to `errors`; missing or binary files throw InputError at once.
[[nodiscard]] SceneNode build_scene_tree(std::string_view text, const std::filesystem::path& file,
                                         const std::vector<std::string>& overrides, SceneSources& sources,
                                         SceneErrors& errors);

} // namespace kluft

// Reads a scene: YAML text, checked against the schema, to values in SI.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/scene/scene.hpp"

namespace kluft {

/// Reads a scene file, the files that it extends, and then applies overrides "key.path=value" (mappings by key, lists
/// by index from 0, the value as YAML). Angles become radians, clockwise domains counter-clockwise.
/// Throws InputError with one message for each thing that is wrong:
/// "file:line:column: key.path: expected ..., found ...; did you mean '...'?" and the offending line below.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same for a scene that is already in memory. `file` gives the scene's name, its place in messages and the
/// directory that relative paths start from.
[[nodiscard]] Scene read_scene_text(std::string_view text, const std::vector<std::string>& overrides = {},
                                    const std::filesystem::path& file = "scene.yaml");

} // namespace kluft

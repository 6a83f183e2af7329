// Writes a scene's tree as YAML again.
#pragma once

#include <string>
#include <string_view>

#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// The merged tree as one YAML text without `extends`, names of geometry files absolute: reading it gives the same
/// scene wherever the text lies.
[[nodiscard]] std::string write_scene_tree(const SceneNode& root, const SceneSources& sources);

/// For people: each item of a list of mappings has a line of its own. `written` is the tree of what write_scene_tree wrote.
[[nodiscard]] std::string write_readable_scene(const SceneNode& written);

/// Whether the value at a path such as geometry.fractures.0.file is the name of a file.
[[nodiscard]] bool names_geometry_file(std::string_view path);

/// A value on one line, as an override takes it: 0.5, "25 MPa", [0, 1], {spacing: 0.1}.
[[nodiscard]] std::string write_scene_value(const SceneNode& value);

} // namespace kluft

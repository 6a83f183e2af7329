// Writes a scene's tree as YAML again.
#pragma once

#include <string>

#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// The merged tree as one YAML text without `extends`, names of geometry files absolute: reading it gives the same
/// scene wherever the text lies.
[[nodiscard]] std::string write_scene_tree(const SceneNode& root, const SceneSources& sources);

/// A value on one line, as an override takes it: 0.5, "25 MPa", [0, 1], {spacing: 0.1}.
[[nodiscard]] std::string write_scene_value(const SceneNode& value);

} // namespace kluft

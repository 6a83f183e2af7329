// Where the keys of a scene stand, for what is found to be wrong once its body is built.
#pragma once

#include <string>
#include <vector>

#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// A key of a scene file, or of an override.
struct KeyPlace {
    std::string path;  ///< "materials.rock.cohesion"
    std::string place; ///< of its value: "scene.yaml:12:5", or the override
    std::string text;  ///< the line there; "" for an override
    std::string file;  ///< "" for an override
    int line = 0;      ///< from 1; 0 for an override
    int column = 0;
};

/// The keys of a scene but those of its lists of fractures, blocks and the like: of lists only the stages.
[[nodiscard]] std::vector<KeyPlace> key_places(const SceneNode& root, const SceneSources& sources);

/// The same error with the places of the keys that its messages begin with, "materials.rock.poissons_ratio: ...". A key that
/// the scene leaves to its default stands where what it is a key of does. Messages that begin otherwise stay as they are.
[[nodiscard]] InputError located(const InputError& error, const std::vector<KeyPlace>& places);

/// A warning with the place of the key that it begins with before it; as it is where it begins otherwise.
[[nodiscard]] std::string located(const std::string& warning, const std::vector<KeyPlace>& places);

} // namespace kluft

// Checks a scene's tree against the schema.
#pragma once

#include <string>

#include "kluft/scene/scene_schema.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

/// "'25 m'", "a list of 3", "nothing": what a message says was found.
[[nodiscard]] std::string found_text(const SceneNode& node);

/// "" if the value of a number, integer, boolean, text or choice is what the rule asks for, else what was found.
[[nodiscard]] std::string scalar_problem(const SceneNode& node, const KeyRule& rule);

/// Refuses decimal commas between braces, where YAML takes `{value: 0,5 %}` for a value of 0 and a key '5 %', and puts the number
/// together as it is meant, so that nothing else is said of it.
void refuse_decimal_commas(SceneNode& root, SceneErrors& errors);

/// Checks keys, types, units, ranges and required keys of a whole scene.
void check_against_schema(const SceneNode& root, SceneErrors& errors);

} // namespace kluft

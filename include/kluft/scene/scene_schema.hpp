// The one table of all keys of a scene. It drives validation, docs/scene.md and the JSON Schema.
#pragma once

#include "kluft/scene/key_table.hpp"

namespace kluft {

/// All keys of a scene.
[[nodiscard]] const KeyTable& scene_schema();

} // namespace kluft

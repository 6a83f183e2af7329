// The table of all keys of a study file. It drives the reader's checks and the JSON Schema.
#pragma once

#include "kluft/scene/key_table.hpp"

namespace kluft {

/// All keys of a study.
[[nodiscard]] const KeyTable& study_schema();

} // namespace kluft

// Reads the supports and the stages of a scene.
#pragma once

#include <string>
#include <vector>

#include "kluft/loading/load_program.hpp"
#include "kluft/scene/reading_context.hpp"

namespace kluft {

/// `root` is the whole scene; `boundaries` are the names of the geometry's boundaries, none if the domain could not be
/// read (then references to boundaries are not checked); `blocks` are the names of its sets and given blocks, `interfaces`
/// those of the interface types. `has_gravity`: of the analysis.
[[nodiscard]] LoadProgram read_loads(const SceneSection& root, const std::vector<std::string>& boundaries,
                                     const std::vector<std::string>& blocks, const std::vector<std::string>& interfaces,
                                     bool has_gravity, ReadingContext& context);

} // namespace kluft

// A run as its directory of results has it.
#pragma once

#include <filesystem>

#include "kluft/scene/scene.hpp"
#include "kluft/scene/scene_model.hpp"

namespace kluft {

/// Throws InputError where there is no saved state in a directory of results: of a run that has saved none yet, or of none.
void require_saved_state(const std::filesystem::path& directory);

/// The scene and the body of a run.
struct RunOfResults {
    Scene scene;
    SceneModel built;
};
/// From the last saved state in a directory of results. Throws InputError without one, and where the body is not the one that the
/// results are of any more, because a map that the scene reads has changed.
[[nodiscard]] RunOfResults run_of_results(const std::filesystem::path& directory);

} // namespace kluft

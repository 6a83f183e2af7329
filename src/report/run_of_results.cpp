#include "kluft/report/run_of_results.hpp"

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/fingerprint.hpp"

namespace kluft {

void require_saved_state(const std::filesystem::path& directory) {
    if (std::filesystem::exists(directory / "state.h5")) return;
    if (std::filesystem::exists(directory / "history.csv"))
        throw InputError(directory.string() +
                         ": expected a run that has saved a state, found one that has saved none yet (no state.h5)");
    throw InputError(directory.string() +
                     ": expected a directory of results, found no state.h5 in it, which has the scene as run");
}

RunOfResults run_of_results(const std::filesystem::path& directory) {
    require_saved_state(directory);
    const std::filesystem::path saved = directory / "state.h5";
    RunOfResults run;
    run.scene = read_scene_text(read_state_scene(saved), {}, saved);
    if (const std::string difference = difference_from_scene_file(directory, run.scene); !difference.empty())
        throw InputError(
            fmt::format("{}: expected a state of the run whose scene.yaml lies beside it, found one of another: {}",
                        saved.string(), difference));
    run.built = build_scene_model(run.scene);
    if (fingerprint(run.built.model) != read_state_fingerprint(saved))
        throw InputError(directory.string() +
                         ": expected the body that the results are of, found another one: a file of the "
                         "geometry has changed since the run");
    return run;
}

} // namespace kluft

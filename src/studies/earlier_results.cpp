#include "kluft/studies/earlier_results.hpp"

#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/run_writer.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

fs::path scene_file(const fs::path& directory) { return directory / "scene.yaml"; }

/// The scene that is saved with a state.
std::optional<std::string> scene_of_state_in(const fs::path& directory) {
    try {
        return read_state_scene(directory / "state.h5");
    } catch (const InputError&) {
        return std::nullopt;
    }
}

[[noreturn]] void refuse(const fs::path& directory, const std::string& found) {
    throw InputError(
        fmt::format("{}: expected results of this scene or none, found {}; --force replaces them, --resume "
                    "goes on with the scene that they are of, -o names another directory",
                    directory.string(), found));
}

} // namespace

void require_no_other_results(const fs::path& directory, const Scene& scene) {
    std::optional<std::string> earlier = scene_as_run_in(directory);
    if (!earlier) {
        const std::string result = first_result_in(directory);
        if (result.empty()) return;
        earlier = scene_of_state_in(directory);
        if (!earlier) refuse(directory, result + " and no scene.yaml that says what it is of");
    }
    const std::string difference = scene_difference(*earlier, scene);
    if (!difference.empty()) refuse(directory, "results of another one: " + difference);
}

void require_no_run_in(const fs::path& directory) {
    std::error_code error;
    if (fs::exists(directory / "history.csv", error))
        throw InputError(directory.string() +
                         ": expected another directory than that of a run, found a history.csv in it; "
                         "-o names another one");
}

void require_no_foreign_file(const fs::path& directory, const std::vector<std::string>& names,
                             const std::string& writer, const std::string& way_out) {
    std::error_code error;
    for (const std::string& name : names)
        if (fs::exists(fs::symlink_status(directory / name, error)))
            throw InputError(
                fmt::format("{}: expected a {} that {} wrote or none, found another one, which would be lost; {}",
                            (directory / name).string(), name, writer, way_out));
}

bool has_own_scene_file(const fs::path& directory, const Scene& scene) {
    const fs::path file = scene_file(directory);
    std::error_code error;
    const fs::file_status status = fs::symlink_status(file, error);
    if (!fs::exists(status)) return false;
    if (!fs::is_symlink(status) && scene_as_run_in(directory)) return false;
    try {
        const Scene own = read_scene(file);
        if (own.title == scene.title && scene_difference(own.text, scene).empty()) return true;
    } catch (const InputError&) {
        // another one, whatever it says
    }
    throw InputError(file.string() +
                     ": expected a scene.yaml that a run wrote or none, found another one, which would be "
                     "lost; neither --force nor --resume replaces it: remove it, or choose another directory with -o");
}

} // namespace kluft

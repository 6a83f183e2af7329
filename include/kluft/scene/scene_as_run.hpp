// scene.yaml in a directory of results: the scene as run, by which a later run tells whether it is the same one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/scene/scene.hpp"

namespace kluft {

/// The text of scene.yaml: every key as it was written, with extended scenes and overrides merged and names of geometry
/// files absolute, so that reading it gives the same scene wherever it lies. A scene without a title gets its name as one.
/// A comment holds the digest of what it says and of the files' content.
[[nodiscard]] std::string write_scene_as_run(const Scene& scene);

/// The files that the geometry of the scene is read from, as their names stand in it once it has been read: absolute.
[[nodiscard]] std::vector<std::string> geometry_files(const Scene& scene);

/// Whether write_scene_as_run wrote the text.
[[nodiscard]] bool is_scene_as_run(std::string_view text);

/// The text of scene.yaml in a directory of results; nothing where no run wrote one there.
[[nodiscard]] std::optional<std::string> scene_as_run_in(const std::filesystem::path& directory);

/// What differs between an earlier scene and this one, "stages.1.steps is '200' there and '400' here"; "" where they are
/// the same. `earlier` is what write_scene_as_run wrote, or the `text` of a scene, whose files are then taken as they are
/// now. Values count as they are written, files by their content; comments, the order of keys, the place of files and a
/// title that only one of the two has do not count.
[[nodiscard]] std::string scene_difference(std::string_view earlier, const Scene& scene);

/// The first key of the body, its loads and its laws whose value differs between the text of an earlier scene and this one, as
/// above; "" where there is none. Keys of `solver`, `cracks` and `output`, and where a stage stops, change with a run that goes on.
[[nodiscard]] std::string body_difference(std::string_view earlier, const Scene& scene);

/// The same for the scene.yaml in a directory of results and the scene of the state that is saved there; "" without scene.yaml.
[[nodiscard]] std::string difference_from_scene_file(const std::filesystem::path& directory, const Scene& of_state);

} // namespace kluft

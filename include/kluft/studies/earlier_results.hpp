// What a directory holds before a run writes its results into it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/scene/scene.hpp"

namespace kluft {

/// Throws InputError, which names --force and --resume, where the directory has results of another scene, or results that
/// do not say of which scene they are. Changes nothing.
void require_no_other_results(const std::filesystem::path& directory, const Scene& scene);

/// Throws InputError where the directory is that of a run, whose files those of a study or calibration would stand among.
void require_no_run_in(const std::filesystem::path& directory);

/// Throws InputError where one of the files stands in the directory, in which nothing says that the writer ("a study") has left it.
/// `way_out`: what the user may do instead.
void require_no_foreign_file(const std::filesystem::path& directory, const std::vector<std::string>& names,
                             const std::string& writer, const std::string& way_out);

/// Whether scene.yaml in the directory is a file of the user's own that says the same scene, so that it can stay as it is;
/// not where there is none, or one that a run wrote. Throws InputError where it is of the user's own and says another scene.
[[nodiscard]] bool has_own_scene_file(const std::filesystem::path& directory, const Scene& scene);

} // namespace kluft

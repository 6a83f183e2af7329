// Studies that come with the program, made for a scene.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kluft {

/// The words that name them on the command line.
[[nodiscard]] std::vector<std::string> ready_made_names();

/// The text of the study file. `overrides` are laid on the scene when it is looked at, as they will be in the study.
/// Throws InputError for a scene that is wrong, or without a stage.
[[nodiscard]] std::string ready_made_study(const std::string& name, const std::filesystem::path& scene,
                                           const std::vector<std::string>& overrides = {});

/// Whether a file has the text of a ready-made study; false where there is none.
[[nodiscard]] bool is_ready_made(const std::filesystem::path& file);

/// 25, 50, ..., 800 load steps, and as many as the scene has, of the last stage that moves a platen or reduces strengths, or else of the last stage.
[[nodiscard]] std::string step_size_study(const std::filesystem::path& scene,
                                          const std::vector<std::string>& overrides = {});

} // namespace kluft

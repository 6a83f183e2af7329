// A run as its directory of results has it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "kluft/output/curve_picture.hpp"

namespace kluft {

/// What is known of a run besides its tables; a killed run has no summary.
struct RunHeading {
    std::string title;
    std::optional<int> platen_stage;
};

[[nodiscard]] RunHeading heading_of(const std::filesystem::path& directory);

/// Of a run that has ended.
[[nodiscard]] bool moves_no_platen(const std::filesystem::path& directory);

[[nodiscard]] RunCurve read_curve(const std::filesystem::path& directory, const std::string& label);

/// Tells of a table that ends before the summary of its run does: its last row was cut off, or rows are lost.
void warn_of_missing_rows(const std::filesystem::path& directory);

/// Of the states that a run keeps, the one that `text` asks for: a load step, "peak", "last" or "" for it. Tells where the
/// peak itself is not kept. Throws InputError for one that is not kept.
[[nodiscard]] int step_asked_for(const std::string& text, const std::filesystem::path& directory);

} // namespace kluft

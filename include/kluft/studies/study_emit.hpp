// Files with which something else than Kluft runs the cases of a study.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "kluft/studies/study.hpp"

namespace kluft {

/// Names of the files that emit_study writes for a format ("slurm", "make").
[[nodiscard]] std::vector<std::string> emitted_files(const std::string& format);

/// A job array over the lines of cases.txt, at most `jobs` at once.
[[nodiscard]] std::string slurm_script(const ReadStudy& read, const std::filesystem::path& directory, int jobs);

/// A makefile with one target per case, its ended file; the last target runs `collect`.
[[nodiscard]] std::string study_makefile(const ReadStudy& read, const std::vector<std::string>& collect);

/// The script that both call with the number of a line of cases.txt: it runs that line, from a saved state where there
/// is one, and leaves beside the results how that ended.
[[nodiscard]] std::string case_script();

/// Writes run-case and what `format` (slurm, make) names into the study's directory. Returns the commands to type next.
/// Throws InputError for another format, ResourceError.
[[nodiscard]] std::string emit_study(const std::string& format, const ReadStudy& read,
                                     const std::filesystem::path& directory, int jobs,
                                     const std::vector<std::string>& collect);

} // namespace kluft

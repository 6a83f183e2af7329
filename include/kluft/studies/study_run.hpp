// Runs the cases of a study in processes of their own, as many at once as wanted.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kluft/studies/study.hpp"
#include "kluft/studies/study_table.hpp"

namespace kluft {

/// Where a study stands.
struct StudyProgress {
    std::size_t n_cases = 0;
    std::size_t n_ended = 0; ///< done, no equilibrium, refused
    std::size_t n_running = 0;
    std::size_t n_failed = 0;
    std::optional<double> seconds_left; ///< from the pace of the load steps so far
};

/// "12 of 40 cases ended, 2 running, 1 failed, left 3 min 20 s".
[[nodiscard]] std::string study_progress_text(const StudyProgress& progress);

struct StudyRunOptions {
    std::filesystem::path program; ///< kluft itself
    int jobs = 1;
    std::function<void(const StudyProgress&)> show; ///< called often
};

/// The command line of a case: the program, its words, not quoted.
[[nodiscard]] std::vector<std::string> case_command(const ReadStudy& read, const PlannedCase& one,
                                                    const std::filesystem::path& program,
                                                    const std::filesystem::path& directory);

/// Throws InputError where the text has a line break, which cases.txt and the scripts of schedulers cannot hold. `what` it is.
void require_one_line(const std::string& what, const std::string& text);

/// Makes the directories of all cases that can be run and writes cases.txt, a command line for each of them. Throws
/// InputError for a line break in a command.
void prepare_study(const ReadStudy& read, const std::filesystem::path& program, const std::filesystem::path& directory);

/// Runs what has not ended yet, one process each; a case that was interrupted goes on from its saved state. Rewrites
/// study.csv as cases end. When `stop` becomes true the running cases save their states and end. Throws ResourceError.
[[nodiscard]] StudyTable run_study(const ReadStudy& read, const std::filesystem::path& directory,
                                   const StudyRunOptions& options, const std::atomic<bool>& stop);

/// The table of what stands in the directory.
[[nodiscard]] StudyTable collect_study(const ReadStudy& read, const std::filesystem::path& directory);

/// Writes study.csv. Throws ResourceError.
void write_study_table(const StudyTable& table);

} // namespace kluft

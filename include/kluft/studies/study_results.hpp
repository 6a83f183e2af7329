// What the cases of a study have left in its directory, as a table.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/studies/study.hpp"
#include "kluft/studies/study_table.hpp"

namespace kluft {

/// How the program that ran a case ended: outcome.json in the directory of the case.
struct CaseOutcome {
    int exit_code = -1; ///< -1 if a signal ended it
    int signal = 0;
    bool out_of_time = false;
    std::optional<double> cpu_s; ///< of all attempts (s)
    std::optional<double> elapsed_s;
};

/// What a case has come to.
struct CaseResult {
    CaseStatus status = CaseStatus::waiting;
    std::string reason;
    bool out_of_resources = false; ///< failed for lack of disk or memory
    std::vector<std::optional<double>> quantities;
    std::vector<Vec2> curve; ///< differential stress over axial strain
    std::optional<double> cpu_s;
    std::optional<double> elapsed_s;

    /// Whether it is not run again.
    [[nodiscard]] bool ended() const {
        return status == CaseStatus::done || status == CaseStatus::no_equilibrium || status == CaseStatus::refused;
    }
};

[[nodiscard]] std::filesystem::path case_directory(const std::filesystem::path& study_directory,
                                                   const PlannedCase& one);

/// The scene of a study as case.json names it: by its way from the directory of the study.
[[nodiscard]] std::string noted_scene(const std::filesystem::path& scene, const std::filesystem::path& directory);

/// Throws InputError, which names --force, where the directory has cases of a study of another scene, results of a case from before its
/// scene or settings were changed, or what no study has made where this one would write: its table, report and cases, and the
/// files with `further` names.
void require_no_other_study(const ReadStudy& read, const std::filesystem::path& directory,
                            const std::vector<std::string>& further = {});

/// What `--set` says in the run of a case ("key.path=value").
[[nodiscard]] std::vector<std::string> run_settings(const ReadStudy& read, const PlannedCase& one);

/// Removes the cases of a study of another scene from the directory.
void remove_other_study(const ReadStudy& read, const std::filesystem::path& directory);

/// Makes the directory of a case and writes case.json (scene, settings and digest) into it, unless that stands there already;
/// what an earlier case of this name with other settings or another scene left is removed. Throws ResourceError.
void prepare_case(const std::filesystem::path& directory, const PlannedCase& one, const std::string& scene);

void write_outcome(const std::filesystem::path& directory, const CaseOutcome& outcome);
[[nodiscard]] std::optional<CaseOutcome> read_outcome(const std::filesystem::path& directory);

/// What stands in the directory of a case. Results of other settings or of another scene do not count.
[[nodiscard]] CaseResult read_case(const Study& study, const PlannedCase& one, const std::filesystem::path& directory);

/// Of all cases.
[[nodiscard]] std::vector<CaseResult> read_cases(const ReadStudy& read, const std::filesystem::path& directory);

/// Puts the results together and compares them with the reference.
[[nodiscard]] StudyTable study_table(const ReadStudy& read, const std::vector<CaseResult>& results,
                                     const std::filesystem::path& directory);

[[nodiscard]] std::string case_status_name(CaseStatus status);

/// The table as CSV: case, variant, one column per parameter, replica, status, one per quantity, error_<quantity>,
/// curve_error, cpu_s, elapsed_s, reason. What is not known is empty.
[[nodiscard]] std::string study_csv(const StudyTable& table);

} // namespace kluft

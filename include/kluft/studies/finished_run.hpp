// What a run left in its directory, read back as far as it is there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/output/summary.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Throws InputError that names the nearest directory or file unless `directory` is one with a history.csv in it.
void require_results(const std::filesystem::path& directory);

struct FinishedRun {
    std::string name;
    std::filesystem::path directory;
    std::vector<StepRecord> history;                ///< at least one row
    std::vector<StepRecord> equilibria;             ///< empty without equilibria.csv
    std::optional<std::vector<CrackRecord>> cracks; ///< none without cracks.csv
    std::optional<RunSummary> summary;              ///< none of a killed run
    std::optional<Model> model;                     ///< none without a scene in state.h5 that can be read
    std::optional<int> platen_stage;                ///< the first stage that moves a platen
    CurveNumbers numbers;                           ///< from the summary, or else from the rows
    std::vector<std::string> notes;                 ///< what is missing and why

    /// The rows in which peaks are looked for.
    [[nodiscard]] const std::vector<StepRecord>& fine_rows() const { return equilibria.empty() ? history : equilibria; }
};

/// In words, which table of a run ends before its summary does, or is not there; "" where both are whole. A run that goes on, or was
/// killed, has more rows than its summary says.
[[nodiscard]] std::string missing_rows(const std::vector<StepRecord>& history,
                                       const std::vector<StepRecord>& equilibria, const RunSummary& summary);

/// Reads a run. Its tables may lack columns other than step, stage, axial strain, axial and differential stress.
/// Throws InputError for what is no directory of results, an empty history and damaged tables or summary.
[[nodiscard]] FinishedRun read_finished_run(const std::filesystem::path& directory, const std::string& name);

} // namespace kluft

// The rows of history.csv, equilibria.csv, cracks.csv, jumps.csv and histories.csv.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// Column names of history.csv and equilibria.csv, separated by commas: the members of StepRecord in order.
/// Stresses (Pa) and strains (fractions) are positive in compression.
[[nodiscard]] std::string history_header();
/// Names of the further columns that the rows of an explicit run have: the members of MotionRecord in order.
[[nodiscard]] std::string motion_header();
/// Column names of cracks.csv: the members of CrackRecord in order; `mode` is `tension` or `shear`.
[[nodiscard]] std::string cracks_header();
/// Column names of jumps.csv: the members of JumpRecord in order.
[[nodiscard]] std::string jumps_header();

/// A row without the end of the line. Numbers have 17 significant digits, so that they are read back exactly;
/// booleans are 0 or 1.
[[nodiscard]] std::string table_row(const StepRecord& record);
[[nodiscard]] std::string table_row(const CrackRecord& crack);
[[nodiscard]] std::string table_row(const JumpRecord& jump);

/// The same for histories.csv: step, stage, load_factor and the columns of the scene.
[[nodiscard]] std::string histories_header(const std::vector<std::string>& columns);
[[nodiscard]] std::string histories_row(const StepRecord& record);

/// histories.csv as it was read: of each row step, stage, load_factor and histories.
struct HistoriesTable {
    std::vector<std::string> columns; ///< of StepRecord::histories
    std::vector<StepRecord> rows;
};

/// Reads history.csv or equilibria.csv, with the strength factor where that column is. Columns may stand in any order and
/// further ones are ignored; so is a last line without its end, which a killed run may leave. Throws InputError (file:line: column: expected, found).
[[nodiscard]] std::vector<StepRecord> read_history(const std::filesystem::path& path);
/// The same where only the columns `needed` must be there; numbers of missing ones keep their defaults.
[[nodiscard]] std::vector<StepRecord> read_history(const std::filesystem::path& path,
                                                   const std::vector<std::string_view>& needed);
/// Reads histories.csv. Throws InputError.
[[nodiscard]] HistoriesTable read_histories(const std::filesystem::path& path);
/// Reads cracks.csv. Throws InputError.
[[nodiscard]] std::vector<CrackRecord> read_cracks(const std::filesystem::path& path);

} // namespace kluft

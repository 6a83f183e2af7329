// Peaks of tests for a strength envelope: from directories of results and from tables of tests made elsewhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/constitutive/strength_fit.hpp"

namespace kluft {

/// The peak of a finished run: from equilibria.csv or history.csv; from summary.json whether it ended unbalanced and whether
/// its net locked (a missing key means no). Throws InputError for what is no directory of results, damaged files, tables
/// that lack rows of the run (missing_rows) and a run without a balanced equilibrium.
[[nodiscard]] PeakPoint read_peak(const std::filesystem::path& directory, const std::string& run);

/// A table of comma-separated values with a line of column names, in any order:
///   sigma_3, sigma_1                   principal stresses at failure, positive in compression, in Pa or in the unit of
///                                      the name: `sigma_1 (MPa)`; a tension test has sigma_1 = 0, sigma_3 = -sigma_t
///   run                                name; else that of the file with the number of the row
///   peak_reached, balanced, net_locked, unloaded, moves_platen
///                                      0 or 1 (false, true); what is missing or empty is that of a strength
/// Other columns do not matter, unless one looks like a missing one of these. The table that envelope_csv writes is one.
/// Throws InputError with every flaw by file, line and column: a missing column, a cell that is no such value, sigma_1
/// below sigma_3, a stress beyond 1e15 Pa, no row.
[[nodiscard]] std::vector<PeakPoint> read_strength_table(const std::filesystem::path& path);

} // namespace kluft

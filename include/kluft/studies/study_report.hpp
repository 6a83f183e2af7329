// The report of a study: tables, plots and what follows from them in words.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/studies/study_table.hpp"

namespace kluft {

struct StudyReportOptions {
    std::string quantity;                         ///< that is recommended for; empty: the first of the table
    std::vector<double> bounds{0.05, 0.02, 0.01}; ///< errors for which the cheapest settings are looked for
};

/// Writes study.md, study.html (with its pictures inside) and the pictures as PNG and SVG into the directory, and
/// removes those of an earlier report. Reads the histories and summaries below table.directory/cases as far as they are
/// there. What makes no sense for the table is left out: no error without a reference, no convergence without a series,
/// no band without replicas. Throws InputError for a quantity that the table does not have, ResourceError.
void write_study_report(const StudyTable& table, const std::filesystem::path& directory,
                        const StudyReportOptions& options = {});

/// Names of the pictures of a report in the directory, ascending: those that write_study_report removes first.
[[nodiscard]] std::vector<std::string> study_pictures_in(const std::filesystem::path& directory);

} // namespace kluft

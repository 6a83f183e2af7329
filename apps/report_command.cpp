// kluft report DIR... [-o FILE.html]
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/report/report_page.hpp"
#include "kluft/report/run_page.hpp"
#include "kluft/studies/finished_run.hpp"
#include "results_run.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

void check_output(const ReportArguments& arguments) {
    if (arguments.output.empty()) return;
    if (arguments.directories.size() > 1)
        throw InputError(fmt::format("--output: expected one directory of results beside it, found {}",
                                     arguments.directories.size()));
    if (fs::path(arguments.output).extension() != ".html")
        throw InputError("--output: expected a name that ends in .html, found " + arguments.output);
    require_possible_output(arguments.output);
    require_directory_of(arguments.output);
    require_own_file(arguments.output, "a page", is_report_page);
}

} // namespace

ExitCode report(const ReportArguments& arguments) {
    check_output(arguments);
    for (const std::string& directory : arguments.directories) require_results(directory);
    for (const std::string& directory : arguments.directories) {
        const fs::path file =
            arguments.output.empty() ? fs::path(directory) / "report.html" : fs::path(arguments.output);
        warn_of_missing_rows(directory);
        write_run_page(directory, file);
        say("{}\n", file.string());
    }
    return ExitCode::done;
}

} // namespace kluft

// kluft compare DIR DIR
#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/studies/comparison.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

double tolerance_of(const std::string& text) {
    const QuantityReading reading = read_quantity(text, Measure::fraction);
    if (!reading.value || !(*reading.value >= 0.0))
        throw InputError(
            fmt::format("--tolerance: expected a fraction of 0 or more as in 0.05 or '5 %', found '{}'", text));
    return *reading.value;
}

/// Where the comparison goes unless the command line says so.
fs::path default_directory(const std::vector<std::string>& directories) {
    return fs::path("results") /
           fmt::format("compare-{}-{}", run_name(directories.front()), run_name(directories.back()));
}

} // namespace

ExitCode compare(const CompareArguments& arguments) {
    require_possible_output(arguments.output);
    const double tolerance = tolerance_of(arguments.tolerance);
    const fs::path directory =
        arguments.output.empty() ? default_directory(arguments.directories) : fs::path(arguments.output);
    require_no_file(directory);
    require_no_other_comparison(directory);
    const auto names = run_names(arguments.directories);
    for (const auto& name : arguments.directories) require_results(name);
    const FinishedRun a = read_finished_run(arguments.directories.front(), names.front());
    const FinishedRun b = read_finished_run(arguments.directories.back(), names.back());
    Comparison comparison = compare_runs(a, b, tolerance);
    write_comparison(directory, a, b, comparison);
    say("{}{}\n", comparison_text(comparison.table), (directory / "compare.md").string());
    return comparison.table.agree ? ExitCode::done : ExitCode::missed;
}

} // namespace kluft

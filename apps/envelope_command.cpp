// kluft envelope DIR|TABLE.csv...
#include <algorithm>
#include <filesystem>
#include <numbers>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/output/envelope.hpp"
#include "kluft/output/run_writer.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/studies/strength_tests.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

/// "LABEL=C,PHI", e.g. "published=0.118 MPa, 39.6 deg".
NamedEnvelope named_envelope(const std::string& text) {
    const auto equals = text.rfind('=');
    const auto comma = text.find(',', equals == std::string::npos ? 0 : equals);
    if (equals != std::string::npos && equals > 0 && comma != std::string::npos) {
        const auto cohesion = read_quantity(text.substr(equals + 1, comma - equals - 1), Measure::stress).value;
        const auto angle = read_quantity(text.substr(comma + 1), Measure::angle).value;
        if (cohesion && angle && *cohesion >= 0.0 && *angle >= 0.0 && *angle < 0.5 * std::numbers::pi)
            return {text.substr(0, equals), {*cohesion, *angle}};
    }
    throw InputError(
        fmt::format("--compare: expected LABEL=COHESION,ANGLE as in 'published=0.118 MPa, 39.6 deg', found "
                    "'{}'",
                    text));
}

/// A strength found elsewhere by pulling or splitting: sigma_1 = 0, sigma_3 = -sigma_t.
PeakPoint tension_test(const std::string& text) {
    const auto strength = read_quantity(text, Measure::stress).value;
    if (!strength || !(*strength > 0.0))
        throw InputError(
            fmt::format("--tension: expected a tensile strength above zero as in '0.12 MPa', found '{}'", text));
    return {.run = "tension " + text, .sigma_3 = -*strength};
}

/// The picture, and the table and the numbers beside it.
std::vector<fs::path> files_of(const fs::path& picture) {
    return {picture, fs::path(picture).replace_extension(".csv"), fs::path(picture).replace_extension(".json")};
}

/// The picture, or a table or numbers beside it, that are of something else.
void require_own_files(const std::vector<fs::path>& files) {
    std::error_code ignored;
    const auto refuse = [](const fs::path& file) {
        throw InputError(
            fmt::format("-o: {} is no file of an envelope and would be overwritten; expected another name, or none "
                        "beside it with this one",
                        file.string()));
    };
    if (files[0].extension() == ".png" && fs::is_regular_file(files[0], ignored) && !is_drawn_png(read_file(files[0])))
        refuse(files[0]);
    if (fs::is_regular_file(files[1], ignored) && !is_envelope_csv(read_file(files[1]))) refuse(files[1]);
    if (fs::is_regular_file(files[2], ignored) && !is_envelope_json(read_file(files[2]))) refuse(files[2]);
}

/// None of the files may take the place of a table that they are made from, or of a result of a run.
void keep_tests(const std::vector<fs::path>& files, const std::vector<std::string>& sources) {
    std::error_code ignored;
    const auto results = result_names();
    for (const fs::path& file : files) {
        for (const auto& source : sources)
            if (fs::equivalent(file, source, ignored))
                throw InputError(fmt::format(
                    "-o: {} is one of the tests and would be overwritten; expected another name", file.string()));
        const bool is_of_run = fs::exists(file.parent_path() / "history.csv", ignored) &&
                               std::ranges::find(results, file.filename().string()) != results.end();
        if (is_of_run && fs::exists(file, ignored))
            throw InputError(fmt::format(
                "-o: {} is a result of the run in that directory and would be overwritten; expected another name",
                file.string()));
    }
}

/// The peaks of a directory of results or of a table.
void add_peaks(const fs::path& source, std::vector<PeakPoint>& peaks) {
    const bool is_table = source.extension() == ".csv" && !fs::is_directory(source);
    if (!is_table && fs::is_regular_file(source))
        throw InputError(source.string() +
                         ": expected a directory of results or a table of tests (.csv), found another file");
    if (!is_table) {
        peaks.push_back(read_peak(source, run_name(source)));
        if (!fs::exists(source / "summary.json"))
            tell("{} has no summary.json: its peak is that of its tables\n", source.string());
        return;
    }
    if (!fs::exists(source)) throw InputError(source.string() + ": expected a table of tests, found no such file");
    for (PeakPoint& peak : read_strength_table(source)) peaks.push_back(std::move(peak));
}

} // namespace

ExitCode envelope(const EnvelopeArguments& arguments) {
    require_possible_output(arguments.picture);
    require_directory_of(arguments.picture);
    std::vector<NamedEnvelope> others;
    for (const auto& text : arguments.others) others.push_back(named_envelope(text));
    std::vector<PeakPoint> peaks;
    for (const auto& source : arguments.sources) add_peaks(source, peaks);
    for (const auto& text : arguments.tension) peaks.push_back(tension_test(text));
    const StrengthFit fit = fit_strength(peaks);
    const auto files = files_of(arguments.picture);
    keep_tests(files, arguments.sources);
    require_own_files(files);
    write_envelope(files[0], arguments.title, peaks, fit, others);
    write_file(files[1], envelope_csv(peaks, fit));
    write_file(files[2], envelope_json(peaks, fit));
    say("{}{}\n", envelope_text(peaks, fit), files[0].string());
    return ExitCode::done;
}

} // namespace kluft

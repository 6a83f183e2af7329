// kluft envelope DIR...
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/envelope.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/studies/finished_run.hpp"

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

} // namespace

ExitCode envelope(const EnvelopeArguments& arguments) {
    std::vector<NamedEnvelope> others;
    for (const auto& text : arguments.others) others.push_back(named_envelope(text));
    std::vector<PeakPoint> peaks;
    for (const auto& name : arguments.directories) {
        const fs::path directory = name;
        require_results(directory);
        const fs::path table =
            fs::exists(directory / "equilibria.csv") ? directory / "equilibria.csv" : directory / "history.csv";
        peaks.push_back(peak_point(run_name(directory), read_history(table)));
    }
    const Envelope fit = fit_envelope(peaks);
    const fs::path picture = arguments.picture;
    write_envelope(picture, arguments.title, peaks, fit, others);
    fs::path table = picture;
    write_file(table.replace_extension(".csv"), envelope_csv(peaks, fit));
    fmt::print("{}{}\n", envelope_text(peaks, fit), picture.string());
    return ExitCode::done;
}

} // namespace kluft

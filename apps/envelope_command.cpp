// kluft envelope DIR...
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/envelope.hpp"
#include "kluft/output/history_table.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

struct EnvelopeArguments {
    std::vector<std::string> directories;
    std::string picture = "envelope.png";
};

ExitCode envelope(const EnvelopeArguments& arguments) {
    std::vector<PeakPoint> peaks;
    for (const auto& name : arguments.directories) {
        const fs::path directory = name;
        if (!fs::is_directory(directory)) {
            throw InputError(name + ": expected a directory of results, found " +
                             (fs::exists(directory) ? "a file" : "nothing"));
        }
        const fs::path table =
            fs::exists(directory / "equilibria.csv") ? directory / "equilibria.csv" : directory / "history.csv";
        peaks.push_back(peak_point(directory.filename().string(), read_history(table)));
    }
    const Envelope fit = fit_envelope(peaks);
    const fs::path picture = arguments.picture;
    write_envelope(picture, "Strength envelope", peaks, fit);
    fs::path table = picture;
    write_file(table.replace_extension(".csv"), envelope_csv(peaks, fit));
    fmt::print("{}{}\n", envelope_text(peaks, fit), picture.string());
    return ExitCode::done;
}

} // namespace

void add_envelope_command(CLI::App& app, std::function<ExitCode()>& command) {
    auto arguments = std::make_shared<EnvelopeArguments>();
    CLI::App* sub = app.add_subcommand(
        "envelope", "Fit cohesion and friction angle to the peaks of several runs, draw Mohr's circles");
    sub->add_option("directories", arguments->directories, "Directories of results")->required();
    sub->add_option("-o,--output", arguments->picture, "Picture, .png or .svg; a table of the same name goes beside it")
        ->capture_default_str();
    sub->footer("Example: kluft envelope results/case-5-all results/case-3-all results/case-4-all results/case-6-all");
    sub->callback([arguments, &command] { command = [arguments] { return envelope(*arguments); }; });
}

} // namespace kluft

// The subcommands: each adds itself to the command line and sets what is to be done.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace kluft {

enum class ExitCode {
    done = 0,
    missed = 1, ///< a comparison or a validation case missed its tolerance
    bad_input = 2,
    no_equilibrium = 3,
    out_of_resources = 4,
    interrupted = 130
};

/// The name of a run: that of its directory, also of "." and "results/case-3/".
[[nodiscard]] std::string run_name(const std::filesystem::path& directory);

void add_run_command(CLI::App& app, std::function<ExitCode()>& command);
void add_check_command(CLI::App& app, std::function<ExitCode()>& command);
void add_draw_command(CLI::App& app, std::function<ExitCode()>& command);
void add_envelope_command(CLI::App& app, std::function<ExitCode()>& command);

} // namespace kluft

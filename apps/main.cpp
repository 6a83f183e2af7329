// The command line of Kluft.
#include <cstdio>
#include <exception>
#include <new>

#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/version.hpp"

namespace {

using kluft::ExitCode;

int exit_with(ExitCode code) { return static_cast<int>(code); }

int bad_input(const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return exit_with(ExitCode::bad_input);
}

/// "run, check, ..." suggestion for a mistyped subcommand.
std::string unknown_command(int argc, char** argv) {
    const std::vector<std::string> commands{"run", "check", "draw", "envelope"};
    if (argc < 2 || argv[1][0] == '-') return {};
    for (const auto& command : commands) {
        if (command == argv[1]) return {};
    }
    return std::string("kluft: unknown command '") + argv[1] + "'; expected one of " + kluft::listed(commands) +
           kluft::suggestion(argv[1], commands);
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"Kluft: strength of fractured rock by the implicit expanded distinct element method"};
    app.set_version_flag("--version", std::string(kluft::version()));
    app.require_subcommand(1);
    app.footer("Examples:\n"
               "  kluft check models/quickstart.yaml\n"
               "  kluft run models/triaxial/case-3-all.yaml -o results/case-3-all\n"
               "  kluft run models/triaxial/case-3-all.yaml --set cracks.update=all --set stages.1.steps=200\n"
               "  kluft draw results/case-3-all -o picture.png\n"
               "  kluft envelope results/case-5-all results/case-3-all results/case-4-all results/case-6-all");
    std::function<ExitCode()> command;
    kluft::add_run_command(app, command);
    kluft::add_check_command(app, command);
    kluft::add_draw_command(app, command);
    kluft::add_envelope_command(app, command);
    if (const std::string message = unknown_command(argc, argv); !message.empty()) return bad_input(message);
    try {
        app.parse(argc, argv);
        return exit_with(command());
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        app.exit(error);
        return exit_with(ExitCode::bad_input);
    } catch (const kluft::InputError& error) {
        return bad_input(error.what());
    } catch (const kluft::NoEquilibriumError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return exit_with(ExitCode::no_equilibrium);
    } catch (const kluft::ResourceError& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return exit_with(ExitCode::out_of_resources);
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "out of memory\n");
        return exit_with(ExitCode::out_of_resources);
    }
}

// The command line of Kluft.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <execinfo.h>
#include <fmt/format.h>
#include <gmp.h>

#include "blas_kernels.hpp"
#include "blas_threads.hpp"
#include "commands.hpp"
#include "completion.hpp"
#include "failure.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/version.hpp"
#include "kluft/maps/gdal.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/scene/scene_text.hpp"
#include "manual.hpp"
#include "standard_output.hpp"
#include "stop_request.hpp"

namespace {

using kluft::ExitCode;

constexpr int most_threads = 4096;

using Command = std::function<ExitCode()>; ///< what the command line asks for

int exit_with(ExitCode code) {
    if (code == ExitCode::out_of_resources) kluft::leave_without_handlers(code);
    return static_cast<int>(code);
}

/// Memory for GMP, which otherwise aborts the program where there is none. It is used before the first load step only.
void* gmp_reallocate(void* old, std::size_t, std::size_t size) {
    void* const memory = std::realloc(old, size);
    if (memory == nullptr) {
        std::fputs("out of memory\n", stderr);
        kluft::leave_without_handlers(ExitCode::out_of_resources);
    }
    return memory;
}
void* gmp_allocate(std::size_t size) { return gmp_reallocate(nullptr, 0, size); }

int bad_input(const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return exit_with(ExitCode::bad_input);
}

/// What is wrong with the name of the subcommand, the first word; "" if nothing is.
std::string unknown_command(const CLI::App& app, const std::vector<std::string>& words) {
    if (words.empty() || words.front().starts_with('-')) return {};
    std::vector<std::string> commands;
    for (const CLI::App* sub : app.get_subcommands({})) {
        if (sub->get_name() == words.front()) return {};
        if (!sub->get_group().empty()) commands.push_back(sub->get_name());
    }
    return "kluft: unknown command '" + words.front() + "'; expected one of " + kluft::listed(commands) +
           kluft::suggestion(words.front(), commands);
}

/// The first option in `words` that `app` does not know, with the nearest one that it knows; "" if there is none.
std::string unknown_option(const CLI::App& app, const std::string& title, const std::vector<std::string>& words) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    }
    bool is_value = false; // of the option before
    for (const auto& word : words) {
        if (word == "--") return {};
        const bool is_option = !is_value && word.size() > 1 && word.starts_with('-');
        is_value = false;
        if (!is_option) continue;
        const auto equals = word.find('=');
        const std::string name = word.starts_with("--") ? word.substr(0, equals) : word.substr(0, 2); // -oDIR is -o DIR
        const CLI::Option* option = app.get_option_no_throw(name);
        if (option == nullptr) {
            return fmt::format("{}: unknown option '{}'; expected one of {}{}", title, name, kluft::listed(names),
                               kluft::suggestion(name, names));
        }
        is_value = option->get_items_expected_max() > 0 && name == word;
    }
    return {};
}

/// The one message for a command line that cannot be understood.
std::string misunderstanding(const CLI::App& app, const std::vector<std::string>& words, const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    std::string title = "kluft";
    std::string unknown;
    if (chosen.empty()) {
        unknown = unknown_option(app, title, words);
    } else {
        title += " " + chosen.front()->get_name();
        unknown = unknown_option(*chosen.front(), title, {words.begin() + 1, words.end()});
    }
    return unknown.empty() ? title + ": " + error.what() + "; see " + title + " --help" : unknown;
}

/// The exit code of the program after a command; what it said must have got where it should.
int finished(ExitCode code) {
    if (const std::string lost = kluft::lost_output(); !lost.empty()) {
        std::fprintf(stderr, "%s\n", lost.c_str());
        if (code == ExitCode::done || code == ExitCode::missed) code = ExitCode::out_of_resources;
    }
    return exit_with(code);
}

int say_help(const CLI::App& app, const CLI::Success& help) {
    std::ostringstream text;
    app.exit(help, text, text);
    kluft::say_text(text.str());
    return finished(ExitCode::done);
}

/// An empty name, as of a shell variable that is not set, is a mistake and not the default. Tables, pages and scripts that name the
/// results are UTF-8.
std::string flaw_of_name(const std::string& name) {
    if (name.empty()) return "expected a name, found none";
    return kluft::is_utf8(name) ? "" : "expected a name in UTF-8, found one with other bytes";
}

void add_run_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::RunArguments>();
    CLI::App* sub =
        app.add_subcommand("run", "Run a scene: load it step by step and write curves, fields and pictures");
    sub->add_option("scene", arguments->scene, "Scene file (YAML)")->required();
    sub->add_option("-o,--output", arguments->directory, "Directory of the results (default: results/<scene name>)")
        ->check(flaw_of_name);
    sub->add_option("--set", arguments->overrides,
                    "Set a value of the scene, e.g. --set stages.1.steps=200; a mapping is merged with the one that is "
                    "there, also a stage ('stages.1={steps: 200}' keeps all else of it); null removes a key")
        ->take_all()
        ->allow_extra_args(false);
    sub->add_option("--threads", arguments->threads, "Threads of the factorization (bodies of 20 000 unknowns or more)")
        ->check(CLI::Range(1, most_threads));
    sub->add_flag("--quiet", arguments->quiet, "No progress, warnings and closing line: run.log has them");
    CLI::Option* resume = sub->add_flag("--resume", arguments->resume, "Go on from the state saved in the directory");
    sub->add_flag("--force", arguments->force, "Replace results of another scene in the directory")->excludes(resume);
    sub->footer(
        "The scene as run is scene.yaml in the directory of the results. Run again into the same directory, the same "
        "scene replaces its results; another one is refused without --force.\n"
        "Exit codes: 0 done, 2 bad input, 3 no equilibrium, 4 out of disk or memory, 128 + n stopped by signal n (130: "
        "Ctrl-C).\n"
        "Example: kluft run models/triaxial/case-3-all.yaml -o results/coarse --set "
        "geometry.tessellation.triangles.spacing=0.05");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::run(*arguments); }; });
}

void add_check_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::CheckArguments>();
    CLI::App* sub = app.add_subcommand("check", "Say what a scene amounts to, without running it");
    sub->add_option("scene", arguments->scene, "Scene file (YAML)")->required();
    sub->add_option("--set", arguments->overrides, "Set a value of the scene")->take_all()->allow_extra_args(false);
    sub->add_flag("--json", arguments->json,
                  "For programs: one object of JSON, of a scene with mistakes with its problems");
    sub->footer(
        "Examples:\n  kluft check models/triaxial/case-3-all.yaml\n  kluft check models/outcrop-kb7.yaml --json");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::check(*arguments); }; });
}

void add_schema_command(CLI::App& app, Command& command) {
    auto of = std::make_shared<std::string>("scene");
    CLI::App* sub = app.add_subcommand(
        "schema", "Say the JSON Schema of scenes, studies or calibrations, from which editors complete and check");
    sub->add_option("of", *of, "What the schema is of: scene, study or calibration (default: scene)")
        ->check(CLI::IsMember({"scene", "study", "calibration"}));
    sub->footer("Examples:\n  kluft schema >scene.schema.json\n  kluft schema study >study.schema.json");
    sub->callback([of, &command] { command = [of] { return kluft::schema(*of); }; });
}

void add_draw_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::DrawArguments>();
    CLI::App* sub = app.add_subcommand(
        "draw", "Draw a scene's blocks; blocks, curve and histories of a run; the curves of several runs");
    sub->add_option("source", arguments->sources, "Scene file, or directories of results")->required();
    sub->add_option(
           "-o,--output", arguments->picture,
           "One picture, .png, .svg or .pdf; of a single run that of its blocks (default: <scene name>.png; "
           "DIR/curve, DIR/blocks and DIR/histories, each .png and .svg; curves.png; <run>-<field>-<step>.png)")
        ->check(flaw_of_name);
    CLI::Option* curve = sub->add_flag("--curve", arguments->curve, "Of a run only the curve");
    CLI::Option* blocks = sub->add_flag("--blocks", arguments->blocks, "Of a run only the blocks")->excludes(curve);
    sub->add_flag("--histories", arguments->histories, "Of a run only what its scene follows (output.histories)")
        ->excludes(curve)
        ->excludes(blocks);
    sub->add_option("--mark", arguments->marks,
                    "A published value in the plot of curves: LABEL=STRESS is a level, LABEL=STRESS at STRAIN a point; "
                    "the stress is "
                    "that of the axis, the differential one (axial less lateral stress); "
                    "RUN:LABEL=... takes the colour of a run")
        ->take_all()
        ->allow_extra_args(false);
    sub->add_option("--step", arguments->step,
                    "A kept state of a run: a load step, peak (the one kept nearest to the peak) or last (default)");
    sub->add_option("--field", arguments->field,
                    fmt::format("What its blocks are coloured by: {} (default: sigma_1)",
                                kluft::listed(kluft::block_field_names())));
    sub->add_option("--scale", arguments->scale, "Its displacements are drawn so many times larger (default: 1)");
    sub->add_option("--window", arguments->window, "The part of it that is drawn: x0,y0,x1,y1 in m or with units");
    sub->add_option("--limit", arguments->limit, "Where the stress axis of the curves ends, e.g. 5 MPa");
    sub->add_option("--title", arguments->title, "Title of the picture");
    sub->add_option("--set", arguments->overrides, "Set a value of the scene")->take_all()->allow_extra_args(false);
    sub->footer(
        "Examples:\n"
        "  kluft draw models/triaxial/case-3-all.yaml -o geometry.svg\n"
        "  kluft draw results/case-3-all\n"
        "  kluft draw results/case-3-all --step peak --field sigma_3 --scale 10 --window 0,0.2,0.38,0.6 -o peak.pdf\n"
        "  kluft draw results/case-3 results/case-3-all -o curves.png --mark 'published=1.205 MPa'\n"
        "  kluft draw results/case-3 results/case-5 -o curves.png --mark 'case-5:published, 0 MPa=0.502 MPa'");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::draw(*arguments); }; });
}

void add_report_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::ReportArguments>();
    CLI::App* sub = app.add_subcommand(
        "report", "Write report.html: the answer of a run, its curve and its body in one page to be handed on");
    sub->add_option("directory", arguments->directories, "Directories of results")->required();
    sub->add_option("-o,--output", arguments->output, "The page of a single run, .html (default: DIR/report.html)")
        ->check(flaw_of_name);
    sub->footer("kluft run writes it too, unless the scene says output.report: false. The page needs no network and no "
                "other file.\n"
                "Examples:\n"
                "  kluft report results/quickstart\n"
                "  kluft report results/quickstart -o quickstart.html");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::report(*arguments); }; });
}

void add_export_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::ExportArguments>();
    CLI::App* sub =
        app.add_subcommand("export", "Write a state of a run as a map: blocks as polygons, interfaces as lines");
    sub->add_option("directory", arguments->directory, "Directory of results")->required();
    sub->add_option("-o,--output", arguments->output,
                    "GeoPackage (.gpkg) or GeoJSON (.geojson) (default: <run name>.gpkg)")
        ->check(flaw_of_name);
    sub->add_option("--step", arguments->step,
                    "A kept state: a load step, peak (the one kept nearest to the peak) or last (default)");
    sub->footer(
        "Coordinates are those of the scene, with the coordinate system of its maps or of geometry.crs. Needs GDAL.\n"
        "Exit codes: 0 written, 2 bad input, 4 out of disk or memory.\n"
        "Example: kluft export results/outcrop-kb7 -o outcrop.gpkg --step last");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::export_map(*arguments); }; });
}

void add_compare_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::CompareArguments>();
    CLI::App* sub =
        app.add_subcommand("compare", "Set two runs side by side: peak, moduli, curves, cracks, costs; exit code 1 "
                                      "unless they agree");
    sub->add_option("directories", arguments->directories, "Two directories of results, A and B")
        ->required()
        ->expected(2);
    sub->add_option("--tolerance", arguments->tolerance,
                    "Largest difference of peak stress, peak strain, Young's modulus (of B from A, relative to A) and "
                    "largest mean difference of the curves, as 0.05 or '5 %'")
        ->capture_default_str();
    sub->add_option("-o,--output", arguments->output,
                    "Directory of compare.md, compare.json, curves.png, cracks.png and both as .svg (default: "
                    "results/compare-<A>-<B>)")
        ->check(flaw_of_name);
    sub->footer("The curves are those of differential stress over axial strain, linear between balanced load steps, "
                "compared at\n201 equal steps of strain up to the smaller of both peak strains, relative to A's peak "
                "differential stress.\n"
                "A crack is matched by one of the same mode in the other run within one spacing of the hexagons "
                "(the larger one),\nthe nearest pairs first, each crack once.\n"
                "Exit codes: 0 the runs agree, 1 they do not, 2 bad input.\n"
                "Examples:\n"
                "  kluft compare results/event results/all\n"
                "  kluft compare results/implicit results/explicit --tolerance 0.03 -o results/integrators");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::compare(*arguments); }; });
}

void add_envelope_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::EnvelopeArguments>();
    CLI::App* sub = app.add_subcommand(
        "envelope",
        "Fit cohesion and friction angle, tensile strength and Hoek-Brown's curve to the peaks of several tests, "
        "draw Mohr's circles");
    sub->add_option("sources", arguments->sources,
                    "Directories of results, and tables (.csv) with columns sigma_3, sigma_1 in Pa, or with the unit "
                    "as in 'sigma_1 (MPa)'")
        ->required();
    sub->add_option("-o,--output", arguments->picture,
                    "Picture, .png or .svg; a table and a .json of the same name go beside it")
        ->check(flaw_of_name)
        ->capture_default_str();
    sub->add_option("--tension", arguments->tension,
                    "Tensile strength of a test made elsewhere, e.g. '0.12 MPa'; once for each test")
        ->take_all()
        ->allow_extra_args(false);
    sub->add_option("--compare", arguments->others, "Another envelope in the picture: LABEL=COHESION,ANGLE")
        ->take_all()
        ->allow_extra_args(false);
    sub->add_option("--title", arguments->title, "Title of the picture")->capture_default_str();
    sub->footer(
        "Runs that had neither fallen nor levelled off, whose sides were unloaded before the stress fell, that "
        "move no platen, ended unbalanced or whose net locked are bounds: they are drawn and listed, but not "
        "fitted.\nRuns that pull, and rows of tables with sigma_3 below zero, "
        "give the tensile strength.\n"
        "Other columns of tables: run, and peak_reached, balanced, net_locked, unloaded, moves_platen (0 or 1).\n"
        "Examples:\n"
        "  kluft envelope results/case-5-all results/case-3-all results/case-4-all results/case-6-all\n"
        "  kluft envelope field-tests.csv results/case-3-all --tension '0.1 MPa' --tension '0.12 MPa'\n"
        "  kluft envelope results/low results/high -o both.png --compare 'field tests=0.16 MPa, 36.2 deg'");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::envelope(*arguments); }; });
}

void add_study_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::StudyArguments>();
    CLI::App* sub = app.add_subcommand("study", "Run a scene with many settings and set the results side by side");
    sub->add_option(
           "study", arguments->words,
           "Study file (YAML), or 'step-size SCENE': 25-800 load steps, and the scene's own, of the last stage that "
           "moves a platen, or 'trade SCENE': every numerical setting and the choices of the model, with a "
           "recommendation")
        ->required()
        ->expected(1, 2);
    sub->add_option(
           "-o,--output", arguments->directory,
           "Directory of the results (default: results/<study name>, results/<scene>-step-size, results/<scene>-trade)")
        ->check(flaw_of_name);
    sub->add_option("--jobs", arguments->jobs, "Cases that run at once (default: the number of processors)")
        ->check(CLI::Range(1, most_threads));
    sub->add_option("--set", arguments->overrides, "Set a value of the scene in all cases")
        ->take_all()
        ->allow_extra_args(false);
    CLI::Option* emit = sub->add_option("--emit", arguments->emit,
                                        "Run nothing; write a job array for Slurm (slurm) or a makefile (make)");
    sub->add_flag("--collect", arguments->collect, "Run nothing; gather the table of what has been run")
        ->excludes(emit);
    sub->add_option("--quantity", arguments->quantity,
                    "Quantity of the study that the report is about (default: its first one)");
    sub->add_flag("--force", arguments->force,
                  "Replace results of another scene, of other settings and files that no study made");
    sub->add_flag("--quiet", arguments->quiet, "No progress");
    sub->footer("Cases that have ended are not run again; interrupted ones go on from their saved states.\n"
                "Exit codes: 0 all cases ended, 1 some failed or are missing, 2 bad input, 4 out of disk or memory "
                "(also a case), "
                "128 + n stopped by signal n (130: Ctrl-C).\n"
                "Examples:\n"
                "  kluft study models/studies/steps.yaml --jobs 4\n"
                "  kluft study step-size models/quickstart.yaml -o results/steps\n"
                "  kluft study trade models/triaxial/case-3-all.yaml\n"
                "  kluft study models/studies/steps.yaml -o results/steps --emit slurm\n"
                "  kluft study models/studies/steps.yaml -o results/steps --collect");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::study(*arguments); }; });
}

void add_calibrate_command(CLI::App& app, Command& command) {
    auto arguments = std::make_shared<kluft::CalibrateArguments>();
    CLI::App* sub = app.add_subcommand(
        "calibrate", "Find the values of a scene's keys with which it shows what was measured on the rock");
    sub->add_option("target", arguments->target, "Calibration file (YAML): a scene, parameters, targets")->required();
    sub->add_option("-o,--output", arguments->directory, "Directory of the results (default: results/<file name>)")
        ->check(flaw_of_name);
    sub->add_option("--jobs", arguments->jobs, "Runs at once (default: the number of processors)")
        ->check(CLI::Range(1, most_threads));
    sub->add_flag("--quiet", arguments->quiet, "No progress");
    sub->footer(
        "Writes calibrated.yaml, a scene; calibration.json; report.html. Runs that have ended are not run again, "
        "so that the same command goes on after Ctrl-C.\n"
        "Exit codes: 0 all targets within their tolerances, 1 some are not, 2 bad input, 4 out of disk or "
        "memory, 128 + n stopped by signal n (130: Ctrl-C).\n"
        "Example: kluft calibrate models/calibration/intact-rock.yaml -o results/intact-rock");
    sub->callback([arguments, &command] { command = [arguments] { return kluft::calibrate(*arguments); }; });
}

void add_completion_command(CLI::App& app, Command& command) {
    auto shell = std::make_shared<std::string>();
    CLI::App* sub =
        app.add_subcommand("completion", "Say a script that lets a shell complete commands, options, files and keys");
    sub->add_option("shell", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
    sub->footer("Installed packages have it already.\nExamples:\n"
                "  eval \"$(kluft completion bash)\"\n"
                "  kluft completion fish >~/.config/fish/completions/kluft.fish");
    sub->callback([shell, &command] {
        command = [shell] {
            kluft::say_text(kluft::completion_script(*shell));
            return ExitCode::done;
        };
    });
}

/// Of scripts and packages: what they say stands in no help. All words after the name are theirs.
CLI::App* add_hidden_command(CLI::App& app, const std::string& name) {
    CLI::App* sub = app.add_subcommand(name)->group("");
    sub->set_help_flag();
    sub->prefix_command();
    sub->allow_extras();
    return sub;
}

void add_hidden_commands(CLI::App& app, Command& command) {
    CLI::App* complete = add_hidden_command(app, "complete");
    complete->callback([complete, &app, &command] {
        command = [&app, words = complete->remaining()] {
            for (const std::string& each : kluft::completions(app, words)) kluft::say_text(each + "\n");
            return ExitCode::done;
        };
    });
    CLI::App* manual = add_hidden_command(app, "manual");
    manual->callback([manual, &app, &command] {
        command = [&app, words = manual->remaining()] {
            kluft::write_manual(app, words.empty() ? "." : words.front());
            return ExitCode::done;
        };
    });
}

void add_validate_command(CLI::App& app, Command& command) {
    CLI::App* sub = app.add_subcommand("validate", "Run the validation suite, or some of its cases");
    sub->set_help_flag();
    sub->prefix_command(); // all words, also --help, are for the script
    sub->allow_extras();
    sub->callback([sub, &command] { command = [words = sub->remaining()] { return kluft::validate({words}); }; });
}

/// Makes the C library load what it unwinds a thread with, which it otherwise does when a thread first ends by itself and
/// aborts the program where there is no memory for that.
void load_unwinder() {
    void* frame = nullptr;
    (void)backtrace(&frame, 1);
}

int program(int argc, char** argv) {
    CLI::App app{"Kluft: strength of fractured rock by the implicit expanded distinct element method"};
    app.set_version_flag("--version", [] {
        std::string text(kluft::version());
        if (!kluft::commit().empty()) text += " (" + std::string(kluft::commit()) + ")";
        const std::string gdal = kluft::gdal_version();
        return text + (gdal.empty() ? "\nwithout GDAL: maps as GeoJSON in metres" : "\nwith GDAL " + gdal);
    });
    app.require_subcommand(1);
    app.footer("Examples:\n"
               "  kluft check models/quickstart.yaml\n"
               "  kluft run models/triaxial/case-3-all.yaml -o results/case-3-all\n"
               "  kluft run models/triaxial/case-3-all.yaml -o results/finer --set cracks.update=all --set "
               "stages.1.steps=200\n"
               "  kluft draw results/case-3-all -o picture.png\n"
               "  kluft report results/case-3-all\n"
               "  kluft compare results/case-3 results/case-3-all\n"
               "  kluft envelope results/case-5-all results/case-3-all results/case-4-all results/case-6-all\n"
               "  kluft study step-size models/quickstart.yaml\n"
               "  kluft calibrate models/calibration/intact-rock.yaml\n"
               "  kluft validate incline overturning");
    Command command;
    add_run_command(app, command);
    add_check_command(app, command);
    add_schema_command(app, command);
    add_draw_command(app, command);
    add_report_command(app, command);
    add_export_command(app, command);
    add_compare_command(app, command);
    add_envelope_command(app, command);
    add_study_command(app, command);
    add_calibrate_command(app, command);
    add_validate_command(app, command);
    add_completion_command(app, command);
    add_hidden_commands(app, command);
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (const std::string message = unknown_command(app, words); !message.empty()) return bad_input(message);
    try {
        app.parse(argc, argv);
        return finished(command());
    } catch (const CLI::Success& help) {
        return say_help(app, help);
    } catch (const CLI::ParseError& error) {
        return bad_input(misunderstanding(app, words, error));
    }
}

} // namespace

int main(int argc, char** argv) {
    try {
        kluft::take_signals();
        kluft::open_standard_streams();
        kluft::leave_writing_to_its_result();
        kluft::do_without_blas_threads(argv);
        kluft::choose_blas_kernels(argv);
        mp_set_memory_functions(gmp_allocate, gmp_reallocate, nullptr);
        load_unwinder();
        return program(argc, argv);
    } catch (...) {
        return exit_with(kluft::tell_failure());
    }
}

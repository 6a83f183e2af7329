// kluft draw SCENE|DIR
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

struct DrawArguments {
    std::string source;
    std::string picture;
    std::vector<std::string> overrides;
};

RunCurve read_curve(const fs::path& directory) {
    RunCurve curve;
    curve.label = directory.filename().string();
    curve.history = read_history(directory / "history.csv");
    if (fs::exists(directory / "equilibria.csv")) curve.equilibria = read_history(directory / "equilibria.csv");
    curve.platen_stage = read_summary(directory / "summary.json").platen_stage.value_or(0);
    return curve;
}

void draw_run(const fs::path& directory, const fs::path& picture) {
    const std::string title = read_summary(directory / "summary.json").title;
    write_curves(picture, stress_strain_plot(title, {read_curve(directory)}));
}

void draw_scene(const DrawArguments& arguments, const fs::path& picture) {
    const Scene scene = read_scene(arguments.source, arguments.overrides);
    const SceneModel built = build_scene_model(scene);
    BlocksPlot plot;
    plot.title = scene.title.empty() ? scene.name : scene.title;
    for (const Material& material : scene.materials) plot.material_names.push_back(material.name);
    for (const char bond : built.model.bonds) plot.bonded_types.push_back(bond != 0);
    write_geometry(picture, built.model.system, plot);
}

ExitCode draw(const DrawArguments& arguments) {
    const fs::path source = arguments.source;
    const bool is_run = fs::is_directory(source);
    if (!is_run && !fs::exists(source)) {
        throw InputError(arguments.source + ": expected a scene file or a directory of results, found nothing");
    }
    fs::path picture = arguments.picture;
    if (picture.empty()) picture = is_run ? source / "curve.png" : fs::path(source.stem().string() + ".png");
    if (is_run) {
        draw_run(source, picture);
    } else {
        draw_scene(arguments, picture);
    }
    fmt::print("{}\n", picture.string());
    return ExitCode::done;
}

} // namespace

void add_draw_command(CLI::App& app, std::function<ExitCode()>& command) {
    auto arguments = std::make_shared<DrawArguments>();
    CLI::App* sub = app.add_subcommand("draw", "Draw a scene's blocks, or the curve of a run");
    sub->add_option("source", arguments->source, "Scene file, or directory of results")->required();
    sub->add_option("-o,--output", arguments->picture,
                    "Picture, .png or .svg (default: <scene name>.png, DIR/curve.png)");
    sub->add_option("--set", arguments->overrides, "Replace a value of the scene")->take_all()->allow_extra_args(false);
    sub->footer("Example: kluft draw models/triaxial/case-3-all.yaml -o blocks.svg");
    sub->callback([arguments, &command] { command = [arguments] { return draw(*arguments); }; });
}

} // namespace kluft

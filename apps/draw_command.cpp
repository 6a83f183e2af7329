// kluft draw SCENE|DIR...
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/blocks_picture.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/output/field_reader.hpp"
#include "kluft/output/field_series.hpp"
#include "kluft/output/histories_picture.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/kept_states.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/report/run_of_results.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/fingerprint.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/studies/finished_run.hpp"
#include "results_run.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

constexpr double mega = 1e6;

[[noreturn]] void refuse_mark(const std::string& mark, const std::string& found) {
    throw InputError(fmt::format("--mark '{}': expected [RUN:]LABEL=STRESS, or [RUN:]LABEL=STRESS at STRAIN as in "
                                 "'published=1.205 MPa at 1.3 %', found {}",
                                 mark, found));
}

double quantity_of(const std::string& mark, const std::string& text, Measure measure) {
    const QuantityReading reading = read_quantity(text, measure);
    if (!reading.value) refuse_mark(mark, "'" + text + "'" + reading.problem);
    return *reading.value;
}

/// [RUN:]LABEL=STRESS[ at STRAIN]; the mark of a run has its colour.
PlottedReference reference_of(const std::string& mark, const std::vector<std::string>& labels) {
    constexpr double percent = 100.0;
    const auto equals = mark.rfind('=');
    if (equals == std::string::npos || equals == 0) refuse_mark(mark, "no '='");
    PlottedReference reference;
    reference.label = mark.substr(0, equals);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (!reference.label.starts_with(labels[i] + ":")) continue;
        reference.curve = i;
        reference.label.erase(0, labels[i].size() + 1);
        break;
    }
    const auto colon = reference.label.find(':');
    if (!reference.curve && colon != std::string::npos && colon + 1 < reference.label.size() &&
        reference.label[colon + 1] != ' ')
        refuse_mark(mark, fmt::format("'{}' where the runs are {}", reference.label.substr(0, colon), listed(labels)));
    const std::string values = mark.substr(equals + 1);
    const auto at = values.find(" at ");
    reference.y = quantity_of(mark, values.substr(0, at), Measure::stress) / mega;
    if (at != std::string::npos) reference.x = percent * quantity_of(mark, values.substr(at + 4), Measure::fraction);
    return reference;
}

/// End of the stress axis (MPa).
double limit_of(const std::string& text) {
    const QuantityReading reading = read_quantity(text, Measure::stress);
    if (!reading.value || !(*reading.value > 0.0)) {
        throw InputError(
            fmt::format("--limit: expected a stress above 0 as in '5 MPa', found '{}'{}", text, reading.problem));
    }
    return *reading.value / mega;
}

/// The picture that is drawn where no name was given: one that Kluft drew gives way to it.
fs::path default_picture(const fs::path& picture) {
    std::error_code error;
    if (fs::is_regular_file(picture, error) && !is_drawn_png(read_file(picture)))
        throw InputError(
            fmt::format("{}: expected a picture that Kluft drew or none, found another file, which would be "
                        "lost; choose a name with -o",
                        picture.string()));
    return picture;
}

/// What only curves have.
void refuse_without_curve(const DrawArguments& arguments) {
    if (!arguments.limit.empty() || !arguments.marks.empty())
        throw InputError("--limit and --mark: expected a picture of a curve of stress over strain, found another one");
}

void announce(const fs::path& picture) { say("{}\n", picture.string()); }

void draw_curve(const DrawArguments& arguments, const std::vector<fs::path>& pictures) {
    const auto labels = run_names(arguments.sources);
    std::vector<RunCurve> curves;
    for (std::size_t i = 0; i < labels.size(); ++i) curves.push_back(read_curve(arguments.sources[i], labels[i]));
    std::vector<PlottedReference> references;
    for (const auto& mark : arguments.marks) references.push_back(reference_of(mark, labels));
    std::string title = arguments.title;
    if (curves.size() == 1) {
        curves.front().label.clear();
        if (title.empty()) title = heading_of(arguments.sources.front()).title;
    }
    CurvePlot plot = stress_strain_plot(title, curves, references);
    if (!arguments.limit.empty()) plot.y_limit = limit_of(arguments.limit);
    for (const auto& picture : pictures) {
        write_curves(picture, plot);
        announce(picture);
    }
}

void draw_histories(const DrawArguments& arguments, const std::vector<fs::path>& pictures) {
    const fs::path directory = arguments.sources.front();
    const fs::path table = directory / "histories.csv";
    if (!fs::exists(table))
        throw InputError(directory.string() +
                         ": --histories: expected a run that follows something (output.histories), found no " +
                         table.filename().string());
    const RunHeading heading = heading_of(directory);
    const std::string title = arguments.title.empty() ? heading.title : arguments.title;
    const auto plots =
        histories_plots(title, read_histories(table), read_curve(directory, {}).history, heading.platen_stage);
    for (const auto& picture : pictures) {
        write_curves(picture, plots);
        announce(picture);
    }
}

/// Blocks and their plot as they are in the scene, before any run.
BlocksPlot plot_of(const Scene& scene) {
    BlocksPlot plot;
    plot.title = scene.title.empty() ? scene.name : scene.title;
    for (const Material& material : scene.materials) plot.material_names.push_back(material.name);
    return plot;
}

/// Before and after, from the last saved state and the scene that is saved with it.
void draw_blocks_of_run(const DrawArguments& arguments, const std::vector<fs::path>& pictures) {
    const fs::path directory = arguments.sources.front();
    const auto [scene, built] = run_of_results(directory);
    const State state = read_state(directory / "state.h5", fingerprint(built.model));
    auto history = read_curve(directory, {}).history;
    std::erase_if(history, [&](const StepRecord& record) { return record.step > state.at.step; });
    BlocksPlot plot = plot_of(scene);
    plot.title = arguments.title.empty() ? heading_of(directory).title : arguments.title;
    std::optional<RunSummary> summary;
    if (fs::exists(directory / "summary.json")) summary = read_summary(directory / "summary.json");
    if (summary && summary->numbers.steps != state.at.step) summary.reset(); // a run that went on, and has not ended
    if (summary) plot.moving = summary->falling;
    plot.after = after_title(history, !moves_no_platen(directory), summary);
    const FieldRecord fields = fields_of_state(built.model, state);
    for (const auto& picture : pictures) {
        write_blocks(picture, built.model.system, fields, plot);
        announce(picture);
    }
}

double scale_of(const std::string& text) {
    const auto number = read_number(text);
    if (!number || !(*number >= 0.0)) throw InputError("--scale: expected a number >= 0, found '" + text + "'");
    if (constexpr double largest = 1e9; *number > largest)
        throw InputError(fmt::format("--scale: expected at most {:.0e}, found '{}'", largest, text));
    return *number;
}

/// x0,y0,x1,y1 in the coordinates of the scene.
Box window_of(const std::string& text, const Vec2& origin) {
    std::vector<double> numbers;
    std::istringstream words(text);
    for (std::string word; std::getline(words, word, ',');) {
        const QuantityReading reading = read_quantity(word, Measure::length);
        if (reading.value)
            numbers.push_back(*reading.value);
        else
            break;
    }
    const bool is_window =
        numbers.size() == 4 && std::ranges::count(text, ',') == 3 && numbers[0] < numbers[2] && numbers[1] < numbers[3];
    if (!is_window)
        throw InputError("--window: expected x0,y0,x1,y1 with x0 < x1 and y0 < y1, as in 0,0,0.2,0.4, found '" + text +
                         "'");
    const Box window{Vec2(numbers[0], numbers[1]) - origin, Vec2(numbers[2], numbers[3]) - origin};
    constexpr double largest = 1e9; // m, as of a coordinate in a scene
    constexpr double smallest = 1e-12;
    const double farthest = std::max(window.lower.cwiseAbs().maxCoeff(), window.upper.cwiseAbs().maxCoeff());
    const double narrowest = (window.upper - window.lower).minCoeff();
    if (!(farthest <= largest) || !(narrowest >= smallest))
        throw InputError(fmt::format("--window: expected coordinates up to {:.0e} m that are {:.0e} m apart or more, "
                                     "found '{}'",
                                     largest, smallest, text));
    return window;
}

std::string heading_of_state(const fs::path& directory, int step, double scale) {
    std::string heading = fmt::format("load step {}", step);
    const auto history = read_curve(directory, {}).history;
    const auto row = std::ranges::find(history, step, &StepRecord::step);
    if (row != history.end() && !moves_no_platen(directory))
        heading += fmt::format(", axial strain {:.3g} %", 100.0 * row->axial_strain);
    if (scale != 1.0) heading += fmt::format(", displacements x {:g}", scale);
    return heading;
}

/// One kept state by its field files.
void draw_state_of_run(const DrawArguments& arguments) {
    const fs::path directory = arguments.sources.front();
    if (arguments.curve || arguments.histories || !arguments.marks.empty() || !arguments.limit.empty())
        throw InputError("--step, --field, --scale and --window: expected a picture of blocks, found one of a curve");
    const int step = step_asked_for(arguments.step, directory);
    const RunOfResults run = run_of_results(directory);
    const BlockSystem& system = run.built.model.system;
    const FieldRecord fields = read_fields(directory, step, system);
    const std::string name = arguments.field.empty() ? "sigma_1" : arguments.field;
    StatePlot plot;
    plot.title = arguments.title.empty() ? heading_of(directory).title : arguments.title;
    plot.field = block_field(system, fields, name);
    if (!arguments.scale.empty()) plot.magnification = scale_of(arguments.scale);
    if (!arguments.window.empty()) plot.window = window_of(arguments.window, system.origin);
    plot.heading = heading_of_state(directory, step, plot.magnification);
    const fs::path picture = arguments.picture.empty()
                                 ? default_picture(fmt::format("{}-{}-{}.png", run_name(directory), name, step))
                                 : fs::path(arguments.picture);
    write_file(picture, draw_state(system, fields, plot, picture_format(picture)));
    announce(picture);
}

/// The pictures of a kind: the one asked for, or those that a run leaves in its directory.
std::vector<fs::path> pictures_of(const DrawArguments& arguments, const char* stem) {
    if (!arguments.picture.empty()) return {arguments.picture};
    const fs::path directory = arguments.sources.front();
    return {directory / fmt::format("{}.png", stem), directory / fmt::format("{}.svg", stem)};
}

void draw_run(const DrawArguments& arguments) {
    const bool one_file = !arguments.picture.empty();
    if (arguments.histories) {
        refuse_without_curve(arguments);
        return draw_histories(arguments, pictures_of(arguments, "histories"));
    }
    const bool all = !one_file && !arguments.curve && !arguments.blocks && arguments.marks.empty();
    if (all && fs::exists(fs::path(arguments.sources.front()) / "histories.csv"))
        draw_histories(arguments, pictures_of(arguments, "histories"));
    if (moves_no_platen(arguments.sources.front())) {
        if (arguments.curve || !arguments.marks.empty() || !arguments.limit.empty())
            throw InputError(arguments.sources.front() +
                             ": expected a run that moves a platen, without which there is no "
                             "curve of stress over strain, found one that does not");
        return draw_blocks_of_run(arguments, pictures_of(arguments, "blocks"));
    }
    const bool curve = arguments.curve || (!arguments.blocks && (!one_file || !arguments.marks.empty()));
    const bool blocks = arguments.blocks || (!arguments.curve && !curve) || (!arguments.curve && !one_file);
    if (!curve) refuse_without_curve(arguments);
    if (curve) draw_curve(arguments, pictures_of(arguments, "curve"));
    if (blocks) draw_blocks_of_run(arguments, pictures_of(arguments, "blocks"));
}

void draw_several_runs(const DrawArguments& arguments) {
    if (arguments.blocks || arguments.histories)
        throw InputError(fmt::format("--{}: expected one directory of results, found several",
                                     arguments.blocks ? "blocks" : "histories"));
    draw_curve(arguments, {arguments.picture.empty() ? default_picture("curves.png") : fs::path(arguments.picture)});
}

void draw_scene(const DrawArguments& arguments) {
    const fs::path source = arguments.sources.front();
    if (arguments.curve || arguments.histories || !arguments.marks.empty() || !arguments.limit.empty()) {
        throw InputError(source.string() + ": expected a directory of results to draw a curve, found a file");
    }
    const Scene scene = read_scene(source, arguments.overrides);
    const SceneModel built = build_scene_model(scene);
    BlocksPlot plot = plot_of(scene);
    if (!arguments.title.empty()) plot.title = arguments.title;
    for (const char bond : built.model.bonds) plot.bonded_types.push_back(bond != 0);
    const fs::path picture =
        arguments.picture.empty() ? default_picture(source.stem().string() + ".png") : fs::path(arguments.picture);
    write_geometry(picture, built.model.system, plot);
    announce(picture);
}

} // namespace

ExitCode draw(const DrawArguments& arguments) {
    require_possible_output(arguments.picture);
    if (!arguments.picture.empty()) {
        const PictureFormat format = picture_format(arguments.picture);
        require_directory_of(arguments.picture);
        require_own_file(arguments.picture, "a picture",
                         [&](std::string_view content) { return is_drawn_picture(format, content); });
    }
    const bool several = arguments.sources.size() > 1;
    for (const auto& source : arguments.sources) {
        if (!fs::exists(source)) {
            throw InputError(source + ": expected a scene file or a directory of results, found nothing");
        }
        if (several && !fs::is_directory(source)) {
            throw InputError(source + ": expected a directory of results beside the others, found a file");
        }
    }
    const bool is_run = fs::is_directory(arguments.sources.front());
    if (arguments.is_of_state() && (several || !is_run))
        throw InputError("--step, --field, --scale and --window: expected one directory of results, found " +
                         std::string(several ? "several" : "a scene file"));
    if (is_run && !arguments.overrides.empty()) {
        throw InputError("--set: expected a scene file, found a directory of results, whose scene stays as it was run");
    }
    for (const auto& source : arguments.sources)
        if (is_run) warn_of_missing_rows(source);
    if (several) {
        draw_several_runs(arguments);
    } else if (arguments.is_of_state()) {
        draw_state_of_run(arguments);
    } else if (is_run) {
        draw_run(arguments);
    } else {
        draw_scene(arguments);
    }
    return ExitCode::done;
}

} // namespace kluft

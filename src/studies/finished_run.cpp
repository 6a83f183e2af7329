#include "kluft/studies/finished_run.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/state_file.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/rock_constants.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

const std::vector<std::string_view> needed_columns{"step", "stage", "axial_strain", "axial_stress",
                                                   "differential_stress"};

/// Names in a folder, sorted; none where it cannot be read.
std::vector<std::string> names_in(const fs::path& folder, bool directories) {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (entry->is_directory(error) == directories) names.push_back(entry->path().filename().string());
    std::ranges::sort(names);
    return names;
}

/// "; did you mean 'results/case-3'?" for a missing directory, from those beside it.
std::string nearest_directory(const fs::path& missing) {
    const fs::path path = missing.has_filename() ? missing : missing.parent_path();
    const fs::path folder = path.parent_path();
    const auto names = names_in(folder.empty() ? fs::path(".") : folder, true);
    const std::string nearest = nearest_name(path.filename().string(), names);
    return nearest.empty() ? std::string{} : "; did you mean '" + (folder / nearest).string() + "'?";
}

std::vector<StepRecord> read_rows(const fs::path& table) {
    return fs::exists(table) ? read_history(table, needed_columns) : std::vector<StepRecord>{};
}

/// The body that was run, from the scene that is saved with its last state.
void read_model(FinishedRun& run, Plane& plane) {
    const fs::path saved = run.directory / "state.h5";
    if (!fs::exists(saved)) {
        run.notes.push_back(run.directory.string() + " has no state.h5, so its blocks are not known");
        return;
    }
    try {
        const Scene scene = read_scene_text(read_state_scene(saved), {}, saved);
        if (const std::string difference = difference_from_scene_file(run.directory, scene); !difference.empty())
            throw InputError(saved.string() + " is of another scene than scene.yaml: " + difference);
        run.model = build_scene_model(scene).model;
        plane = scene.plane;
    } catch (const InputError& error) {
        const std::string message = error.messages().empty() ? error.what() : error.messages().front();
        run.notes.push_back("the blocks of " + run.name + " are not known: " + message.substr(0, message.find('\n')));
    }
}

} // namespace

void require_results(const fs::path& directory) {
    if (!fs::is_directory(directory)) {
        throw InputError(directory.string() + ": expected a directory of results, found " +
                         (fs::exists(directory) ? "a file" : "nothing" + nearest_directory(directory)));
    }
    if (!fs::exists(directory / "history.csv")) {
        throw InputError(directory.string() + ": expected a directory of results, found no history.csv in it" +
                         suggestion("history.csv", names_in(directory, false)));
    }
}

std::string missing_rows(const std::vector<StepRecord>& history, const std::vector<StepRecord>& equilibria,
                         const RunSummary& summary) {
    const int steps = summary.numbers.steps;
    const auto lacks = [steps](const std::vector<StepRecord>& rows) {
        return rows.empty() || rows.back().step < steps;
    };
    for (const auto& [name, rows] : {std::pair("history.csv", &history), std::pair("equilibria.csv", &equilibria)})
        if (steps > 0 && lacks(*rows))
            return fmt::format(
                "{} ends at load step {}, summary.json says {}: one of them is damaged or of another run", name,
                rows->empty() ? 0 : rows->back().step, steps);
    return {};
}

FinishedRun read_finished_run(const fs::path& directory, const std::string& name) {
    require_results(directory);
    FinishedRun run;
    run.name = name;
    run.directory = directory;
    run.history = read_rows(directory / "history.csv");
    if (run.history.empty()) throw InputError((directory / "history.csv").string() + ": no load step in it yet");
    run.equilibria = read_rows(directory / "equilibria.csv");
    if (fs::exists(directory / "cracks.csv")) {
        run.cracks = read_cracks(directory / "cracks.csv");
    } else {
        run.notes.push_back(directory.string() + " has no cracks.csv");
    }
    Plane plane = Plane::strain;
    read_model(run, plane);
    if (fs::exists(directory / "summary.json")) {
        run.summary = read_summary(directory / "summary.json");
        run.platen_stage = run.summary->platen_stage;
        run.numbers = run.summary->numbers;
        if (std::string missing = missing_rows(run.history, run.equilibria, *run.summary); !missing.empty())
            run.notes.push_back(fmt::format("{}: {}", run.name, missing));
        return run;
    }
    run.notes.push_back(directory.string() + " has no summary.json: its numbers are made from its tables");
    if (run.model) {
        const int stage = make_gauges(*run.model).first_platen_stage;
        if (stage >= 0) run.platen_stage = stage;
    }
    // of a body that is not known its tables are taken for those of a platen
    const std::optional<int> of_platen = run.model ? run.platen_stage : 0;
    run.numbers = curve_numbers(run.equilibria, run.history, of_platen, plane,
                                run.model ? run.model->compliance_across : std::nullopt);
    if (run.model && !has_elastic_constants(*run.model)) clear_elastic_constants(run.numbers);
    if (!run.model) { // of which stage is not known
        CurveNumbers& numbers = run.numbers;
        for (std::optional<double>* const constant :
             {&numbers.axial_modulus, &numbers.lateral_ratio, &numbers.youngs_modulus, &numbers.poissons_ratio})
            constant->reset();
    }
    return run;
}

} // namespace kluft

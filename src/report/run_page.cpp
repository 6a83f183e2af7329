#include "kluft/report/run_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/shell_line.hpp"
#include "kluft/core/version.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/field_reader.hpp"
#include "kluft/output/field_series.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/kept_states.hpp"
#include "kluft/report/number_table.hpp"
#include "kluft/report/report_page.hpp"
#include "kluft/report/run_answer.hpp"
#include "kluft/report/run_of_results.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/rock_constants.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "page_files.hpp"
#include "run_arrays.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Rows = std::vector<StepRecord>;

/// Numbers as a list of JSON with seven digits; null for what is not finite.
std::string json_numbers(const std::vector<double>& numbers) {
    std::string text = "[";
    for (const double number : numbers) {
        if (text.size() > 1) text += ',';
        text += std::isfinite(number) ? fmt::format("{:.7g}", number) : "null";
    }
    return text + ']';
}

/// Texts that may hold bytes that are no UTF-8.
std::string json_value(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string json_columns(const NumberTable& table) {
    std::string text = "{";
    for (std::size_t i = 0; i < table.names.size(); ++i) {
        if (i > 0) text += ',';
        text += json_value(table.names[i]) + ':' + json_numbers(table.columns[i]);
    }
    return text + '}';
}

/// The balanced equilibria along the platen's way, of which a curve is drawn.
std::string json_fine(const Rows& equilibria, std::optional<int> platen_stage) {
    if (!platen_stage) return "{}";
    std::vector<double> strain, differential, axial;
    for (const StepRecord& row : platen_rows(equilibria, *platen_stage)) {
        if (!row.balanced) continue;
        strain.push_back(row.axial_strain);
        differential.push_back(row.differential_stress);
        axial.push_back(row.axial_stress);
    }
    return fmt::format(R"({{"axial_strain":{},"differential_stress":{},"axial_stress":{}}})", json_numbers(strain),
                       json_numbers(differential), json_numbers(axial));
}

std::string json_histories(const HistoriesTable& table) {
    std::vector<double> steps;
    NumberTable columns{table.columns, std::vector<std::vector<double>>(table.columns.size())};
    for (const StepRecord& row : table.rows) {
        steps.push_back(row.step);
        for (std::size_t i = 0; i < table.columns.size(); ++i) columns.columns[i].push_back(row.histories[i]);
    }
    return fmt::format(R"({{"step":{},"columns":{}}})", json_numbers(steps), json_columns(columns));
}

template <class Items> Json names_of(const Items& items) {
    Json names = Json::array();
    for (const auto& each : items) names.push_back(each.name);
    return names;
}

std::string json_names(const Scene& scene, const BlockSystem& system) {
    Json names;
    names["materials"] = names_of(scene.materials);
    names["interfaces"] = names_of(scene.interface_types);
    names["fractures"] = names_of(scene.geometry.fractures);
    names["stages"] = names_of(scene.loads.stages);
    names["blocks"] = system.block_names;
    return json_value(names);
}

/// The states that go into a page: of those kept, as many as there is room for.
std::vector<int> chosen_states(const std::vector<int>& kept, std::optional<int> peak, std::size_t most) {
    if (kept.size() <= most || kept.size() < 3) return kept;
    const std::size_t stride = (kept.size() + std::max<std::size_t>(1, most) - 1) / std::max<std::size_t>(1, most);
    std::vector<int> chosen;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (i % stride == 0 || i + 1 == kept.size() || kept[i] == peak) chosen.push_back(kept[i]);
    return chosen;
}

std::optional<std::size_t> nearest_place(const std::vector<int>& steps, std::optional<int> step) {
    if (!step || steps.empty()) return std::nullopt;
    const auto nearest = std::ranges::min_element(steps, {}, [&](int each) { return std::abs(each - *step); });
    return static_cast<std::size_t>(nearest - steps.begin());
}

struct Number {
    std::string name;
    std::string value;
};

void add_stress(std::vector<Number>& numbers, const std::string& name, std::optional<double> value) {
    if (value) numbers.push_back({name, fmt::format("{:.4g} MPa", 1e-6 * *value)});
}

std::vector<Number> curve_results(const RunFacts& facts) {
    std::vector<Number> numbers;
    if (!facts.platen_stage) return numbers;
    const CurveNumbers& curve = facts.numbers;
    add_stress(numbers, "peak axial stress", curve.peak_stress);
    if (curve.peak_strain)
        numbers.push_back({"axial strain there", fmt::format("{:.4g} %", 100.0 * *curve.peak_strain)});
    add_stress(numbers, "residual axial stress", curve.residual_stress);
    add_stress(numbers, "Young's modulus", curve.youngs_modulus);
    if (curve.poissons_ratio) numbers.push_back({"Poisson's ratio", fmt::format("{:.4g}", *curve.poissons_ratio)});
    add_stress(numbers, "slope of the curve", curve.axial_modulus);
    return numbers;
}

std::vector<Number> numbers_of(const RunFacts& facts, const BlockSystem& system) {
    std::vector<Number> numbers = curve_results(facts);
    const CurveNumbers& curve = facts.numbers;
    const auto add = [&](const std::string& name, const std::string& value) { numbers.push_back({name, value}); };
    if (facts.summary && facts.summary->results.factor_of_safety)
        add(factor_name(facts.reduced_alone), fmt::format("{:.6g}", *facts.summary->results.factor_of_safety));
    if (facts.summary && facts.summary->results.estimated_error)
        add("estimated error", fmt::format("{:.2g} %", 100.0 * *facts.summary->results.estimated_error));
    add("cracks in tension, shear", fmt::format("{}, {}", curve.cracks_tension, curve.cracks_shear));
    add("jumps", std::to_string(curve.jumps));
    add("load steps", std::to_string(curve.steps));
    add("not balanced", std::to_string(curve.unbalanced_steps));
    add("blocks", std::to_string(system.n_blocks()));
    add("interfaces", std::to_string(system.n_interfaces()));
    if (!facts.summary) return numbers;
    const RunSummary& summary = *facts.summary;
    constexpr double mega = 1e6;
    add("unknowns", std::to_string(summary.unknowns));
    add("ended", status_name(summary.status));
    if (summary.motion)
        add("time steps", std::to_string(summary.motion->time_steps));
    else
        add("linear solves", std::to_string(summary.costs.open_close_iterations));
    add("time", fmt::format("{:.1f} s", summary.costs.elapsed_s));
    add("processor time", fmt::format("{:.1f} s", summary.cpu_s));
    add("memory", fmt::format("{:.0f} MB", static_cast<double>(summary.peak_memory_bytes) / mega));
    add("version", summary.version);
    return numbers;
}

std::string numbers_html(const std::vector<Number>& numbers) {
    std::string text;
    for (const auto& [name, value] : numbers)
        text += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", html_text(name), html_text(value));
    return text;
}

std::string warnings_html(const std::vector<std::string>& warnings) {
    if (warnings.empty()) return "";
    std::string text = "<ul class=\"warnings\" aria-label=\"Warnings\">\n";
    for (const std::string& warning : warnings) text += "<li>" + html_text(warning) + "</li>\n";
    return text + "</ul>";
}

std::string text_of(const fs::path& path) { return fs::exists(path) ? read_file(path) : std::string{}; }

/// The states as elements of the page, and what is told of them.
struct PackedStates {
    std::vector<int> steps;
    std::string elements;
    std::vector<std::string> warnings; ///< of damaged ones
};

PackedStates pack_states(const fs::path& directory, const BlockSystem& system, std::optional<int> peak,
                         const RunPageOptions& options) {
    const std::vector<int> kept = kept_steps(directory);
    const std::size_t most = options.most_bytes_of_states / std::max<std::size_t>(1, bytes_of_state(system));
    PackedStates packed;
    for (const int step : chosen_states(kept, peak, most)) {
        try {
            packed.elements += data_element("state-" + std::to_string(packed.steps.size()),
                                            state_arrays(system, read_fields(directory, step, system)).json());
            packed.steps.push_back(step);
        } catch (const InputError& error) {
            if (!options.leaves_out_damaged_states) throw;
            packed.warnings.push_back(fmt::format("the report is without load step {}: {}", step, error.what()));
        }
    }
    if (!packed.steps.empty()) packed.elements += data_element("shape", shape_arrays(system).json());
    return packed;
}

std::string json_states(const std::vector<int>& steps) {
    std::string text = "[";
    for (const int step : steps) text += fmt::format("{}{{\"step\":{}}}", text.size() > 1 ? "," : "", step);
    return text + "]";
}

/// The largest strength factor of the equilibria at which strengths were being reduced. Those while the loads are brought
/// up say nothing of the body under all of them.
std::optional<double> factor_that_stood(const Rows& history, const LoadProgram& loads) {
    std::optional<double> largest;
    for (const StepRecord& row : history) {
        const bool is_stage = row.stage >= 0 && row.stage < static_cast<int>(loads.stages.size());
        if (!is_stage || !loads.stages[static_cast<std::size_t>(row.stage)].strength_reduction) continue;
        if (!row.balanced || !row.strength_factor) continue;
        largest = std::max(largest.value_or(*row.strength_factor), *row.strength_factor);
    }
    return largest;
}

bool looks_for_factor_of_safety(const Model& model) { return reduction_of(model.loads, 0) != nullptr; }

/// What is known of the run with the model that it ran.
constexpr double same_number = 1e-6; ///< relative

/// Whether the tables give other numbers than the run wrote at its end.
bool differ(const CurveNumbers& told, const CurveNumbers& found) {
    const double a = told.peak_stress.value_or(0.0);
    const double b = found.peak_stress.value_or(0.0);
    return told.steps != found.steps || std::abs(a - b) > same_number * std::max(std::abs(a), std::abs(b));
}

RunFacts facts_of(const fs::path& directory, const Rows& history, const Rows& equilibria, const Scene& scene,
                  const Model& model, const CutReport& cut) {
    RunFacts facts;
    const int stage = make_gauges(model).first_platen_stage;
    if (stage >= 0) facts.platen_stage = stage;
    facts.numbers = curve_numbers(equilibria, history, facts.platen_stage, scene.plane, model.compliance_across);
    if (fs::exists(directory / "summary.json")) facts.summary = read_summary(directory / "summary.json");
    clear_round_off(largest_modulus(scene.materials), facts.numbers);
    if (!has_elastic_constants(model)) clear_elastic_constants(facts.numbers);
    if (facts.summary) clear_round_off(largest_modulus(scene.materials), facts.summary->numbers);
    if (facts.summary && !facts.summary->numbers.residual_stress) facts.numbers.residual_stress.reset();
    facts.sense = platen_sense(history, facts.platen_stage);
    facts.peak = peak_row(equilibria.empty() ? history : equilibria, facts.platen_stage);
    facts.stood = factor_that_stood(history, model.loads);
    if (!history.empty()) facts.reduced_alone = reduced_alone(model, history.back().stage);
    facts.n_merged = cut.merged.size();
    facts.reduces_strength = looks_for_factor_of_safety(model);
    facts.tables_are_whole = !facts.summary || !differ(facts.summary->numbers, facts.numbers);
    return facts;
}

} // namespace

RunPage run_page(const fs::path& directory, const Scene& scene, const Model& model, const CutReport& cut,
                 const RunPageOptions& options) {
    const BlockSystem& system = model.system;
    const Rows history = read_history(directory / "history.csv");
    if (history.empty()) throw InputError((directory / "history.csv").string() + ": no load step in it yet");
    const fs::path fine = directory / "equilibria.csv";
    const Rows equilibria = fs::exists(fine) ? read_history(fine) : Rows{};
    const fs::path followed = directory / "histories.csv";
    const RunFacts facts = facts_of(directory, history, equilibria, scene, model, cut);
    const RunAnswer answer = run_answer(facts);
    const NumberTable rows = read_number_table(directory / "history.csv");
    const auto peak = step_of_peak(history, facts.platen_stage);
    const PackedStates states = pack_states(directory, system, peak, options);
    const auto peak_state = nearest_place(states.steps, peak);
    const std::string& title = heading_of(scene);
    const std::string run = fmt::format(
        R"({{"platen_stage":{},"sense":{},"peak_state":{},"rows":{},"fine":{},"histories":{},"states":{},"names":{}}})",
        facts.platen_stage ? std::to_string(*facts.platen_stage) : "null", facts.sense,
        peak_state ? std::to_string(*peak_state) : "null", json_columns(rows),
        json_fine(equilibria, facts.platen_stage),
        json_histories(fs::exists(followed) ? read_histories(followed) : HistoriesTable{}), json_states(states.steps),
        json_names(scene, system));
    std::string scene_text = text_of(directory / "scene.yaml");
    if (scene_text.empty()) scene_text = write_scene_as_run(scene);
    std::string program(version());
    if (!commit().empty()) program += " (" + std::string(commit()) + ")";
    const std::string where = directory.lexically_normal().string();
    std::vector<std::string> warnings = answer.warnings;
    warnings.insert(warnings.end(), states.warnings.begin(), states.warnings.end());
    ReportPage page;
    page.title = title;
    page.plots = true;
    page.further_styles = {"run.css"};
    page.further_programs = {"arrays.js", "body.js", "run.js"};
    page.body = filled(page_file("run.html"),
                       {{"title", html_text(title)},
                        {"directory", html_text(where)},
                        {"version", html_text(facts.summary ? facts.summary->version : program)},
                        {"open", answer.firm ? "" : " open"},
                        {"name", html_text(answer.name)},
                        {"value", html_text(answer.value)},
                        {"sentence", html_text(answer.sentence)},
                        {"warnings", warnings_html(warnings)},
                        {"numbers", numbers_html(numbers_of(facts, system))},
                        {"command", html_text(shell_line({"kluft", "run", (fs::path(where) / "scene.yaml").string(),
                                                          "-o", where + "-again"}))},
                        {"scene", html_text(scene_text)},
                        {"log", html_text(text_of(directory / "run.log"))},
                        {"data", data_element("run", escaped_json(run)) + states.elements}});
    return {html_of(page), states.warnings};
}

std::vector<std::string> write_run_page(const fs::path& directory, const Scene& scene, const Model& model,
                                        const CutReport& cut) {
    RunPageOptions options;
    options.leaves_out_damaged_states = true;
    const RunPage page = run_page(directory, scene, model, cut, options);
    write_file(directory / "report.html", page.html);
    return page.warnings;
}

void write_run_page(const fs::path& directory, const fs::path& file) {
    const RunOfResults run = run_of_results(directory);
    write_file(file, run_page(directory, run.scene, run.built.model, run.built.cut).html);
}

} // namespace kluft

#include "kluft/studies/study_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstring>
#include <map>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/csv_text.hpp"
#include "kluft/output/directory_lock.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/progress_line.hpp"
#include "kluft/output/run_writer.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/studies/comparison.hpp"
#include "kluft/studies/earlier_results.hpp"
#include "kluft/studies/study_report.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<std::string_view> curve_columns{"step", "stage", "axial_strain", "axial_stress",
                                                  "differential_stress"};

/// The JSON of a file; null where there is none or it cannot be understood.
Json json_of(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return {};
    Json json = Json::parse(read_file(path), nullptr, false);
    return json.is_object() ? json : Json{};
}

template <class T> T value_or(const Json& json, const char* key, T fallback) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    if (found == json.end()) return fallback;
    try {
        return found->template get<T>();
    } catch (const Json::exception&) {
        return fallback;
    }
}

std::optional<double> number_in(const Json& json, const std::string& key) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    if (found == json.end()) return std::nullopt;
    if (found->is_boolean()) return found->get<bool>() ? 1.0 : 0.0;
    return found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

std::vector<std::optional<double>> quantities_in(const Json& summary, const std::vector<std::string>& names) {
    std::vector<std::optional<double>> values;
    for (const auto& name : names) values.push_back(number_in(summary, name));
    return values;
}

/// By all equilibria, with those at which bonds break between the ends of the load steps. Nothing of a run that moves no platen:
/// its strains follow from loads, and are no curve.
std::vector<Vec2> curve_in(const fs::path& directory, const Json& summary) {
    if (!number_in(summary, "platen_stage")) return {};
    try {
        const fs::path equilibria = directory / "equilibria.csv";
        auto rows = fs::exists(equilibria) ? read_history(equilibria, curve_columns) : std::vector<StepRecord>{};
        if (rows.empty()) rows = read_history(directory / "history.csv", curve_columns);
        return growing_curve(platen_rows(rows, value_or(summary, "platen_stage", 0)));
    } catch (const InputError&) {
        return {};
    }
}

std::string first_message(const fs::path& directory) {
    const fs::path path = directory / "messages.txt";
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return {};
    const std::string text = read_file(path);
    return text.substr(0, text.find('\n'));
}

Json description(const PlannedCase& one, const std::string& scene) {
    Json json;
    json["scene"] = scene;
    json["settings"] = Json::array();
    for (const auto& setting : one.set) json["settings"].push_back(setting.assignment());
    json["digest"] = one.digest;
    return json;
}

bool is_described(const fs::path& directory, const PlannedCase& one) {
    return value_or(json_of(directory / "case.json"), "digest", std::string{}) == one.digest;
}

/// As it was given where it is short.
std::string time_limit_text(double seconds) {
    constexpr double minute = 60.0;
    return seconds < minute ? fmt::format("{:g} s", seconds) : readable_time(seconds);
}

/// Why a program that left no final summary ended.
void judge_outcome(const Study& study, const CaseOutcome& outcome, const fs::path& directory, CaseResult& result) {
    constexpr int done = 0, bad_input = 2, no_equilibrium = 3, out_of_resources = 4;
    constexpr int of_signals = 128; // beyond it: stopped by a signal, with the state saved
    const bool stopped_early = outcome.signal == SIGINT || outcome.signal == SIGTERM; // before there was a state
    const std::string message = first_message(directory);
    const std::string why = message.empty() ? "" : ": " + message;
    result.status = CaseStatus::failed;
    if (outcome.out_of_time) {
        result.reason = "stopped after the time limit of " + time_limit_text(study.time_limit);
    } else if (outcome.signal == 0 && (outcome.exit_code == done || outcome.exit_code == no_equilibrium)) {
        result.reason = fmt::format(
            "expected the summary of a run that has ended in {}, found none; the study, run again, makes it anew",
            (directory / "summary.json").string());
    } else if (outcome.exit_code == bad_input) {
        result.status = CaseStatus::refused;
        result.reason = message;
    } else if (outcome.exit_code == out_of_resources) {
        result.reason = "out of disk or memory" + why;
        result.out_of_resources = true;
    } else if (outcome.exit_code > of_signals || stopped_early) {
        result.status = CaseStatus::waiting;
        result.reason = "interrupted";
    } else if (outcome.signal != 0) {
        result.reason = fmt::format("killed by signal {} ({}){}", outcome.signal, strsignal(outcome.signal), why);
    } else {
        result.reason = fmt::format("exit code {}{}", outcome.exit_code, why);
    }
}

/// Takes over what a final summary says; whether it is one.
bool judge_summary(const Json& summary, CaseResult& result) {
    const auto status = value_or(summary, "status", std::string{});
    if (status == status_name(RunStatus::done) || status == status_name(RunStatus::collapsed)) {
        result.status = CaseStatus::done;
        return true;
    }
    const bool ended = status == status_name(RunStatus::no_equilibrium) || status == status_name(RunStatus::unbalanced);
    if (!ended) return false;
    result.status = CaseStatus::no_equilibrium;
    const auto message = value_or(summary, "message", std::string{});
    result.reason = message.substr(0, message.find('\n'));
    return true;
}

// ---- comparison with the reference ---------------------------------------------------------------------------------

/// What one case is compared with.
struct Target {
    std::vector<std::optional<double>> quantities;
    std::vector<Vec2> curve;
};

std::optional<double> relative_error(const std::optional<double>& value, const std::optional<double>& reference) {
    if (!value || !reference) return std::nullopt;
    if (*value == *reference) return 0.0;
    const double error = (*value - *reference) / std::abs(*reference);
    return std::isfinite(error) ? std::optional(error) : std::nullopt;
}

/// The same target for all cases; none where they are compared with each other.
std::optional<Target> common_target(const Study& study) {
    const StudyReference& reference = study.reference;
    Target target;
    if (reference.kind == StudyReference::Kind::values) {
        for (const auto& name : study.quantities) {
            const auto found = reference.values.find(name);
            target.quantities.push_back(found == reference.values.end() ? std::nullopt : std::optional(found->second));
        }
        return target;
    }
    if (reference.kind != StudyReference::Kind::directory) return std::nullopt;
    const Json summary = json_of(reference.directory / "summary.json");
    target.quantities = quantities_in(summary, study.quantities);
    target.curve = curve_in(reference.directory, summary);
    return target;
}

void compare(const Study& study, const Target& target, const CaseResult& result, StudyCase& row) {
    row.errors.clear();
    for (std::size_t i = 0; i < study.quantities.size(); ++i)
        row.errors.push_back(relative_error(row.quantities[i], target.quantities[i]));
    if (study.curve) row.curve_error = curve_distance(target.curve, result.curve);
}

std::string settings_in_words(const Study& study, const PlannedCase& one) {
    std::vector<std::string> words;
    if (!one.variant.empty()) words.push_back("variant: " + one.variant);
    for (std::size_t p = 0; p < study.parameters.size(); ++p)
        if (!one.settings[p].empty()) words.push_back(study.parameters[p].key + ": " + one.settings[p]);
    return fmt::format("{}", fmt::join(words, ", "));
}

/// "the same case with stages.1.steps: 800".
std::string chosen_in_words(const Study& study) {
    std::vector<std::string> words;
    if (study.reference.variant) words.push_back("variant: " + *study.reference.variant);
    bool along_chosen = false;
    for (const auto& setting : study.reference.set) {
        words.push_back(setting.key + ": " + setting.value);
        along_chosen = along_chosen || (study.along && study.parameters[*study.along].key == setting.key);
    }
    if (study.along && !along_chosen) {
        const auto& finest = study.parameters[*study.along];
        words.push_back(finest.key + ": " + finest.values.back().value);
    }
    return fmt::format("the same case with {}", fmt::join(words, ", "));
}

void name_reference(const ReadStudy& read, const std::vector<std::optional<std::size_t>>& references,
                    StudyTable& table) {
    const Study& study = read.study;
    switch (study.reference.kind) {
    case StudyReference::Kind::none:
        table.reference_name = "none";
        return;
    case StudyReference::Kind::values:
        table.reference_name = "closed form";
        return;
    case StudyReference::Kind::directory:
        table.reference_name = study.reference.directory.string();
        return;
    case StudyReference::Kind::chosen:
        break;
    }
    std::set<std::size_t> different;
    for (const auto& each : references)
        if (each) different.insert(*each);
    if (different.empty()) {
        table.reference_name = "none";
    } else if (different.size() == 1) {
        table.reference = *different.begin();
        const PlannedCase& one = read.cases[*table.reference];
        const std::string settings = settings_in_words(study, one);
        table.reference_name = "case " + one.name + (settings.empty() ? "" : " (" + settings + ")");
    } else {
        table.reference_name = chosen_in_words(study);
    }
}

StudyCase row_of(const Study& study, const PlannedCase& one, const CaseResult& result) {
    StudyCase row;
    row.name = one.name;
    row.variant = one.variant;
    row.settings = one.settings;
    row.replica = one.replica;
    row.status = result.status;
    row.reason = result.reason;
    row.out_of_resources = result.out_of_resources;
    row.quantities = result.quantities;
    row.quantities.resize(study.quantities.size());
    row.errors.resize(study.quantities.size());
    row.cpu_s = result.cpu_s;
    row.elapsed_s = result.elapsed_s;
    return row;
}

// ---- CSV -----------------------------------------------------------------------------------------------------------

std::string csv_number(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }

std::string csv_line(const std::vector<std::string>& cells) { return fmt::format("{}\n", fmt::join(cells, ",")); }

std::string csv_header(const StudyTable& table) {
    std::vector<std::string> cells{"case", "variant"};
    for (const auto& key : table.parameters) cells.push_back(csv_text(key));
    cells.insert(cells.end(), {"replica", "status"});
    for (const auto& name : table.quantities) cells.push_back(name);
    for (const auto& name : table.quantities) cells.push_back("error_" + name);
    cells.insert(cells.end(), {"curve_error", "cpu_s", "elapsed_s", "reason"});
    return csv_line(cells);
}

std::string csv_row(const StudyCase& row) {
    std::vector<std::string> cells{csv_text(row.name), csv_text(row.variant)};
    for (const auto& value : row.settings) cells.push_back(csv_text(value));
    cells.insert(cells.end(), {std::to_string(row.replica), case_status_name(row.status)});
    for (const auto* values : {&row.quantities, &row.errors})
        for (const auto& value : *values) cells.push_back(csv_number(value));
    cells.push_back(csv_number(row.curve_error));
    for (const auto& seconds : {row.cpu_s, row.elapsed_s})
        cells.push_back(seconds ? fmt::format("{:.6g}", *seconds) : "");
    cells.push_back(csv_text(row.reason));
    return csv_line(cells);
}

} // namespace

std::vector<std::string> summary_quantities() {
    RunSummary summary;
    summary.motion = MotionReport{};
    std::vector<std::string> names;
    const Json json = Json::parse(summary_json(summary));
    for (const auto& [key, value] : json.items())
        if (value.is_number() || value.is_boolean() || (value.is_null() && key != "platen_stage")) names.push_back(key);
    return names;
}

fs::path case_directory(const fs::path& study_directory, const PlannedCase& one) {
    return study_directory / "cases" / one.name;
}

std::string noted_scene(const fs::path& scene, const fs::path& directory) {
    std::error_code error;
    const fs::path from_there = fs::relative(scene, directory, error); // both may be moved together
    const std::string text = error || from_there.empty() ? scene.string() : from_there.generic_string();
    return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

namespace {

constexpr const char* ways_out = "--force replaces it, -o names another directory";

struct NotedCase {
    fs::path directory;
    std::string scene;  ///< by its way from the directory of the study
    std::string digest; ///< of the scene with all settings
};

/// What the cases in the directory say of themselves.
std::vector<NotedCase> noted_cases(const fs::path& directory) {
    std::vector<NotedCase> cases;
    std::error_code error;
    for (fs::directory_iterator entry(directory / "cases", error), end; !error && entry != end;
         entry.increment(error)) {
        const Json json = json_of(entry->path() / "case.json");
        std::string scene = value_or(json, "scene", std::string{});
        if (!scene.empty()) cases.push_back({entry->path(), std::move(scene), value_or(json, "digest", std::string{})});
    }
    return cases;
}

/// Cases of another scene than this study's. In a directory that was moved or copied its own scene may have another way: it is
/// known by what it says.
std::vector<NotedCase> cases_of_other_scenes(const ReadStudy& read, const fs::path& directory) {
    std::map<fs::path, std::string> digests;
    for (const PlannedCase& one : read.cases) digests[case_directory(directory, one)] = one.digest;
    std::vector<NotedCase> cases = noted_cases(directory);
    std::set<std::string> ways{noted_scene(read.study.scene, directory)};
    for (const NotedCase& each : cases)
        if (const auto planned = digests.find(each.directory);
            planned != digests.end() && planned->second == each.digest)
            ways.insert(each.scene);
    std::erase_if(cases, [&](const NotedCase& each) { return ways.contains(each.scene); });
    return cases;
}

/// Whether something says that the directory is that of a study.
bool is_of_study(const fs::path& directory) {
    const fs::path table = directory / "study.csv";
    std::error_code error;
    return !noted_cases(directory).empty() ||
           (fs::is_regular_file(table, error) && read_file(table).starts_with("case,variant,"));
}

/// Whether something stands in the directory but what a study leaves there that was killed while it wrote case.json.
bool has_something(const fs::path& directory) {
    const fs::path unfinished = partial_name(directory / "case.json");
    std::error_code error;
    const fs::directory_iterator entries(directory, error);
    return std::any_of(begin(entries), end(entries), [&](const auto& entry) { return entry.path() != unfinished; });
}

/// A directory of a case that no study has made.
void require_no_foreign_case(const ReadStudy& read, const fs::path& directory) {
    for (const PlannedCase& one : read.cases) {
        const fs::path place = case_directory(directory, one);
        if (json_of(place / "case.json").is_null() && has_something(place))
            throw InputError(
                fmt::format("{}: expected a case that a study made or none, found another directory, which would be "
                            "lost; {}",
                            place.string(), ways_out));
    }
}

/// The first key in which the results of a case differ from what it says now; "" where that is not known.
std::string difference_of_case(const ReadStudy& read, const PlannedCase& one, const fs::path& place) {
    try {
        const auto earlier = scene_as_run_in(place);
        return earlier ? scene_difference(*earlier, read_scene(read.study.scene, run_settings(read, one))) : "";
    } catch (const InputError&) {
        return {};
    }
}

/// Results of a case whose scene or settings were others.
void require_no_changed_case(const ReadStudy& read, const fs::path& directory) {
    for (const PlannedCase& one : read.cases) {
        const fs::path place = case_directory(directory, one);
        if (is_described(place, one) || first_result_in(place).empty()) continue;
        const std::string difference = difference_of_case(read, one, place);
        throw InputError(fmt::format("{}: expected results of the scene and the settings as they are now or none, "
                                     "found in {} those before a change{}{}; --force runs such cases anew, -o names "
                                     "another directory",
                                     directory.string(), place.string(), difference.empty() ? "" : ": ", difference));
    }
}

} // namespace

std::vector<std::string> run_settings(const ReadStudy& read, const PlannedCase& one) {
    std::vector<std::string> settings{fmt::format("output.pictures={}", read.study.pictures), "output.report=false"};
    for (const auto& setting : one.set) settings.push_back(setting.assignment());
    return settings;
}

void remove_other_study(const ReadStudy& read, const fs::path& directory) {
    std::error_code ignored; // prepare_case tells what cannot be written
    for (const NotedCase& each : cases_of_other_scenes(read, directory)) fs::remove_all(each.directory, ignored);
}

void require_no_other_study(const ReadStudy& read, const fs::path& directory, const std::vector<std::string>& further) {
    if (const auto others = cases_of_other_scenes(read, directory); !others.empty())
        throw InputError(
            fmt::format("{}: expected results of a study of {} or none, found those of a study of {} in {}; --force "
                        "replaces them, -o names another directory",
                        directory.string(), noted_scene(read.study.scene, directory), others.front().scene,
                        others.front().directory.string()));
    if (!is_of_study(directory)) {
        std::vector<std::string> names{"study.csv", "study.md", "study.html", "cases.txt"};
        for (const auto& more : {further, study_pictures_in(directory)})
            names.insert(names.end(), more.begin(), more.end());
        require_no_foreign_file(directory, names, "a study", ways_out);
    }
    require_no_foreign_case(read, directory);
    require_no_changed_case(read, directory);
}

void prepare_case(const fs::path& directory, const PlannedCase& one, const std::string& scene) {
    if (is_described(directory, one)) return;
    if (is_locked(directory))
        throw InputError(directory.string() + ": expected no process that writes to it before it is made anew, found "
                                              "one; try again when that has ended");
    std::error_code error;
    fs::remove_all(directory, error);
    make_directory(directory);
    write_file(directory / "case.json",
               description(one, scene).dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void write_outcome(const fs::path& directory, const CaseOutcome& outcome) {
    Json json;
    json["exit_code"] = outcome.exit_code;
    json["signal"] = outcome.signal;
    json["out_of_time"] = outcome.out_of_time;
    if (outcome.cpu_s) json["cpu_s"] = *outcome.cpu_s;
    if (outcome.elapsed_s) json["elapsed_s"] = *outcome.elapsed_s;
    write_file(directory / "outcome.json", json.dump() + '\n');
}

std::optional<CaseOutcome> read_outcome(const fs::path& directory) {
    const Json json = json_of(directory / "outcome.json");
    if (json.is_null()) return std::nullopt;
    CaseOutcome outcome;
    outcome.exit_code = value_or(json, "exit_code", -1);
    outcome.signal = value_or(json, "signal", 0);
    outcome.out_of_time = value_or(json, "out_of_time", false);
    outcome.cpu_s = number_in(json, "cpu_s");
    outcome.elapsed_s = number_in(json, "elapsed_s");
    return outcome;
}

CaseResult read_case(const Study& study, const PlannedCase& one, const fs::path& directory) {
    CaseResult result;
    if (!one.refusal.empty()) {
        result.status = CaseStatus::refused;
        result.reason = one.refusal.substr(0, one.refusal.find('\n'));
        return result;
    }
    if (!is_described(directory, one)) return result;
    const Json summary = json_of(directory / "summary.json");
    const auto outcome = read_outcome(directory);
    result.cpu_s = number_in(summary, "loading_cpu_s");
    if (!result.cpu_s && outcome) result.cpu_s = outcome->cpu_s; // of a run that was killed
    result.elapsed_s = outcome && outcome->elapsed_s ? outcome->elapsed_s : number_in(summary, "elapsed_s");
    if (judge_summary(summary, result)) {
        result.quantities = quantities_in(summary, study.quantities);
        if (study.curve) result.curve = curve_in(directory, summary);
    } else if (outcome) {
        judge_outcome(study, *outcome, directory, result);
    }
    return result;
}

std::vector<CaseResult> read_cases(const ReadStudy& read, const fs::path& directory) {
    std::vector<CaseResult> results;
    for (const auto& one : read.cases) results.push_back(read_case(read.study, one, case_directory(directory, one)));
    return results;
}

StudyTable study_table(const ReadStudy& read, const std::vector<CaseResult>& results, const fs::path& directory) {
    const Study& study = read.study;
    StudyTable table;
    table.title = study.title.empty() ? study.name : study.title;
    table.directory = directory;
    table.quantities = study.quantities;
    table.along = study.along;
    table.own_settings = study.own_settings;
    for (const auto& parameter : study.parameters) table.parameters.push_back(parameter.key);
    const auto references = reference_cases(study, read.cases);
    name_reference(read, references, table);
    const auto common = common_target(study);
    for (std::size_t i = 0; i < read.cases.size(); ++i) {
        table.cases.push_back(row_of(study, read.cases[i], results[i]));
        if (results[i].quantities.empty()) continue;
        if (common) {
            compare(study, *common, results[i], table.cases.back());
        } else if (references[i] && !results[*references[i]].quantities.empty()) {
            const CaseResult& reference = results[*references[i]];
            compare(study, {reference.quantities, reference.curve}, results[i], table.cases.back());
        }
    }
    return table;
}

std::string case_status_name(CaseStatus status) {
    switch (status) {
    case CaseStatus::waiting:
        return "waiting";
    case CaseStatus::running:
        return "running";
    case CaseStatus::done:
        return "done";
    case CaseStatus::no_equilibrium:
        return "no_equilibrium";
    case CaseStatus::refused:
        return "refused";
    case CaseStatus::failed:
        return "failed";
    }
    return "";
}

std::string study_csv(const StudyTable& table) {
    std::string text = csv_header(table);
    for (const auto& row : table.cases) text += csv_row(row);
    return text;
}

} // namespace kluft

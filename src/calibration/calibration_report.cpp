#include "kluft/calibration/calibration_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/shell_line.hpp"
#include "kluft/core/units.hpp"
#include "kluft/core/version.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/output/progress_line.hpp"
#include "kluft/report/report_document.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/scene/scene_text.hpp"
#include "kluft/scene/scene_writer.hpp"
#include "kluft/studies/earlier_results.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* not_known = "-";

std::string percent_of(double fraction) { return fmt::format("{:.3g} %", percent * fraction); }
std::string signed_percent(double fraction) { return fmt::format("{:+.3g} %", percent * fraction); }

bool is_curve(const CalibrationTarget& target) { return target.quantity == TargetQuantity::curve; }

std::string wanted_text(const CalibrationTarget& target) {
    return is_curve(target) ? std::string("the measured one") : value_text(target.value, measure_of(target.quantity));
}

std::string found_text_of(const CalibrationTarget& target, const TargetResult& found) {
    if (!found.found) return not_known;
    return is_curve(target) ? "distance " + percent_of(*found.found)
                            : value_text(*found.found, measure_of(target.quantity));
}

/// "peak_stress: wanted 40 MPa, found 40.3 MPa (+0.75 %, tolerance 5 %)".
std::string target_line(const CalibrationTarget& target, const TargetResult& found) {
    if (!found.found) return fmt::format("{}: wanted {}, found nothing", target.name, wanted_text(target));
    const std::string difference = is_curve(target) ? "" : signed_percent(found.error) + ", ";
    return fmt::format("{}: wanted {}, found {} ({}tolerance {}): {}", target.name, wanted_text(target),
                       found_text_of(target, found), difference, percent_of(target.tolerance),
                       found.met ? "met" : "missed");
}

std::string parameter_line(const CalibrationParameter& parameter, const ParameterResult& found) {
    std::string text = fmt::format("{}: {}", parameter.name, value_text(found.value, parameter.measure));
    if (found.low)
        text += fmt::format(", 95 % between {} and {}", value_text(*found.low, parameter.measure),
                            value_text(*found.high, parameter.measure));
    if (found.at_bound) text += ", at its bound";
    if (!found.is_determined) text += ", not determined by the targets";
    return text;
}

std::vector<std::string> keys_in(const std::string& path) {
    std::vector<std::string> keys;
    for (std::size_t from = 0;;) {
        const std::size_t dot = path.find('.', from);
        keys.push_back(path.substr(from, dot - from));
        if (dot == std::string::npos) return keys;
        from = dot + 1;
    }
}

/// Puts what `whole` has at a path into `part`; a list on the way as a whole.
void take_over(const SceneNode& whole, const std::vector<std::string>& path, std::size_t depth, SceneNode& part) {
    if (depth == path.size() || !whole.is_mapping()) {
        part = whole;
        return;
    }
    const SceneNode* const source = whole.find(path[depth]);
    if (source == nullptr) return;
    part.kind = SceneNode::Kind::mapping;
    if (part.find(path[depth]) == nullptr) {
        part.keys.push_back({path[depth], {}});
        part.items.emplace_back();
    }
    take_over(*source, path, depth + 1, *part.find(path[depth]));
}

SceneNode override_tree(const Calibration& calibration, const CalibrationResult& result) {
    SceneSources sources;
    SceneErrors errors(sources);
    const auto settings = settings_at(calibration, result.x);
    const SceneNode whole = build_scene_tree(read_scene_bytes(calibration.scene), calibration.scene,
                                             assignments(settings), sources, errors);
    errors.throw_if_any();
    SceneNode part;
    part.kind = SceneNode::Kind::mapping;
    for (const StudySetting& setting : settings) take_over(whole, keys_in(setting.key), 0, part);
    return part;
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double plain(double value, Measure measure) { return measure == Measure::angle ? value * degrees : value; }

Json optional_plain(const std::optional<double>& value, Measure measure) {
    return value ? number_or_null(plain(*value, measure)) : Json(nullptr);
}

Json target_json(const CalibrationTarget& target, const TargetResult& found) {
    const Measure measure = is_curve(target) ? Measure::fraction : measure_of(target.quantity);
    Json json;
    json["name"] = target.name;
    json["quantity"] = quantity_name(target.quantity);
    json["value"] = plain(target.value, measure);
    json["tolerance"] = target.tolerance;
    json["weight"] = target.weight;
    json["found"] = optional_plain(found.found, measure);
    json["relative_difference"] = found.found ? number_or_null(found.error) : Json(nullptr);
    json["met"] = found.met;
    json["copies"] = Json::array();
    for (const double each : found.copies) json["copies"].push_back(number_or_null(plain(each, measure)));
    return json;
}

Json parameter_json(const CalibrationParameter& parameter, const ParameterResult& found) {
    Json json;
    json["name"] = parameter.name;
    json["keys"] = Json::object();
    for (const ParameterKey& key : parameter.keys)
        json["keys"][key.key] = number_or_null(plain(key.times * found.value, parameter.measure));
    json["unit"] = unit_name(parameter.measure);
    json["value"] = number_or_null(plain(found.value, parameter.measure));
    json["low"] = optional_plain(found.low, parameter.measure);
    json["high"] = optional_plain(found.high, parameter.measure);
    json["start"] = plain(parameter.start, parameter.measure);
    json["from"] = plain(parameter.from, parameter.measure);
    json["to"] = plain(parameter.to, parameter.measure);
    json["at_bound"] = found.at_bound;
    json["determined"] = found.is_determined;
    return json;
}

std::string costs_text(const CalibrationResult& result) {
    return fmt::format("{} solutions of the elastic body, {} parameter sets run, {}", result.elastic_evaluations,
                       result.evaluations, readable_time(result.elapsed_s));
}

// ---- the report ------------------------------------------------------------------------------------------------------

/// A report while it grows, and the directory of its pictures.
struct ReportPage {
    fs::path directory;
    ReportDocument parts;
};

/// Name of a curve's pictures, without the ending.
std::string stem_of(const CalibrationTarget& target) {
    std::string stem = target.name;
    std::ranges::replace(stem, ' ', '-');
    return stem;
}

/// Names of all files that write_calibration may write.
std::vector<std::string> written_files(const Calibration& calibration) {
    std::vector<std::string> names{"calibrated.yaml", "calibration.json", "report.html"};
    std::vector<std::string> stems{"progress", "envelope"};
    for (const CalibrationTarget& target : calibration.targets)
        if (is_curve(target)) stems.push_back(stem_of(target));
    for (const std::string& stem : stems)
        for (const char* ending : {".png", ".svg"}) names.push_back(stem + ending);
    return names;
}

void add_picture(const std::string& stem, const CurvePlot& plot, ReportPage& page) {
    const std::string svg = draw_curves(plot, PictureFormat::svg);
    write_file(page.directory / (stem + ".svg"), svg);
    write_file(page.directory / (stem + ".png"), draw_curves(plot, PictureFormat::png));
    page.parts.emplace_back(ReportPicture{stem + ".png", plot.title, svg});
}

void add_targets(const Calibration& calibration, const CalibrationResult& result, ReportPage& page) {
    page.parts.emplace_back(ReportHeading{2, "Targets"});
    ReportTable table{{"target", "wanted", "found", "difference", "tolerance", "", "copies"}, {}, {}, 3};
    for (std::size_t i = 0; i < calibration.targets.size(); ++i) {
        const CalibrationTarget& target = calibration.targets[i];
        const TargetResult& found = result.targets[i];
        std::string copies;
        for (const double each : found.copies)
            copies += (copies.empty() ? "" : ", ") +
                      (is_curve(target) ? percent_of(each) : value_text(each, measure_of(target.quantity)));
        if (!found.met) table.marked.push_back(table.rows.size());
        table.rows.push_back({target.name, wanted_text(target), found_text_of(target, found),
                              found.found && !is_curve(target) ? signed_percent(found.error) : not_known,
                              percent_of(target.tolerance), found.met ? "met" : "missed", copies});
    }
    page.parts.emplace_back(std::move(table));
    for (const std::string& warning : result.warnings) page.parts.emplace_back(ReportParagraph{warning});
    if (result.obstacles.empty()) return;
    page.parts.emplace_back(ReportParagraph{"What stands in the way:"});
    page.parts.emplace_back(ReportList{result.obstacles});
}

void add_parameters(const Calibration& calibration, const CalibrationResult& result, ReportPage& page) {
    page.parts.emplace_back(ReportHeading{2, "Parameters"});
    ReportTable table{{"parameter", "keys", "value", "95 % from", "to", "start", "bounds", "remark"}, {}, {}, 2};
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        const CalibrationParameter& parameter = calibration.parameters[i];
        const ParameterResult& found = result.parameters[i];
        const auto text = [&](double value) { return value_text(value, parameter.measure); };
        std::string keys;
        for (const ParameterKey& key : parameter.keys)
            keys += (keys.empty() ? "" : ", ") + key.key +
                    (key.times == 1.0 ? "" : fmt::format(" (times {:g})", key.times));
        table.rows.push_back({parameter.name, keys, text(found.value), found.low ? text(*found.low) : not_known,
                              found.high ? text(*found.high) : not_known, text(parameter.start),
                              text(parameter.from) + " - " + text(parameter.to),
                              found.at_bound         ? "at its bound"
                              : !found.is_determined ? "not determined by the targets"
                                                     : ""});
    }
    page.parts.emplace_back(std::move(table));
    page.parts.emplace_back(ReportParagraph{
        "The intervals come from the scatter of the copies, carried through the derivatives at the result; they do not "
        "know what the model leaves out. Without at least two replicas there are none."});
}

void add_progress(const CalibrationResult& result, ReportPage& page) {
    PlottedCurve curve;
    PlottedCurve best;
    best.thin = true;
    for (std::size_t i = 0; i < result.worst.size(); ++i) {
        if (!std::isfinite(result.worst[i])) continue;
        curve.points.push_back({Vec2(static_cast<double>(i + 1), result.worst[i]), true});
        const double before = best.points.empty() ? result.worst[i] : best.points.back().value.y();
        best.points.push_back({Vec2(static_cast<double>(i + 1), std::min(before, result.worst[i])), true});
    }
    if (curve.points.size() < 2) return;
    curve.label = "parameter set";
    curve.joined = false;
    best.label = "best so far";
    CurvePlot plot;
    plot.title = "Largest difference from a target, in tolerances";
    plot.x_name = "parameter set";
    plot.y_name = "difference/tolerance";
    plot.curves = {curve, best};
    plot.references.push_back({"all targets met", std::nullopt, 1.0});
    plot.log_y = true;
    page.parts.emplace_back(ReportHeading{2, "Search"});
    add_picture("progress", plot, page);
}

PlottedCurve in_plot_units(const std::string& label, const std::vector<Vec2>& curve) {
    PlottedCurve plotted;
    plotted.label = label;
    for (const Vec2& point : curve) plotted.points.push_back({Vec2(percent * point.x(), point.y() / mega), true});
    return plotted;
}

void add_curve(const Calibration& calibration, const CalibrationTarget& target, const CalibrationResult& result,
               ReportPage& page) {
    const auto found = curve_at(calibration, target, page.directory, result.x);
    if (found.empty()) return;
    CurvePlot plot;
    plot.title = "Measured and calibrated curve";
    plot.x_name = "axial strain (%)";
    plot.y_name = "differential stress (MPa)";
    plot.curves = {in_plot_units("measured", target.curve), in_plot_units("calibrated", found)};
    add_picture(stem_of(target), plot, page);
}

void add_envelope(const Calibration& calibration, const CalibrationTarget& target, const CalibrationResult& result,
                  ReportPage& page) {
    const auto peaks = peaks_at(calibration, target, page.directory, result.x);
    try {
        const StrengthFit envelope = fit_strength(peaks);
        const std::string title = "Envelope of the calibrated scene";
        const std::string svg = draw_envelope(title, peaks, envelope, {}, PictureFormat::svg);
        write_file(page.directory / "envelope.svg", svg);
        write_file(page.directory / "envelope.png", draw_envelope(title, peaks, envelope, {}, PictureFormat::png));
        page.parts.emplace_back(ReportPicture{"envelope.png", title, svg});
    } catch (const InputError& error) {
        page.parts.emplace_back(ReportParagraph{error.what()});
    }
}

void add_pictures(const Calibration& calibration, const CalibrationResult& result, ReportPage& page) {
    bool has_envelope = false;
    for (const CalibrationTarget& target : calibration.targets) {
        if (is_curve(target)) add_curve(calibration, target, result, page);
        if (is_of_envelope(target.quantity) && !has_envelope) add_envelope(calibration, target, result, page);
        has_envelope = has_envelope || is_of_envelope(target.quantity);
    }
}

ReportDocument report_of(const Calibration& calibration, const CalibrationResult& result, const fs::path& directory) {
    ReportPage page{directory, {}};
    page.parts.emplace_back(ReportHeading{
        1, calibration.title.empty() ? "Calibration of " + calibration.scene.filename().string() : calibration.title});
    std::string values;
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i)
        values += (i == 0 ? "" : "; ") + parameter_line(calibration.parameters[i], result.parameters[i]);
    page.parts.emplace_back(
        ReportAnswer{"Calibration", result.met ? "All targets are met." : "Not all targets are met.",
                     values + ". " + costs_text(result) + ".",
                     shell_line({"kluft", "run", (directory / "calibrated.yaml").lexically_normal()}), result.met});
    add_targets(calibration, result, page);
    add_parameters(calibration, result, page);
    add_progress(result, page);
    add_pictures(calibration, result, page);
    return page.parts;
}

} // namespace

std::string calibrated_scene(const Calibration& calibration, const CalibrationResult& result,
                             const fs::path& directory) {
    std::string text =
        fmt::format("# Calibrated by Kluft {} from {}.\n", version(), calibration.file.filename().string());
    for (std::size_t i = 0; i < calibration.targets.size(); ++i)
        text += "# " + target_line(calibration.targets[i], result.targets[i]) + "\n";
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i)
        text += "# " + parameter_line(calibration.parameters[i], result.parameters[i]) + "\n";
    for (const std::string& warning : result.warnings) text += "# " + warning + "\n";
    const fs::path base = calibration.scene.lexically_proximate(fs::absolute(directory).lexically_normal());
    const Json quoted = base.string(); // a quoted text is the same in JSON and YAML
    text += "kluft: 1\nextends: " + quoted.dump() + "\n";
    const SceneSources none;
    return text + write_scene_tree(override_tree(calibration, result), none);
}

std::string calibration_json(const Calibration& calibration, const CalibrationResult& result) {
    Json json;
    json["scene"] = calibration.scene.string();
    json["met"] = result.met;
    json["targets"] = Json::array();
    for (std::size_t i = 0; i < calibration.targets.size(); ++i)
        json["targets"].push_back(target_json(calibration.targets[i], result.targets[i]));
    json["parameters"] = Json::array();
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i)
        json["parameters"].push_back(parameter_json(calibration.parameters[i], result.parameters[i]));
    json["obstacles"] = result.obstacles;
    json["warnings"] = result.warnings;
    json["elastic_evaluations"] = result.elastic_evaluations;
    json["evaluations"] = result.evaluations;
    json["replicas"] = calibration.replicas.count;
    json["elapsed_s"] = number_or_null(result.elapsed_s);
    json["version"] = version();
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::string calibration_text(const Calibration& calibration, const CalibrationResult& result) {
    std::string text;
    for (std::size_t i = 0; i < calibration.targets.size(); ++i)
        text += target_line(calibration.targets[i], result.targets[i]) + "\n";
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i)
        text += parameter_line(calibration.parameters[i], result.parameters[i]) + "\n";
    for (const std::string& obstacle : result.obstacles) text += obstacle + "\n";
    for (const std::string& warning : result.warnings) text += "warning: " + warning + "\n";
    return text + costs_text(result) + "\n";
}

void require_no_other_calibration(const Calibration& calibration, const fs::path& directory) {
    require_no_run_in(directory);
    const fs::path earlier = directory / "calibration.json";
    std::error_code error;
    const Json json =
        fs::is_regular_file(earlier, error) ? Json::parse(read_file(earlier), nullptr, false) : Json(nullptr);
    if (!json.is_object() || !json.contains("scene"))
        return require_no_foreign_file(directory, written_files(calibration), "a calibration",
                                       "-o names another directory");
    if (json["scene"] != Json(calibration.scene.string()))
        throw InputError(
            fmt::format("{}: expected results of this calibration or none, found those of one of the scene {}; -o "
                        "names another directory",
                        directory.string(), json["scene"].dump()));
}

void write_calibration(const Calibration& calibration, const CalibrationResult& result, const fs::path& directory) {
    make_directory(directory);
    write_file(directory / "calibration.json",
               calibration_json(calibration, result)); // first: it says whose the others are
    write_file(directory / "calibrated.yaml", calibrated_scene(calibration, result, directory));
    write_file(directory / "report.html", report_html(report_of(calibration, result, directory)));
}

} // namespace kluft

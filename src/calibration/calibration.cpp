#include "kluft/calibration/calibration.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "kluft/core/units.hpp"

namespace kluft {

namespace {

constexpr Range above_zero{.least = 0.0, .open_below = true};

struct QuantityRow {
    TargetQuantity quantity;
    std::string_view name;
    Measure measure;
    std::string_view doc;
    Range range = above_zero;
};

constexpr std::array quantity_rows{
    QuantityRow{TargetQuantity::youngs_modulus, "youngs_modulus", Measure::stress,
                "Young's modulus of the rock, of the whole body with all bonds whole and mapped fractures closed."},
    QuantityRow{TargetQuantity::poissons_ratio, "poissons_ratio", Measure::fraction, "Poisson's ratio of the same.",
                Range{.least = 0.0, .most = 0.5, .open_below = true, .open_above = true}},
    QuantityRow{TargetQuantity::peak_stress, "peak_stress", Measure::stress,
                "Largest axial stress of a run, as peak_stress in summary.json."},
    QuantityRow{TargetQuantity::peak_strain, "peak_strain", Measure::fraction, "Axial strain at the peak."},
    QuantityRow{TargetQuantity::residual_stress, "residual_stress", Measure::stress,
                "Mean axial stress over the last tenth of the strain, behind a peak."},
    QuantityRow{TargetQuantity::tensile_strength, "tensile_strength", Measure::stress,
                "Largest tension, above zero, of a run that pulls with glued platens."},
    QuantityRow{TargetQuantity::cohesion, "cohesion", Measure::stress,
                "Of the envelope through the peaks at several lateral pressures."},
    QuantityRow{TargetQuantity::friction_angle, "friction_angle", Measure::angle, "Of the same envelope.",
                Range{.least = 0.0, .most = 90.0, .open_below = true, .open_above = true}},
    QuantityRow{TargetQuantity::curve, "curve", Measure::stress, "A measured curve."},
};

const QuantityRow& row_of(TargetQuantity quantity) { return quantity_rows.at(static_cast<std::size_t>(quantity)); }

/// Paths of the keys of each kind of target: the schema's views need texts that stay.
const std::vector<std::array<std::string, 9>>& target_paths() {
    static const std::vector<std::array<std::string, 9>> paths = [] {
        std::vector<std::array<std::string, 9>> all;
        for (const auto& row : quantity_rows) {
            const std::string path = fmt::format("targets.{}", row.name);
            all.push_back({path, path + ".value", path + ".file", path + ".tolerance", path + ".weight", path + ".set",
                           path + ".set.*", path + ".scene", path + ".pressures"});
        }
        return all;
    }();
    return paths;
}

void add_target_rules(const QuantityRow& row, std::vector<KeyRule>& rules) {
    const auto& path = target_paths().at(static_cast<std::size_t>(row.quantity));
    rules.push_back({.path = path[0], .type = KeyType::mapping_or_mappings, .doc = row.doc});
    if (row.quantity == TargetQuantity::curve)
        rules.push_back({.path = path[2],
                         .type = KeyType::text,
                         .required = true,
                         .doc = "CSV file with the columns axial_strain and differential_stress (Pa, both positive in "
                                "compression), relative to the calibration file; history.csv of a run is one."});
    else
        rules.push_back({.path = path[1],
                         .type = KeyType::number,
                         .measure = row.measure,
                         .range = row.range,
                         .required = true,
                         .doc = "What is wanted."});
    rules.push_back({.path = path[3],
                     .type = KeyType::number,
                     .range = above_zero,
                     .required = true,
                     .doc = row.quantity == TargetQuantity::curve
                                ? "Largest distance of the curves, the root of the mean square of their differences "
                                  "over the largest measured stress."
                                : "Largest difference, relative to the value."});
    rules.push_back({.path = path[4],
                     .type = KeyType::number,
                     .range = above_zero,
                     .fallback = "1",
                     .doc = "Of the square of the difference over the tolerance, where targets oppose each other."});
    rules.push_back({.path = path[5],
                     .type = KeyType::named,
                     .doc = "Keys of the scene and their values, for this "
                            "target alone."});
    rules.push_back({.path = path[6], .type = KeyType::value, .doc = "A value, as the scene has it."});
    rules.push_back({.path = path[7],
                     .type = KeyType::text,
                     .fallback_note = "the calibration's",
                     .doc = "Another scene for this target, relative to the calibration file."});
    if (!is_of_envelope(row.quantity)) return;
    rules.push_back({.path = path[8],
                     .type = KeyType::texts,
                     .measure = Measure::stress,
                     .required = true,
                     .least_items = 2,
                     .doc = "Lateral pressures of the runs: each is given to all boundaries that stage 0 presses."});
}

std::vector<KeyRule> rules_of_calibration() {
    std::vector<KeyRule> rules{
        {.path = "kluft_calibration",
         .type = KeyType::integer,
         .range = {.least = 1.0, .most = 1.0},
         .required = true,
         .doc = "Version of the format, 1."},
        {.path = "title", .type = KeyType::text, .doc = "Of the report."},
        {.path = "scene",
         .type = KeyType::text,
         .required = true,
         .doc = "The scene whose keys move, relative to this file."},
        {.path = "parameters",
         .type = KeyType::named,
         .required = true,
         .least_items = 1,
         .doc = "What may move, by names of your own."},
        {.path = "parameters.*", .type = KeyType::mapping, .doc = "A number above zero."},
        {.path = "parameters.*.keys",
         .type = KeyType::list,
         .required = true,
         .least_items = 1,
         .doc = "Keys of the scene that have the parameter's value: a path, or {key: path, times: factor}."},
        {.path = "parameters.*.keys.#", .type = KeyType::text_or_mapping, .doc = "One key."},
        {.path = "parameters.*.keys.#.key", .type = KeyType::text, .required = true, .doc = "Path in the scene."},
        {.path = "parameters.*.keys.#.times",
         .type = KeyType::number,
         .range = above_zero,
         .fallback = "1",
         .doc = "The key's value over the parameter's."},
        {.path = "parameters.*.start",
         .type = KeyType::number,
         .range = above_zero,
         .required = true,
         .doc = "Where the search begins, in the unit of the keys."},
        {.path = "parameters.*.from",
         .type = KeyType::number,
         .range = above_zero,
         .required = true,
         .doc = "Lower bound."},
        {.path = "parameters.*.to",
         .type = KeyType::number,
         .range = above_zero,
         .required = true,
         .doc = "Upper bound."},
        {.path = "targets",
         .type = KeyType::mapping,
         .required = true,
         .doc = "What is wanted; each a mapping, or a list of mappings where there are several of its name."},
    };
    for (const auto& row : quantity_rows) add_target_rules(row, rules);
    const std::vector<KeyRule> last{
        {.path = "replicas",
         .type = KeyType::integer,
         .range = {.least = 1.0, .most = 1000.0},
         .fallback_note = "no copies: the scene's own net and strengths",
         .doc = "Runs of each target, of the same rock in other nets: place or seed of the net and noise of the "
                "strengths differ, as in the replicas of a study."},
        {.path = "evaluations",
         .type = KeyType::integer,
         .range = {.least = 1.0, .most = 10000.0},
         .fallback = "40",
         .doc = "Largest number of parameter sets that are run."},
    };
    rules.insert(rules.end(), last.begin(), last.end());
    return rules;
}

} // namespace

const KeyTable& calibration_schema() {
    static const KeyTable keys(rules_of_calibration());
    return keys;
}

std::string_view quantity_name(TargetQuantity quantity) { return row_of(quantity).name; }
Measure measure_of(TargetQuantity quantity) { return row_of(quantity).measure; }

std::string value_text(double value, Measure measure) {
    if (measure == Measure::angle) return fmt::format("{:.5g} deg", value * degrees);
    if (measure == Measure::fraction) return fmt::format("{:.5g}", value);
    const bool is_stress = measure == Measure::stress || measure == Measure::stiffness;
    const std::string unit(unit_name(measure));
    constexpr double giga = 1e9;
    if (is_stress && std::abs(value) >= giga) return fmt::format("{:.6g} G{}", value / giga, unit);
    if (is_stress) return fmt::format("{:.5g} M{}", value / mega, unit);
    return fmt::format("{:.5g} {}", value, unit);
}

std::string plain_text(double value, Measure measure) {
    return fmt::format("{:.17g}", measure == Measure::angle ? value * degrees : value);
}

std::vector<StudySetting> settings_at(const Calibration& calibration, const Eigen::VectorXd& x) {
    std::vector<StudySetting> settings;
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        const CalibrationParameter& parameter = calibration.parameters[i];
        const double value = std::exp(x[static_cast<Eigen::Index>(i)]);
        for (const ParameterKey& each : parameter.keys)
            settings.push_back({each.key, plain_text(each.times * value, parameter.measure), each.at});
    }
    return settings;
}

namespace {

Eigen::VectorXd logarithms(const Calibration& calibration, double CalibrationParameter::*member) {
    Eigen::VectorXd x(static_cast<Eigen::Index>(calibration.parameters.size()));
    Eigen::Index next = 0;
    for (const auto& parameter : calibration.parameters) x[next++] = std::log(parameter.*member);
    return x;
}

} // namespace

Eigen::VectorXd start_of(const Calibration& calibration) {
    return logarithms(calibration, &CalibrationParameter::start);
}
Eigen::VectorXd lower_bounds(const Calibration& calibration) {
    return logarithms(calibration, &CalibrationParameter::from);
}
Eigen::VectorXd upper_bounds(const Calibration& calibration) {
    return logarithms(calibration, &CalibrationParameter::to);
}

} // namespace kluft

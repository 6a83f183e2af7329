#include "kluft/studies/study_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/units.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/output/summary.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t grey = 6; // number of the dark grey among the colours

const std::vector<std::string_view> plotted_columns{"step", "stage", "axial_strain", "differential_stress", "balanced"};

std::string with_unit(const StudyMeasure& measure) {
    const QuantityUnit unit = quantity_unit(measure.name);
    return unit.name.empty() ? measure.name : fmt::format("{} ({})", measure.name, unit.name);
}

std::string size_name(const std::string& key) { return key.ends_with(".steps") ? "1/" + key : key; }

/// Values of a series in the unit of the plot.
SeriesValues plotted_values(const StudyTable& table, const std::vector<StudyGroup>& groups, const StudySeries& series,
                            const StudyMeasure& measure) {
    SeriesValues found = series_values(table, groups, series, measure);
    for (double& value : found.values) value /= quantity_unit(measure.name).size;
    return found;
}

/// Sizes over more than this ratio are drawn on a logarithmic axis.
constexpr double wide_range = 40.0;

bool is_wide(const CurvePlot& plot) {
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (const PlottedCurve& curve : plot.curves)
        for (const PlottedPoint& point : curve.points) {
            least = std::min(least, point.value.x());
            most = std::max(most, point.value.x());
        }
    return most > wide_range * least;
}

std::vector<Vec2> growing(const std::vector<PlottedPoint>& points) {
    std::vector<Vec2> curve;
    for (const PlottedPoint& point : points)
        if (point.balanced && (curve.empty() || point.value.x() > curve.back().x())) curve.push_back(point.value);
    return curve;
}

CurvePlot stress_strain_axes(const std::string& title) {
    CurvePlot plot;
    plot.title = title;
    plot.x_name = "axial strain (%)";
    plot.y_name = "differential stress (MPa)";
    return plot;
}

std::size_t group_of(const std::vector<StudyGroup>& groups, std::size_t study_case) {
    for (std::size_t i = 0; i < groups.size(); ++i)
        if (std::ranges::find(groups[i].cases, study_case) != groups[i].cases.end()) return i;
    return groups.size();
}

} // namespace

bool is_after_peak(std::string_view quantity) { return quantity == "residual_stress"; }

std::string reference_words(const StudyTable& table) {
    return table.reference ? "case " + table.cases[*table.reference].name : table.reference_name;
}

QuantityUnit quantity_unit(std::string_view quantity) {
    if (quantity.ends_with("_stress") || quantity.ends_with("_modulus")) return {"MPa", mega};
    if (quantity.ends_with("_strain")) return {"%", 1.0 / percent};
    if (quantity.ends_with("_s")) return {"s", 1.0};
    return {};
}

std::optional<CaseRun> read_case_run(const fs::path& directory) {
    if (!fs::exists(directory / "summary.json") || !fs::exists(directory / "history.csv")) return std::nullopt;
    try {
        const RunSummary summary = read_summary(directory / "summary.json");
        CaseRun run;
        run.unbalanced_steps = summary.numbers.unbalanced_steps;
        run.warnings = summary.warnings;
        if (!summary.motion && summary.costs.open_close_iterations > 0)
            run.solves = summary.costs.open_close_iterations;
        if (!summary.platen_stage) return run;
        const auto rows = read_history(directory / "history.csv", plotted_columns);
        for (const StepRecord& row : platen_rows(rows, *summary.platen_stage))
            run.points.push_back({{percent * row.axial_strain, row.differential_stress / mega}, row.balanced});
        run.curve = growing(run.points);
        return run;
    } catch (const InputError&) {
        return std::nullopt; // a damaged case is one without a curve; its numbers stand in the table
    }
}

CurvePlot convergence_plot(const StudyTable& table, const std::vector<StudyGroup>& groups,
                           const std::vector<StudySeries>& series, const StudyMeasure& measure) {
    CurvePlot plot;
    const std::string& key = table.parameters[series.front().parameter];
    plot.title = measure.name + " as " + key + " is refined";
    plot.x_name = size_name(key);
    plot.y_name = with_unit(measure);
    plot.y_from_zero = false;
    for (const StudySeries& each : series) {
        const SeriesValues found = plotted_values(table, groups, each, measure);
        if (found.values.empty()) continue;
        PlottedCurve curve;
        curve.label = series_label(table, groups, series, each);
        for (std::size_t i = 0; i < found.values.size(); ++i)
            curve.points.push_back({{found.sizes[i], found.values[i]}, true});
        const Convergence result = convergence(found.sizes, found.values, noise_of_values);
        if (result.kind == ConvergenceKind::monotone && !is_after_peak(measure.name)) {
            curve.label += fmt::format(": limit {:.4g}, order {:.2g}", *result.limit, *result.order);
            plot.references.push_back({"extrapolated", 0.0, *result.limit, plot.curves.size()});
        }
        plot.curves.push_back(std::move(curve));
    }
    plot.log_x = is_wide(plot);
    if (plot.log_x)
        for (PlottedReference& reference : plot.references) {
            reference.x.reset();
            reference.label = fmt::format("limit {:.4g}", reference.y);
        }
    return plot;
}

CurvePlot work_precision_plot(const StudyTable& table, const std::vector<StudyGroup>& groups,
                              const std::vector<StudySeries>& series, const StudyMeasure& measure,
                              const std::vector<WorkPoint>& points) {
    CurvePlot plot;
    plot.title = "Error of " + measure.name + " against " + reference_words(table);
    plot.x_name = "CPU time (s)";
    plot.y_name = "error (%)";
    plot.log_x = plot.log_y = true;
    plot.unbalanced_name = "with unbalanced steps";
    constexpr std::size_t most_series = 5; // that have a colour of their own
    constexpr double worth_a_text = 0.8;   // of the error of the point of the front that was named last
    double last_named = std::numeric_limits<double>::infinity();
    std::map<std::size_t, std::size_t> curve_of_group;
    for (const StudySeries& each : series) {
        if (table.along != each.parameter || plot.curves.size() == most_series) continue;
        for (const SeriesLevel& level : each.levels) curve_of_group.emplace(level.group, plot.curves.size());
        PlottedCurve curve;
        curve.label = series_label(table, groups, series, each);
        curve.joined = false;
        plot.curves.push_back(std::move(curve));
    }
    PlottedCurve rest;
    rest.label = plot.curves.empty() ? "cases" : "other settings";
    rest.joined = false;
    if (!plot.curves.empty()) rest.colour = most_series;
    PlottedCurve front;
    front.label = "best for their cost";
    front.colour = grey;
    front.dashed = true;
    PlottedCurve own;
    own.label = "the scene's own settings";
    own.colour = grey;
    own.joined = false;
    const auto own_settings = own_group(table, groups);
    for (const WorkPoint& point : points) {
        const Vec2 place{point.cpu_s, percent * point.error};
        const std::size_t group = group_of(groups, point.study_case);
        const auto curve = curve_of_group.find(group);
        (curve == curve_of_group.end() ? rest : plot.curves[curve->second]).points.push_back({place, point.balanced});
        if (own_settings == group && !point.on_front) own.points.push_back({place, point.balanced});
        if (!point.on_front) continue;
        const bool much_better = point.error < worth_a_text * last_named || own_settings == group;
        if (much_better) last_named = point.error;
        front.points.push_back({place, true});
        front.point_texts.push_back(
            much_better ? (own_settings == group ? "as the scene: " : "") + group_label(table, groups, group) : "");
    }
    plot.curves.push_back(std::move(rest));
    plot.curves.push_back(std::move(own));
    std::erase_if(plot.curves, [](const PlottedCurve& curve) { return curve.points.empty(); });
    plot.curves.push_back(std::move(front));
    return plot;
}

CurvePlot curves_plot(const std::string& title, const std::vector<CaseRun>& runs,
                      const std::vector<std::string>& labels) {
    CurvePlot plot = stress_strain_axes(title);
    for (std::size_t i = 0; i < runs.size(); ++i) {
        PlottedCurve curve;
        curve.label = labels[i];
        curve.points = runs[i].points;
        plot.curves.push_back(std::move(curve));
    }
    return plot;
}

CurvePlot band_plot(const std::string& title, const std::vector<CaseRun>& runs, const CurveBand& band) {
    CurvePlot plot = stress_strain_axes(title);
    constexpr std::size_t member_colour = 5;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        PlottedCurve member;
        if (i == 0) member.label = fmt::format("{} members", runs.size());
        for (const Vec2& point : runs[i].curve) member.points.push_back({point, true});
        member.thin = true;
        member.colour = member_colour;
        plot.curves.push_back(std::move(member));
    }
    PlottedCurve mean;
    mean.label = "mean";
    mean.colour = 0;
    PlottedBand area{"\u00b1 1 standard deviation", band.x, {}, {}, 0};
    for (std::size_t i = 0; i < band.x.size(); ++i) {
        mean.points.push_back({{band.x[i], band.mean[i]}, true});
        area.low.push_back(band.mean[i] - band.deviation[i]);
        area.high.push_back(band.mean[i] + band.deviation[i]);
    }
    plot.curves.push_back(std::move(mean));
    plot.bands.push_back(std::move(area));
    return plot;
}

} // namespace kluft

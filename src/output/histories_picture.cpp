#include "kluft/output/histories_picture.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <string_view>

#include "kluft/core/units.hpp"
#include "kluft/output/summary.hpp"

namespace kluft {

namespace {

/// What columns of the same unit have in common.
struct Quantity {
    const char* axis;
    double unit; ///< in SI
    std::array<std::string_view, 5> columns;
};
constexpr std::array<Quantity, 5> quantities{{
    {"displacement (mm)", 1e-3, {"displacement_x", "displacement_y"}},
    {"opening, slip (mm)", 1e-3, {"opening", "slip"}},
    {"rotation (degrees)", std::numbers::pi / 180.0, {"rotation"}},
    {"stress, traction (MPa, compression +)",
     mega,
     {"stress_xx", "stress_yy", "stress_xy", "mean_normal_traction", "mean_shear_traction"}},
    {"force (kN/m)", 1e3, {"normal_force", "shear_force"}},
}};

bool is_of(const Quantity& quantity, std::string_view column) {
    const std::string_view name = column.substr(column.rfind('.') + 1);
    return !name.empty() && std::ranges::find(quantity.columns, name) != quantity.columns.end();
}

/// Where each row stands on the horizontal axis, by its load step.
std::map<int, double> places_of(const std::vector<StepRecord>& history, std::optional<int> platen_stage) {
    std::map<int, double> places;
    if (platen_stage) {
        for (const StepRecord& row : platen_rows(history, *platen_stage)) places[row.step] = 100.0 * row.axial_strain;
    } else {
        for (const StepRecord& row : history) places[row.step] = row.stage + row.load_factor;
    }
    return places;
}

PlottedCurve curve_of(const HistoriesTable& histories, std::size_t column, double unit,
                      const std::map<int, double>& places) {
    PlottedCurve curve;
    curve.label = histories.columns[column];
    for (const StepRecord& row : histories.rows)
        if (const auto place = places.find(row.step); place != places.end())
            curve.points.push_back({{place->second, row.histories[column] / unit}});
    return curve;
}

} // namespace

std::vector<CurvePlot> histories_plots(const std::string& title, const HistoriesTable& histories,
                                       const std::vector<StepRecord>& history, std::optional<int> platen_stage) {
    const auto places = places_of(history, platen_stage);
    std::vector<CurvePlot> plots;
    for (const Quantity& quantity : quantities) {
        CurvePlot plot;
        plot.x_name = platen_stage ? "axial strain (%)" : "stage + load factor";
        plot.y_name = quantity.axis;
        for (std::size_t i = 0; i < histories.columns.size(); ++i)
            if (is_of(quantity, histories.columns[i]))
                plot.curves.push_back(curve_of(histories, i, quantity.unit, places));
        if (!plot.curves.empty()) plots.push_back(std::move(plot));
    }
    if (!plots.empty()) plots.front().title = title;
    return plots;
}

} // namespace kluft

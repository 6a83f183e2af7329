// Plots of runs: differential stress against axial strain, several runs and published values in one picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

struct PlottedPoint {
    Vec2 value = Vec2::Zero();
    bool balanced = true; ///< otherwise drawn as a hollow red marker with dashed lines to it
};

struct PlottedCurve {
    std::string label; ///< in the legend; empty: not listed there
    std::vector<PlottedPoint> points;
    std::vector<Vec2> fine; ///< drawn faintly underneath: every balanced equilibrium
    std::optional<Vec2> peak;
    std::vector<std::string> peak_text; ///< lines beside the peak
    bool peak_reached = true;           ///< otherwise drawn dashed: the curve was not yet falling, or the net locked
    bool dashed = false;                ///< so that a curve that it covers is seen
    bool joined = true;                 ///< by lines; otherwise larger markers only
    bool thin = false;                  ///< a faint line without markers
    std::optional<std::size_t> colour = {};    ///< number of its colour; otherwise its place among the curves
    std::vector<std::string> point_texts = {}; ///< beside its points, in their order; may be empty or shorter
};

/// The area between two lines over common places.
struct PlottedBand {
    std::string label; ///< in the legend; empty: not listed there
    std::vector<double> x;
    std::vector<double> low;
    std::vector<double> high;
    std::size_t colour = 0; ///< number of its colour
};

/// A published value to compare with, in the units of the plot: a level across it (no x; the label stands on the line)
/// or a point (a cross; equal labels of one colour are listed once in the legend).
struct PlottedReference {
    std::string label;
    std::optional<double> x;
    double y = 0.0;
    std::optional<std::size_t> curve = {}; ///< drawn in this curve's colour; grey without
};

struct CurvePlot {
    std::string title;
    std::string x_name;
    std::string y_name;
    std::vector<PlottedCurve> curves;
    std::vector<PlottedReference> references;
    std::optional<double> y_limit = {}; ///< end of the vertical axis, which cuts off what is above; none: all is shown
    std::vector<PlottedBand> bands = {};
    bool log_x = false; ///< what is not above zero is not shown then
    bool log_y = false;
    bool y_from_zero = true;                         ///< otherwise the axis covers the values only
    std::string unbalanced_name = "unbalanced step"; ///< of hollow red markers in the legend
};

/// The rows of one run as written to its tables.
struct RunCurve {
    std::string label;
    std::vector<StepRecord> history;
    std::vector<StepRecord> equilibria; ///< may be empty
    std::optional<int> platen_stage;    ///< the first stage that moves a platen
};

/// Differential stress (MPa) against axial strain (%), positive in compression, from the state before the platen
/// moves. The peak is the balanced equilibrium with the largest axial stress (see summary.hpp), marked with its values;
/// of several runs these stand in the legend.
[[nodiscard]] CurvePlot stress_strain_plot(const std::string& title, const std::vector<RunCurve>& runs,
                                           const std::vector<PlottedReference>& references = {});

/// Bytes of the picture; several plots stand below each other.
[[nodiscard]] std::string draw_curves(const std::vector<CurvePlot>& plots, PictureFormat format);
[[nodiscard]] std::string draw_curves(const CurvePlot& plot, PictureFormat format);
/// Writes the picture in the format that the extension names. Throws InputError, ResourceError.
void write_curves(const std::filesystem::path& path, const std::vector<CurvePlot>& plots);
void write_curves(const std::filesystem::path& path, const CurvePlot& plot);

} // namespace kluft

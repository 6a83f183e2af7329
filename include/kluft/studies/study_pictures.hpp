// The plots of a study's report.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/output/curve_picture.hpp"
#include "kluft/studies/ensemble.hpp"
#include "kluft/studies/study_analysis.hpp"
#include "kluft/studies/study_table.hpp"

namespace kluft {

/// How a quantity of summary.json is written: stresses and moduli in MPa, strains in %.
struct QuantityUnit {
    std::string name; ///< empty: a plain number
    double size = 1.0;
};

[[nodiscard]] QuantityUnit quantity_unit(std::string_view quantity);

/// What the report needs of a case's directory.
struct CaseRun {
    std::vector<PlottedPoint> points; ///< axial strain (%), differential stress (MPa), from where the platen moves
    std::vector<Vec2> curve;          ///< the balanced ones of them as long as the strain grows
    int unbalanced_steps = 0;
    std::optional<int> solves; ///< linear ones in the whole run; none of an explicit run
    std::vector<std::string> warnings;
};

/// Changes of a value up to this, relative, are not looked at: a solver's tolerance and round-off make them.
inline constexpr double noise_of_values = 1e-4;

/// Whether single runs say little of it, since they part from each other at the peak.
[[nodiscard]] bool is_after_peak(std::string_view quantity);

/// "case reference", without its settings.
[[nodiscard]] std::string reference_words(const StudyTable& table);

/// Nothing where the case has left no summary or history that can be read.
[[nodiscard]] std::optional<CaseRun> read_case_run(const std::filesystem::path& directory);

/// A measure over the size h of one parameter, a curve per series, with the extrapolated limits; the value of a group
/// of replicas is their mean.
[[nodiscard]] CurvePlot convergence_plot(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                         const std::vector<StudySeries>& series, const StudyMeasure& measure);

/// Error (%) over CPU time, both logarithmic: the points of each series along the study's parameter in one colour,
/// the rest in another, and the front with its settings beside it, as with the scene's own.
[[nodiscard]] CurvePlot work_precision_plot(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                            const std::vector<StudySeries>& series, const StudyMeasure& measure,
                                            const std::vector<WorkPoint>& points);

/// Curves of several runs in one picture. `labels`: one per run.
[[nodiscard]] CurvePlot curves_plot(const std::string& title, const std::vector<CaseRun>& runs,
                                    const std::vector<std::string>& labels);

/// Mean curve of copies of a run with its band of one standard deviation; the members thin.
[[nodiscard]] CurvePlot band_plot(const std::string& title, const std::vector<CaseRun>& runs, const CurveBand& band);

} // namespace kluft

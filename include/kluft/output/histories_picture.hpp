// Plots of what a scene follows step by step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/output/curve_picture.hpp"
#include "kluft/output/history_table.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// A plot for each quantity of histories.csv, with a curve for each of its columns: displacements, openings and slips (mm),
/// rotations (degrees), stresses and tractions (MPa, positive in compression), forces (kN/m). Over the axial strain (%) from
/// the state before the platen moves where one does, otherwise over the number of the stage and its load factor.
[[nodiscard]] std::vector<CurvePlot> histories_plots(const std::string& title, const HistoriesTable& histories,
                                                     const std::vector<StepRecord>& history,
                                                     std::optional<int> platen_stage);

} // namespace kluft

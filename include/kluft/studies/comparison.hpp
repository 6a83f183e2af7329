// Two finished runs side by side: their numbers, their curves and their cracks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "kluft/core/vector.hpp"
#include "kluft/output/comparison_table.hpp"
#include "kluft/output/cracks_picture.hpp"
#include "kluft/simulation/step_record.hpp"
#include "kluft/studies/finished_run.hpp"

namespace kluft {

/// A crack of one run and its counterpart in another, by their places in the two lists.
struct CrackMatch {
    std::size_t a = 0;
    std::size_t b = 0;
    double distance = 0.0; ///< of their middles (m)
};

/// Pairs of cracks of the same mode whose middles are at most `reach` apart (m): the nearest pair first, then the
/// nearest of those that are left, and so on, so that each crack is in one pair at most. Of equal distances the first
/// in the lists goes first. Sorted by `a`.
[[nodiscard]] std::vector<CrackMatch> match_cracks(const std::vector<CrackRecord>& a, const std::vector<CrackRecord>& b,
                                                   double reach);

struct CurveDifference {
    double largest = 0.0; ///< fraction of the scale
    double mean = 0.0;    ///< fraction of the scale
    double end = 0.0;     ///< axial strain up to which the curves were compared
};

/// Points of the grid on which curves are compared: equal steps of the axial strain, both ends included.
inline constexpr int n_curve_points = 201;

/// Difference of the curves differential_stress(axial_strain), both positive in the sense of the platen, linear between their balanced rows, at n_curve_points
/// strains from where both begin to `end` or where the first of them ends. Rows in which the strain does not grow beyond
/// all before are left out. `scale`: the stress that differences are divided by (Pa). Nothing without a common range or
/// with a scale that is not positive.
[[nodiscard]] std::optional<CurveDifference>
curve_difference(const std::vector<StepRecord>& a, const std::vector<StepRecord>& b, double end, double scale);

/// (axial strain, differential stress) of the balanced rows whose strain grows beyond all before, and of those that follow such a
/// row at its strain: a drop, whose strains differ by their last digit.
[[nodiscard]] std::vector<Vec2> growing_curve(const std::vector<StepRecord>& rows);

/// L2 distance of two growing curves over the strains that both have, on n_curve_points, relative to the L2 norm of the
/// reference there. Nothing without a common range, or for a reference that is zero.
[[nodiscard]] std::optional<double> curve_distance(const std::vector<Vec2>& reference, const std::vector<Vec2>& curve);

struct Comparison {
    ComparisonTable table;
    std::vector<CrackMatch> matches; ///< of the cracks of both runs; empty where they are not known
};

/// Differences of b from a, relative to a. The runs agree if peak stress, peak strain, Young's modulus and the mean
/// difference of the curves (up to the smaller peak strain, relative to the peak differential stress of a) are within
/// `tolerance`, as far as they are known, and so is a factor of safety; what is known of one run only is a miss. Runs that neither move a
/// platen nor look for a factor are judged by the load factor of their last balanced load step, which must be of one stage. Cracks are matched within the
/// spacing of the hexagons, the larger one of two bodies.
[[nodiscard]] Comparison compare_runs(const FinishedRun& a, const FinishedRun& b, double tolerance);

/// Cracks of a alone, of b alone and matched ones in three colours. Cracks whose interface is not known are dots.
[[nodiscard]] CracksPlot cracks_plot(const FinishedRun& a, const FinishedRun& b,
                                     const std::vector<CrackMatch>& matches);

/// Throws InputError where the directory has a file that no comparison wrote and that write_comparison would take the place of.
void require_no_other_comparison(const std::filesystem::path& directory);

/// Writes compare.json, compare.md, where a platen moves curves.png and curves.svg, and where the body of a run is known cracks.png and
/// cracks.svg (no SVG of very many blocks); removes older ones. Enters the pictures into the table.
/// Throws ResourceError.
void write_comparison(const std::filesystem::path& directory, const FinishedRun& a, const FinishedRun& b,
                      Comparison& comparison);

} // namespace kluft

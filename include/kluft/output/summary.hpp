// What a run comes to: peak, residual stress, elastic constants, counts and costs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/constitutive/material.hpp"
#include "kluft/simulation/run_report.hpp"
#include "kluft/simulation/run_status.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The mechanical numbers of a run. Pa and fractions, positive in compression.
struct CurveNumbers {
    std::optional<double>
        peak_stress; ///< largest axial stress over all balanced equilibria, see peak_row; none without a platen
    std::optional<double> peak_strain; ///< axial strain there
    bool peak_reached =
        false; ///< a later balanced equilibrium lies at least 1 % below the peak, or a state out of balance by half
    bool net_locked = false; ///< see is_net_locked; then no peak is reached
    /// No peak is reached, and the differential stress has changed by 1 % or less over the last third of the platen's way, all of it in
    /// balance, at one lateral stress: what slides without end, as a joint of Coulomb friction does.
    bool levelled_off = false;
    bool sides_unloaded = false; ///< see is_unloaded_before_fall
    /// Mean axial stress over the last 10 % of the strain (Pa); none where the peak lies in the last 20 %. A run that a drop
    /// of the stress ended has none either, which its rows do not tell.
    std::optional<double> residual_stress;
    std::optional<double> axial_modulus;  ///< slope of the differential stress over the axial strain (Pa)
    std::optional<double> lateral_ratio;  ///< slope of the lateral strain over the axial one, sign changed
    std::optional<double> youngs_modulus; ///< of the rock: the same slopes, converted for plane strain (Pa)
    std::optional<double> poissons_ratio;
    int cracks_tension = 0;
    int cracks_shear = 0;
    int jumps = 0;
    int jumps_to_peak = 0; ///< before or at it
    int steps = 0;
    int unbalanced_steps = 0;
};

/// Rows of the stages from `platen_stage` on, and the last row before them (the state in which the platen starts).
[[nodiscard]] std::vector<StepRecord> platen_rows(const std::vector<StepRecord>& rows, int platen_stage);

/// 1 where platens press the body, -1 where they pull it: the sense in which its stress has fallen behind a peak (a seating load before
/// a pull is no peak), or in which a platen that is pressed, or pulled, goes farthest; else that of the first stage that moves one; 1
/// without such a stage.
[[nodiscard]] double platen_sense(const std::vector<StepRecord>& rows, std::optional<int> platen_stage);

/// Whether loose cells of the net carry what the rock cannot, as masonry does: 70 % or more of the net's bonds in the middle
/// half of the body have failed, and a later balanced equilibrium has an axial stress that lies by 5 % or more above all
/// up to the first one with so many failed, in the sense of the platen. A rise that stays below an earlier peak does not
/// count: that peak is the rock's.
[[nodiscard]] bool is_net_locked(const std::vector<StepRecord>& rows, std::optional<int> platen_stage);

/// The balanced row with the axial stress of largest magnitude in the sense of the platen, the first of equals; nothing without a
/// balanced row. Where the net is locked, only of the rows up to the first one with so many bonds failed.
[[nodiscard]] std::optional<StepRecord> peak_row(const std::vector<StepRecord>& rows, std::optional<int> platen_stage);

/// Whether the sides were pressed less, by more than 2 % of the peak's lateral stress and 0.1 % of its axial one, before the
/// stress fell by 1 % from the peak: the body then failed under another lateral stress than that at its peak. What the lateral
/// stress has lost is no fall of the axial one, as of an elastic body whose sides are relieved.
[[nodiscard]] bool is_unloaded_before_fall(const std::vector<StepRecord>& rows, const StepRecord& peak,
                                           std::optional<int> platen_stage);

/// Computes the numbers from the rows of equilibria.csv (peak) and history.csv (the rest; also the peak when there are
/// no equilibria). Unbalanced rows count in `unbalanced_steps` only.
///
/// Elastic constants: least squares over the balanced rows from the start of the platen's movement to its peak, at most to
/// the last before more than 1 % of what is closed slides, or of all joints have opened, or the platen has left the body; where those are fewer than three, over the rows up to 30 % of the peak differential stress, of
/// which the last is interpolated where they are fewer than two. In plane stress E = slope, nu = ratio; in plane
/// strain the slopes are E' = E/(1 - nu^2) and nu' = nu/(1 - nu), hence nu = nu'/(1 + nu') and E = E' (1 - nu^2). A body whose nu is not between 0 and 0.5 has no such
/// constants. Those of a body with fractures, of which the model knows a `compliance_across` (1/Pa), are the ones that it has in
/// plane stress (docs/theory.md, (41a)), without a nu that no rock has.
/// `platen_stage`: the first stage that moves a platen; without one there are no peak and no elastic constants, since
/// the axial stress is that of a load.
[[nodiscard]] CurveNumbers curve_numbers(const std::vector<StepRecord>& equilibria,
                                         const std::vector<StepRecord>& history, std::optional<int> platen_stage,
                                         Plane plane, std::optional<double> compliance_across = std::nullopt);

/// Takes stresses for zero that are round-off beside E times the strain at the peak, as those of a body that is cut through and
/// pulled; it has no elastic constants then. `modulus`: E of the stiffest material (Pa).
void clear_round_off(double modulus, CurveNumbers& numbers);

/// Leaves no constants of the rock where the body is none to have them from (rock_constants.hpp); its own modulus and ratio stay.
void clear_elastic_constants(CurveNumbers& numbers);

/// Whether the largest axial stress is a strength: it falls behind it, or has levelled off.
[[nodiscard]] bool is_strength(const CurveNumbers& numbers);

/// What is to be said beside a peak: "net locked", "sides unloaded", "levelled off" or "not yet falling"; "" beside one behind which
/// the stress fell under the same lateral stress.
[[nodiscard]] std::string peak_remark(const CurveNumbers& numbers);

/// The name of a status in summary.json.
[[nodiscard]] std::string status_name(RunStatus status);

struct RunSummary {
    RunStatus status = RunStatus::done;
    std::string title;
    CurveNumbers numbers;
    std::optional<int> platen_stage;
    int blocks = 0;
    int interfaces = 0;
    int unknowns = 0;
    RunCosts costs;
    double cpu_s = 0.0; ///< processor time of all threads, in the system included
    std::int64_t peak_memory_bytes = 0;
    std::string version;
    std::string blas_core; ///< the processor for which the BLAS's kernels in use were written, by its name of it
    std::string message;   ///< why the run ended, if not with the last load step
    RunResults results;
    std::vector<std::string> reduced_alone; ///< as in the report of the run
    std::vector<std::string> warnings;      ///< of the scene, of its body and of the run
    std::vector<FallingBlock> falling;      ///< blocks that move where the run has ended
    std::optional<MotionReport> motion;     ///< of an explicit run
};

/// The text of summary.json. What is not known or not a finite number is null.
[[nodiscard]] std::string summary_json(const RunSummary& summary);
/// Writes summary.json. Throws ResourceError.
void write_summary(const std::filesystem::path& path, const RunSummary& summary);
/// Reads summary.json back. Throws InputError.
[[nodiscard]] RunSummary read_summary(const std::filesystem::path& path);

/// Largest memory that this program has had so far (bytes).
[[nodiscard]] std::int64_t peak_memory_bytes();

} // namespace kluft

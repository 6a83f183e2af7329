// What follows from the table of a study: convergence, error against cost, and the cheapest settings for an error.
// Nothing here reads or writes a file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/studies/study_table.hpp"

namespace kluft {

/// What a varied key of a scene changes.
enum class ParameterKind {
    refinement, ///< a number that refines the solution of the same model: steps, tolerances, intervals
    method,     ///< another way to the solution of the same model: crack update, integrator, tangent
    model       ///< another model of the rock: geometry, tessellation, kinematics, materials, loads
};

/// Of the key itself, whatever the study runs along.
[[nodiscard]] ParameterKind parameter_kind(std::string_view key);

/// The number that a setting of the key stands for, in SI; nothing where it is none.
[[nodiscard]] std::optional<double> setting_number(std::string_view key, std::string_view setting);

/// The size h that goes to zero when the key is refined: 1/n for a number of steps, else the number itself. Nothing
/// where the setting is no positive number.
[[nodiscard]] std::optional<double> refinement_size(std::string_view key, std::string_view setting);

/// Per case, whether others are compared with it: the table's reference, or where each group of settings has one of its
/// own every case whose known errors are all zero.
[[nodiscard]] std::vector<bool> reference_marks(const StudyTable& table);

/// One number of each case and its error against the reference; the whole curve has an error only.
struct StudyMeasure {
    std::string name;
    bool is_curve = false;
    std::vector<std::optional<double>> values; ///< per case
    std::vector<std::optional<double>> errors; ///< per case, relative
};

/// The quantities of which any case has a value, in the table's order, then the curve if any case has its error.
[[nodiscard]] std::vector<StudyMeasure> study_measures(const StudyTable& table);

/// Cases with the same settings, which are replicas of each other.
struct StudyGroup {
    std::vector<std::string> settings; ///< per parameter
    std::string variant;
    std::vector<std::size_t> cases; ///< by replica
};

/// In the order of the table. The names of variants do not matter unless two cases differ in nothing else: then their
/// variants hold settings that are no parameters of the table.
[[nodiscard]] std::vector<StudyGroup> study_groups(const StudyTable& table);

/// Mean over those members of the group that ended as `done` and have the value.
[[nodiscard]] std::optional<double> group_mean(const StudyTable& table, const StudyGroup& group,
                                               const std::vector<std::optional<double>>& values);
/// Mean CPU time of a member (s), over those that are known.
[[nodiscard]] std::optional<double> group_cost(const StudyTable& table, const StudyGroup& group);
/// Every member ended as `done`.
[[nodiscard]] bool all_done(const StudyTable& table, const StudyGroup& group);

struct SeriesLevel {
    std::size_t group = 0; ///< index into the groups
    double size = 0.0;     ///< h, see refinement_size
};

/// Groups that differ in one parameter only.
struct StudySeries {
    std::size_t parameter = 0;
    std::vector<SeriesLevel> levels; ///< from coarse to fine
};

/// Series of two levels or more along the table's parameter `along`, then along other refining parameters those that
/// have a group in them which is in none of the former.
[[nodiscard]] std::vector<StudySeries> study_series(const StudyTable& table, const std::vector<StudyGroup>& groups);

struct SeriesValues {
    std::vector<double> sizes; ///< from coarse to fine
    std::vector<double> values;
    std::vector<std::size_t> groups; ///< that they are the means of
};

/// Means over the replicas that all levels with a value have in common (over all members if there are none); levels
/// without a value are left out.
[[nodiscard]] SeriesValues series_values(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                         const StudySeries& series, const StudyMeasure& measure);

enum class ConvergenceKind {
    too_few,   ///< fewer than three values
    constant,  ///< no change above the noise
    monotone,  ///< with an order and a limit
    unsettled, ///< monotone, but with no order that two successive estimates agree on
    scattered  ///< up and down
};

/// Values that a convergence is judged by: the finest ones.
inline constexpr std::size_t most_judged = 4;

/// How values go to a limit with the size h.
struct Convergence {
    ConvergenceKind kind = ConvergenceKind::too_few;
    std::optional<double> order;       ///< p of q = q0 + C h^p
    std::optional<double> limit;       ///< q0
    std::optional<double> uncertainty; ///< of the finest value against the limit, of about 95 %, relative to it
    double scatter = 0.0;              ///< (largest - least)/|mean| of the finest values, at most four
};

/// Richardson's extrapolation of values q over sizes h, both from coarse to fine. With three sizes of a constant ratio
/// r: p = ln((q1 - q2)/(q2 - q3))/ln r, q0 = q3 + (q3 - q2)/(r^p - 1), uncertainty 1.25 |q3 - q2|/(r^p - 1) (grid
/// convergence index; Roache, P. J. 1994, J. Fluids Eng. 116, 405-413). With other ratios q = q0 + C h^p is fitted by
/// least squares to the last values, at most four, and the root mean square of what remains is added to the
/// uncertainty. No order and no limit are given unless the last values, at most four, change in one direction in steps
/// that become smaller, and p is between 0.5 and 4.5. With four values p of the first three must not differ by more than
/// 1 from that of the last three; else the uncertainty is three times the mean change from one value to the next (Eca,
/// L. & Hoekstra, M. 2014, J. Comput. Phys. 262, 104-130).
/// `noise`: a scatter up to this is no change.
[[nodiscard]] Convergence convergence(const std::vector<double>& sizes, const std::vector<double>& values,
                                      double noise = 1e-10);

/// A case that can be had for a price.
struct WorkPoint {
    std::size_t study_case = 0;
    double cpu_s = 0.0;
    double error = 0.0; ///< absolute value, relative to the reference
    bool balanced = true;
    bool on_front = false; ///< no other point is as cheap and as right and better in one of the two
};

/// Points of all cases that ended as `done` and have an error and a CPU time, except references; `chosen`: per case
/// whether it takes part. Ascending in cost. `unbalanced` (per case): it has unbalanced load steps; the front is made
/// of balanced points only.
[[nodiscard]] std::vector<WorkPoint> work_precision(const StudyTable& table, const StudyMeasure& measure,
                                                    const std::vector<bool>& chosen,
                                                    const std::vector<bool>& unbalanced);

/// The settings that differ in nothing but the model of the rock, and what that changes.
struct ModelChoice {
    std::size_t group = 0;
    std::size_t own = 0;              ///< the group with the same settings and the model of a reference
    std::optional<double> deviation;  ///< of the measure from that of `own`, relative
    std::optional<double> cost_ratio; ///< CPU time over that of `own`
};

/// Per group, whether it is another model of the rock than every reference: none is unless references are cases. What
/// the study runs along is no choice of the model.
[[nodiscard]] std::vector<bool> other_model_marks(const StudyTable& table, const std::vector<StudyGroup>& groups);

/// Of all groups that are another model of the rock and have their counterpart in the study.
[[nodiscard]] std::vector<ModelChoice> model_choices(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                                     const StudyMeasure& measure);

/// The error that a group stands for: with three members or more |mean error| plus the half-width of its 95 %
/// confidence interval, else that of the worst member. Nothing unless all members are done and have one.
[[nodiscard]] std::optional<double> group_error(const StudyTable& table, const StudyGroup& group,
                                                const StudyMeasure& measure);

struct Advice {
    double bound = 0.0;                     ///< asked for, a fraction
    std::optional<std::size_t> group;       ///< a cheapest one that holds it
    double error = 0.0;                     ///< of this group, see group_error
    double cpu_s = 0.0;                     ///< of one of its cases
    bool is_unconfirmed = false;            ///< the table's reference, to which there is no finer group
    std::optional<double> reference_share;  ///< cpu_s over the mean of the references
    std::vector<std::size_t> not_confirmed; ///< cheaper groups below the bound that are not trusted
};

/// The cheapest group whose error is below each bound; of those that cost up to a tenth more, which is what times of short runs
/// vary by, the most exact one. A group counts only if it is confirmed: there is a finer one,
/// and every finer one is below the bound too (finer: equal in all settings but refining ones, and no coarser in any of
/// these). The table's reference itself counts as confirmed. Groups of other models of the rock, and those with a
/// case in `unbalanced`, take no part.
[[nodiscard]] std::vector<Advice> cheapest_settings(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                                    const StudyMeasure& measure, const std::vector<bool>& unbalanced,
                                                    const std::vector<double>& bounds);

/// Short words for a group's settings: "steps 100, update all". What more than half of the groups have is left out, but
/// for the parameter that the study runs along, and so is the parameter `without`; "usual settings" where nothing is
/// left.
[[nodiscard]] std::string group_label(const StudyTable& table, const std::vector<StudyGroup>& groups, std::size_t group,
                                      std::optional<std::size_t> without = {});

/// What tells a series from the others of its parameter in `all`: "update event"; of the only one its group_label.
[[nodiscard]] std::string series_label(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                       const std::vector<StudySeries>& all, const StudySeries& series);

/// "100 steps of stage 1", "cracks.update all", "without solver.accuracy" (null).
[[nodiscard]] std::string setting_words(const std::string& key, const std::string& setting);

/// Whether a case with this setting has what the scene itself says; nothing set is that too.
[[nodiscard]] bool is_own_setting(const StudyTable& table, std::size_t parameter, const std::string& setting);

/// The group with the scene's own settings, or else the one that differs from them in the parameter `along` only and in
/// this the least. Nothing where the own settings are not known.
[[nodiscard]] std::optional<std::size_t> own_group(const StudyTable& table, const std::vector<StudyGroup>& groups);

/// Whether the group sets solver.accuracy, so that its number of steps gives the first step only.
[[nodiscard]] bool takes_own_steps(const StudyTable& table, const StudyGroup& group);

/// Whether cases that differ in the parameter are different models of the rock: one the study does not run along.
[[nodiscard]] bool makes_the_model(const StudyTable& table, std::size_t parameter);

/// What makes the group's model another one than the scene's and that of other groups: "materials.rock.cohesion 4 MPa"; "" where
/// nothing does.
[[nodiscard]] std::string model_of_group(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                         std::size_t group);

/// How the group computes, without what makes its model. The parameter `along` (a step count as in the scene not of groups that take their own steps) and what differs from the scene's own settings: "25 steps of stage 1, cracks.update all". Where
/// the own settings are not known all in which a group of the references' model differs from this one.
[[nodiscard]] std::string advised_settings(const StudyTable& table, const std::vector<StudyGroup>& groups,
                                           std::size_t group);

} // namespace kluft

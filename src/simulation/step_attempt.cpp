#include "kluft/simulation/step_attempt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "kluft/simulation/breaking.hpp"
#include "kluft/simulation/jump.hpp"
#include "kluft/simulation/placement.hpp"

namespace kluft {

namespace {

constexpr double lag_weight = 4.0;             ///< of the mass-like term's share in the stresses (measured: 1 to 4)
constexpr double least_predicted_share = 0.01; ///< of a load step: the first trial of an event
constexpr double least_event_width = 1e-4;     ///< of the accuracy: load factors between which no event is searched

/// The error of a load step that is taken again with a smaller size, whatever the accuracy.
constexpr StepError without_equilibrium{std::numeric_limits<double>::infinity(),
                                        std::numeric_limits<double>::infinity()};

// ---- events --------------------------------------------------------------------------------------------------------

bool has_slipped(const State& state, int fracture) {
    return std::ranges::find(state.control.slipped, fracture) != state.control.slipped.end();
}

/// The index of the mapped fractures that have not slipped yet, and of the potential cracks if they are checked.
double event_index(const StepInProgress& p, const Placement& placement, const LoadsAt& at, const Eigen::VectorXd& q) {
    const bool seeks_events = p.goal.cracks.update == CrackUpdate::event;
    if (!seeks_events) return 0.0;
    double largest = p.goal.checks_cracks ? largest_failure_index(p, placement, at, q) : 0.0;
    const auto slips = slip_indices(p.bench.model, loaded_body(p.bench.model, placement, at), q);
    for (int i = 0; i < static_cast<int>(slips.size()); ++i)
        if (!has_slipped(p.step.end, i)) largest = std::max(largest, std::min(largest_useful_index, slips[i]));
    return largest;
}

double index_of(const StepInProgress& p, const PlacedState& placed, const Equilibrium& found) {
    return event_index(p, placed.placement, p.loads_at(found), found.displacement);
}

/// A mapped fracture slips for the first time only once.
void note_slips(StepInProgress& p, const PlacedState& placed, double load_factor, const Eigen::VectorXd& q) {
    if (p.goal.cracks.update != CrackUpdate::event) return;
    const LoadsAt at = p.loads_at(load_factor);
    const auto slips = slip_indices(p.bench.model, loaded_body(p.bench.model, placed.placement, at), q);
    for (int i = 0; i < static_cast<int>(slips.size()); ++i)
        if (slips[i] >= 1.0 - p.goal.accuracy && !has_slipped(p.step.end, i)) p.step.end.control.slipped.push_back(i);
}

void note_event(StepInProgress& p, const PlacedState& placed, const EventCut<Equilibrium>& cut) {
    const double index = index_of(p, placed, cut.found);
    if (index < 1.0 - p.goal.accuracy) return;
    const double taken = cut.found.load_factor - p.from.at.load_factor; // which encloses the event too
    double& error = p.step.end.control.event_error;
    error = std::max(error, std::min({std::abs(index - 1.0), cut.width, taken}));
    note_slips(p, placed, cut.found.load_factor, cut.found.displacement);
}

/// Where the motion of the last step, going on, has the next event before the goal; else the goal.
double predicted_event(const StepInProgress& p, const PlacedState& placed) {
    const double from = p.load_factor();
    const double target = p.goal.load_factor;
    if (p.step.end.memory.rate.size() == 0) return target;
    const double share = expected_event(p.goal.accuracy, [&](double at) {
        const double load_factor = at == 1.0 ? target : from + at * (target - from);
        return event_index(p, placed.placement, p.loads_at(load_factor), predicted(p, load_factor));
    });
    const double at =
        std::max(share, least_predicted_share) * std::ldexp(1.0, std::min(p.step.end.control.missed_events, 10));
    return at < 1.0 ? from + at * (target - from) : target;
}

EventCut<Equilibrium> cut_at_first_event(StepInProgress& p, const PlacedState& placed, Equilibrium found) {
    const double accuracy = p.goal.accuracy;
    const EventGoal goal{
        .last_without = 1.0 + accuracy, .index = 1.0, .reach = accuracy, .least_width = least_event_width * accuracy};
    return cut_at_event(p, placed, std::move(found), goal, [&](const LoadsAt& at, const Eigen::VectorXd& q) {
        return event_index(p, placed.placement, at, q);
    });
}

// ---- the error of a step -------------------------------------------------------------------------------------------

/// What the history is judged by: the axial stress where a platen prescribes the strain, else the stresses of all blocks,
/// whose norm is the root of their mean square.
using CourseValue = Eigen::VectorXd;

CourseValue course_value(const StepInProgress& p, double axial_stress, const Placement& placement, const LoadsAt& at,
                         const Eigen::VectorXd& q) {
    if (prescribes_strain(p.bench.stage(p.from))) return CourseValue::Constant(1, axial_stress);
    return weighted_stresses(loaded_body(p.bench.model, placement, at), q);
}

/// At the end of the step so far.
CourseValue course_value(const StepInProgress& p) {
    return course_value(p, p.step.end.stresses.axial, p.step.in_place.placement, p.step.in_place.at, p.displacement());
}

/// The course over a load step: at its start, its middle and its end, and at the end when it was taken at once.
struct Course {
    CourseValue start, middle, end, at_once;
};

/// `open`: what the solves themselves leave open, relative; it does not add up and is none of the step's size. The
/// scale is the largest value so far, or what the stage comes to at the pace so far.
StepError error_of(const StepInProgress& p, const Course& course, double open) {
    const StressHistory& stresses = p.step.end.stresses;
    const bool by_strain = prescribes_strain(p.bench.stage(p.from));
    const double largest = by_strain ? stresses.largest_axial : stresses.largest_mean;
    const double size = p.load_factor() - p.from.at.load_factor;
    const double scale =
        std::max(largest, (course.end + (1.0 - p.load_factor()) / size * (course.end - course.start)).norm());
    if (!(scale > 0.0)) return {};
    const double path = (course.end - course.at_once).norm() / scale;
    const double chord = (course.middle - 0.5 * (course.start + course.end)).norm() / scale;
    return {std::max(0.0, path - open), std::max(0.0, chord - open)};
}

// ---- one attempt ---------------------------------------------------------------------------------------------------

void finish_step(StepInProgress& p, PlacedState placed, const EventCut<Equilibrium>& cut) {
    if (p.failed()) return;
    if (cut.found.balanced) note_event(p, placed, cut);
    reach(p, std::move(placed), cut.found);
    if (p.failed()) return;
    keep_rate(p);
    if (p.goal.checks_cracks) break_bonds(p);
}

/// Takes the step from its start once more in two halves, which are what counts.
std::optional<StepError> judge_by_halves(StepInProgress& p, PlacedState placed, const EventCut<Equilibrium>& whole) {
    const double target = p.goal.load_factor;
    const Eigen::VectorXd& at_once = whole.found.displacement;
    const double middle = std::midpoint(p.load_factor(), target);
    Equilibrium half = find_at(p, placed, middle, 0.5 * (p.displacement() + at_once));
    if (!half.balanced) {
        finish_step(p, std::move(placed), whole);
        return std::nullopt;
    }
    follow_loads(p, placed, half);
    Course course;
    const LoadsAt at_start = p.loads_at(p.load_factor());
    const LoadsAt at_target = p.loads_at(target);
    course.start = course_value(p, p.step.end.stresses.axial, placed.placement, at_start, p.displacement());
    course.at_once = course_value(p, measure(p, placed, at_target, whole.found).row.axial_stress, placed.placement,
                                  at_target, at_once);
    reach(p, std::move(placed), half);
    if (p.failed()) return std::nullopt;
    course.middle = course_value(p);
    placed = place(p);
    Equilibrium end = find_at(p, placed, target, at_once);
    if (!end.balanced) {
        end = recover(p, placed, target);
        finish_step(p, std::move(placed), {std::move(end), target - middle});
        return std::nullopt;
    }
    follow_loads(p, placed, end);
    const EventCut<Equilibrium> cut = cut_at_first_event(p, placed, std::move(end));
    const bool event = cut.found.load_factor < target || index_of(p, placed, cut.found) >= 1.0 - p.goal.accuracy;
    finish_step(p, std::move(placed), cut);
    if (event || p.failed()) return std::nullopt;
    course.end = course_value(p);
    const double shares = std::max({whole.found.viscous_share, half.viscous_share, cut.found.viscous_share});
    return error_of(p, course, p.bench.solver.tolerance + lag_weight * shares);
}

/// Moves towards the goal's load factor, up to the first event. A step without one is judged. Where no equilibrium is found
/// at once, the step is relaxed only if it is small.
std::optional<StepError> advance(StepInProgress& p, double small_step) {
    PlacedState placed = place_for_load_step(p);
    StepControl& control = p.step.end.control;
    note_slips(p, placed, p.load_factor(), p.displacement());
    const double first = predicted_event(p, placed);
    const double size = first - p.load_factor();
    Equilibrium found = find_at(p, placed, first, predicted(p, first));
    if (!found.balanced && size > small_step) return without_equilibrium;
    if (!found.balanced) {
        found = recover(p, placed, first);
        control.size = std::max(control.size, std::min(small_step, 2.0 * size));
        finish_step(p, std::move(placed), {std::move(found), size}); // which encloses an event that it jumped over
        p.step.end.memory.rate.resize(0);
        return std::nullopt;
    }
    follow_loads(p, placed, found);
    const EventCut<Equilibrium> cut = cut_at_first_event(p, placed, std::move(found));
    const double reached = cut.found.load_factor;
    const bool event = reached < first || index_of(p, placed, cut.found) >= 1.0 - p.goal.accuracy;
    control.missed_events = event || first == p.goal.load_factor ? 0 : control.missed_events + 1;
    if (reached == p.goal.load_factor && !event) return judge_by_halves(p, std::move(placed), cut);
    finish_step(p, std::move(placed), cut);
    return std::nullopt;
}

} // namespace

Attempt try_step(const StepBench& bench, const State& from, const StepGoal& goal, const StepControl& control,
                 double small_step, bool again) {
    StepInProgress p = begin_step(bench, from, goal);
    p.step.end.control = control;
    if (again) p.step.end.memory.steps_since_detection = 0;
    std::optional<StepError> error;
    try {
        error = advance(p, small_step);
    } catch (const SolvesSpent& spent) {
        fail(p, spent);
    }
    if (p.failed()) error = without_equilibrium;
    return {finished(std::move(p)), error};
}

} // namespace kluft

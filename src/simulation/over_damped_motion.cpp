#include "kluft/simulation/over_damped_motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kluft/core/memory.hpp"
#include "kluft/equilibrium/left_over.hpp"
#include "kluft/simulation/breaking.hpp"
#include "kluft/simulation/mass_term.hpp"
#include "kluft/simulation/placement.hpp"

namespace kluft {

namespace {

constexpr double collapse_motion = 0.5; ///< of a block in one load step
constexpr double first_step = 0.1;      ///< pseudo-time, of d2/E: a block of the net hardly deforms in it
constexpr double least_push = 0.01;     ///< of the sum of a block's contact forces: what is left over of them moves it
constexpr double least_step = 1e-12;    ///< of the first step
constexpr double at_once = 1e-6;        ///< of it: who moves far in it is a sliver that finds its place
constexpr double as_prescribed = 1e-6;  ///< of the spacing: how far off a prescribed displacement may be
constexpr double longest_step = 1e4;    ///< of that of an ordinary solve
constexpr double shortest_last = 0.01;  ///< of H2/E: the pseudo-time step before an ordinary solve is tried
constexpr double largest_growth = 3.0;  ///< of the pseudo-time step
constexpr double largest_cut = 0.2;     ///< of it
constexpr double least_cut = 0.7;       ///< of one that is taken again
constexpr double below_unsolved = 0.6;  ///< of a pseudo-time step that was not solved: the longest one after it
constexpr double return_growth = 1.3;   ///< of that longest one, with each step that is solved
constexpr double caution = 0.9;         ///< in the error expected of the next one
constexpr double tries_apart = 4.0;     ///< growth of the pseudo-time step between two ordinary solves
constexpr double tries_beside = 64.0;   ///< the same, while the motion is far from the end that one has found
constexpr double far_from_expected = 2.0; ///< times the error: not the way of the motion
constexpr double detection_motion = 5e-3; ///< of a block between two detections of contacts
constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Of implicit Euler, relative: half the square of the step times the second derivative, from the velocities of two steps.
double local_error(const StepInProgress& p, const Motion& motion, const Equilibrium& moved) {
    const Eigen::VectorXd velocity = (moved.displacement - p.displacement()) / motion.step;
    return relative_motion(p.bench.model.system, velocity - motion.velocity) * motion.step * motion.step /
           (motion.step + motion.step_before);
}

/// What the pseudo-time step should have been, over what it was.
double better_step(const StepInProgress& p, const Motion& motion, const Equilibrium& moved) {
    const double far = relative_motion(p.bench.model.system, moved.displacement - motion.start);
    const double error = local_error(p, motion, moved) / motion.allowed(far);
    const double order = motion.step_before > 0.0 ? 2.0 : 1.0; // of the error
    const double by_error = std::pow(std::max(error, 1e-12), -1.0 / order);
    return std::min(by_error, motion.control.longest / std::max(moved_by(p, moved), 1e-300));
}

/// Cuts the pseudo-time step where the first potential crack fails, on the straight line between its ends: what its error
/// allows.
PseudoStep cut_at_failure(StepInProgress& p, const PlacedState& placed, const Motion& motion, PseudoStep end) {
    const double tolerance = p.goal.cracks.event_tolerance;
    const EventGoal event{.last_without = 1.0 + tolerance, .index = 1.0 + 0.5 * tolerance, .reach = 0.5 * tolerance};
    const auto index_at = [&](const Eigen::VectorXd& q) {
        return largest_failure_index(p, placed.placement, motion.at, q);
    };
    const Eigen::VectorXd start = p.displacement();
    return first_event(
               event, 0.0, std::move(end), [&](const PseudoStep& step) { return index_at(step.moved.displacement); },
               [&] { return index_at(start); },
               [&](double share, double part, const PseudoStep& to) {
                   PseudoStep cut = to;
                   cut.load_factor = share;
                   cut.moved.displacement = start + part * (to.moved.displacement - start);
                   return cut;
               })
        .found;
}

/// Moves the body to the end of a pseudo-time step.
bool move_along(StepInProgress& p, const PlacedState& placed, Motion& motion, PseudoStep taken) {
    const BlockSystem& system = p.bench.model.system;
    const double length = taken.load_factor * motion.step;
    const Eigen::VectorXd velocity = (taken.moved.displacement - p.displacement()) / length;
    const double before = relative_motion(system, motion.velocity);
    const double now = relative_motion(system, velocity);
    motion.way_left = now < before ? now * length * now / (before - now) : unlimited; // it falls by the same factor
    add_motion(p, placed, motion.at, taken.moved.displacement, driving_forces(system, velocity), motion.energy);
    motion.velocity = velocity;
    motion.step_before = length;
    motion.last = std::move(taken.moved);
    if (!move_body(p, placed, motion.last)) return false;
    motion.largest = std::max(motion.largest, relative_motion(system, p.displacement() - motion.start));
    return true;
}

/// How far a block of a falling body has moved, over its motion_scale. With reduced strengths (32b).
double motion_of_a_fall(const StepInProgress& p) { return p.goal.must_rest ? jump_motion : collapse_motion; }

/// Under a given stress or weight a body that lost its balance may fall for ever.
bool is_falling(const StepInProgress& p) {
    const BlockSystem& system = p.bench.model.system;
    if (!is_loaded_by_stress(p.bench.stage(p.from))) return false;
    const Eigen::VectorXd moved = p.displacement() - p.from.body.displacement;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double far = motion_of_a_fall(p) * motion_scale(system, system.blocks[b]);
        if (moved.segment<2>(n_block_unknowns * b).norm() > far) return true;
    }
    return false;
}

void place_again(StepInProgress& p, PlacedState& placed, Motion& motion) {
    if (relative_motion(p.bench.model.system, p.displacement() - motion.detected) > detection_motion)
        return detect_anew(p, placed, motion);
    renew(p, placed);
    set_friction(motion.smooth, placed);
}

/// The state that a body has come to without friction, where it stands by the laws of its contacts.
std::optional<Equilibrium> stands_with_friction(const StepInProgress& p, PlacedState& placed, const Motion& motion) {
    renew(p, placed);
    set_friction({}, placed);
    Equilibrium found = motion.last;
    found.blocks = block_balance(loaded_body(p.bench.model, placed.placement, motion.at), p.displacement());
    found.verdict = judge_blocks(found.blocks, nullptr, p.goal.balance);
    if (found.verdict.balanced()) return found;
    return std::nullopt;
}

/// Whether the forces of a block's contacts move it; those of one that friction holds balance. Source: (29e).
bool is_pushed(const BlockSystem& system, const Equilibrium& at, const Eigen::VectorXd& driving, int b) {
    const double drives = size_of(affine_rigid_part(system, at.displacement, driving, b));
    return drives > least_push * at.blocks.forces.of_contacts[b];
}

/// The pseudo-time in which forces go through the body, by its blocks and by its softest interfaces (m2/Pa). Source: (29e).
double time_of_forces(const Model& model) {
    double softest = std::numeric_limits<double>::infinity();
    for (const InterfaceLaw& law : model.laws) softest = std::min({softest, law.normal_stiffness, law.shear_stiffness});
    const double height = (model.system.upper - model.system.lower).maxCoeff();
    return height * height * (1.0 / model.effective_modulus + 1.0 / (softest * model.system.spacing));
}

/// Contacts of idle blocks that are pushed no longer rub once the motion has gone on for the time in which friction could have
/// held them; they rub again where blocks take up a load (29e).
void update_smooth_blocks(const StepInProgress& p, Motion& motion) {
    const Model& model = p.bench.model;
    const std::vector<char>& idle = motion.last.blocks.forces.idle;
    motion.age += motion.step_before;
    if (idle.empty() || motion.age < time_of_forces(model)) return;
    motion.smooth.resize(idle.size(), 0);
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        const bool slips_free = motion.smooth[b] != 0 || is_pushed(model.system, motion.last, motion.energy.driving, b);
        motion.smooth[b] = idle[b] != 0 && slips_free ? 1 : 0;
    }
}

/// Whether the motion has come to where the last ordinary solve has found its end.
bool is_at_end(const StepInProgress& p, const Motion& motion) {
    return motion.end.size() > 0 && relative_motion(p.bench.model.system, motion.end - p.displacement()) <=
                                        far_from_expected * motion.allowed(0.0);
}

/// Whether an ordinary solve may find the end of the motion near by.
bool may_end(const StepInProgress& p, const Motion& motion) {
    if (motion.last.blocks.forces.has_shed_its_load) return false; // such a motion ends where the body is at rest
    if (motion.step * mass_coefficient(p.bench.model, 1.0) < shortest_last) return false;
    if (is_at_end(p, motion)) return true;
    const double apart = motion.end.size() > 0 ? tries_beside : tries_apart;
    return motion.way_left <= motion.allowed(0.0) && motion.step > apart * motion.tried;
}

/// The equilibrium that the motion is about to come to, where an ordinary solve finds it.
std::optional<Equilibrium> find_end(StepInProgress& p, PlacedState& placed, Motion& motion) {
    if (!may_end(p, motion)) return std::nullopt;
    motion.tried = motion.step;
    if (motion.detected != p.displacement()) detect_anew(p, placed, motion);
    set_friction({}, placed);
    Equilibrium found = find_at(p, placed, motion.at.load_factor, p.displacement());
    motion.end = found.balanced ? found.displacement : Eigen::VectorXd(); // an end that is not found again is none
    if (is_at_end(p, motion)) return found;
    set_friction(motion.smooth, placed);
    return std::nullopt;
}

} // namespace

void set_friction(const std::vector<char>& smooth, PlacedState& placed) {
    for (ContactPoint& point : placed.placement.contacts) {
        const bool rubs = smooth.empty() || (smooth[point.block_a] == 0 && smooth[point.block_b] == 0);
        point.held_limit = rubs ? std::nullopt : std::optional(0.0);
    }
}

Motion begin_motion(const StepInProgress& p, double load_factor, const MotionControl& control) {
    const Model& model = p.bench.model;
    const double viscosity = p.bench.solver.viscosity;
    Motion motion{.at = p.loads_at(load_factor), .control = control};
    motion.first = first_step * model.system.spacing * model.system.spacing / model.effective_modulus;
    motion.ordinary = 1.0 / mass_coefficient(model, viscosity > 0.0 ? viscosity : SolverOptions{}.viscosity);
    motion.step = motion.first;
    motion.start = motion.detected = motion.early = p.displacement();
    motion.velocity.setZero(motion.start.size());
    motion.last.load_factor = load_factor;
    motion.last.strength_factor = motion.at.strength_factor;
    return motion;
}

void restart(Motion& motion) {
    motion.step = std::min(motion.step, motion.first);
    motion.age = 0.0;
    motion.smooth.clear();
    motion.foretells = true;
    motion.step_limit = unlimited;
    motion.velocity.setZero();
    motion.energy.driving.resize(0);
    motion.end.resize(0);
    motion.step_before = motion.tried = 0.0;
    motion.way_left = unlimited;
}

PseudoStep solve_step(StepInProgress& p, const PlacedState& placed, const Motion& motion,
                      const Eigen::VectorXd& guess) {
    const auto& [model, cracks, solver, loads, search, last_detection, journal, stop] = p.bench;
    if (stop) throw Interrupted{};
    require_memory();
    const double eta = 1.0 / motion.step;
    const EquilibriumProblem problem{loaded_body(model, placed.placement, motion.at),
                                     std::vector<double>(model.system.blocks.size(), eta), 0.0, p.displacement()};
    PseudoStep step;
    Equilibrium& moved = step.moved;
    moved = search.move_on(problem, guess, p.goal.balance, p.step.end.body.contacts.empty());
    moved.load_factor = motion.at.load_factor;
    moved.strength_factor = motion.at.strength_factor;
    count_solves(p, moved);
    step.balanced =
        moved.converged() || moved.summary.termination == Termination::relaxed ||
        (follows(p, moved) && moved.summary.residual_ratio <= solver.tolerance); // a single small block, on the way
    return step;
}

bool follows(const StepInProgress& p, const Equilibrium& moved) {
    return moved.summary.left_to_go <= as_prescribed * p.bench.model.system.spacing;
}

double moved_by(const StepInProgress& p, const Equilibrium& moved) {
    return relative_motion(p.bench.model.system, moved.displacement - p.displacement());
}

void detect_anew(StepInProgress& p, PlacedState& placed, Motion& motion) {
    placed = place(p);
    set_friction(motion.smooth, placed);
    motion.detected = p.displacement();
}

void touch_anew(const StepInProgress& p, Motion& motion) { motion.at = p.loads_at(motion.at.load_factor); }

bool checks_events(const StepGoal& goal) { return goal.checks_cracks && goal.cracks.update == CrackUpdate::event; }

void break_there(StepInProgress& p, PlacedState& placed, Motion& motion) {
    touch_anew(p, motion);
    if (!checks_events(p.goal) || !break_at(p, placed, motion.at)) return;
    restart(motion);
    detect_anew(p, placed, motion);
}

std::optional<Equilibrium> take_pseudo_step(StepInProgress& p, PlacedState& placed, Motion& motion) {
    touch_anew(p, motion);
    const double ahead = motion.foretells ? motion.step : 0.0;
    PseudoStep next = solve_step(p, placed, motion, p.displacement() + ahead * motion.velocity);
    if (!next.balanced) {
        motion.foretells = false;
        motion.step_limit = below_unsolved * motion.step;
        motion.step *= largest_cut;
        if (motion.step > least_step * motion.first) return std::nullopt;
        fail(p, next.moved, next.moved.summary.residual_ratio, FailureKind::no_equilibrium);
        return std::move(next.moved);
    }
    const double better = better_step(p, motion, next.moved);
    if (better < 1.0 && motion.step > at_once * motion.first) {
        motion.step *= std::clamp(caution * better, largest_cut, least_cut);
        return std::nullopt;
    }
    if (checks_events(p.goal)) next = cut_at_failure(p, placed, motion, std::move(next));
    Equilibrium& moved = next.moved;
    moved.verdict =
        judge_blocks(moved.blocks, motion.last.blocks.left.empty() ? nullptr : &motion.last.blocks, p.goal.balance);
    moved.balanced = moved.verdict.balanced() && moved.viscous_share <= p.goal.balance.share;
    // of a body that has shed its load no force is left that a slow beginning of a motion could let grow
    const bool at_rest = motion.step >= motion.ordinary || moved.blocks.forces.has_shed_its_load;
    const bool ends = moved.balanced && next.load_factor == 1.0 && at_rest;
    const bool rubs = std::ranges::none_of(motion.smooth, [](char smooth) { return smooth != 0; });
    if (ends && rubs) return std::move(moved);
    if (!move_along(p, placed, motion, std::move(next))) return motion.last;
    if (is_falling(p)) {
        fail(p, motion.last, motion.last.viscous_share, FailureKind::falling);
        p.step.failure->moving = moving_on(p, motion.early, std::move(p.step.failure->moving));
        return motion.last;
    }
    if (motion.largest < 0.5 * motion_of_a_fall(p)) motion.early = p.displacement();
    if (ends) {
        if (auto end = stands_with_friction(p, placed, motion)) return end;
    }
    motion.step = std::min({motion.step * std::clamp(caution * better, largest_cut, largest_growth),
                            longest_step * motion.ordinary, motion.step_limit});
    motion.step_limit *= return_growth;
    update_smooth_blocks(p, motion);
    place_again(p, placed, motion);
    break_there(p, placed, motion);
    return find_end(p, placed, motion);
}

} // namespace kluft

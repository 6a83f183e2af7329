#include "kluft/simulation/step_in_progress.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/memory.hpp"
#include "kluft/core/stopwatch.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/simulation/mass_term.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/state_check.hpp"
#include "kluft/simulation/step_control.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "kluft/simulation/stress_drop.hpp"

namespace kluft {

namespace {

constexpr double kept_motion = 5e-3; ///< of a block, after which contact points are not kept (relative_motion)

/// Vertices that have come near a platen become points of it.
void watch_platens(StepInProgress& p) {
    if (p.hold.points.empty()) return;
    LoadsAt at = p.loads_at(p.load_factor());
    add_near_points(p.bench.model.system, p.displacement(), contact_reach * p.bench.model.system.spacing, at.loads);
    p.hold.points = std::move(at.loads.platen_points);
}

/// Bonds in the frames of the state beside the given contacts.
PlacedState placed_with(StepInProgress& p, DetectedContacts contacts) {
    const auto& [model, cracks, solver, loads, search, last_detection, journal, stop] = p.bench;
    const BodyState& body = p.step.end.body;
    PlacedState placed;
    {
        const Stopwatch watch(journal.report().costs.seconds.set_up);
        placed.placement.bonds = placed_bonds(model, body);
    }
    placed.placement.contacts = std::move(contacts.points);
    search.require_pairs(placed.placement.contacts, std::move(contacts.near_pairs));
    const std::vector<char> bonded = bonded_interfaces(body);
    const bool separated = std::ranges::find(bonded, 0) != bonded.end();
    const bool needs_mass = separated || !is_held(model.system, bonded, p.hold.constraints);
    if (needs_mass && solver.viscosity > 0.0)
        placed.eta.assign(model.system.blocks.size(), mass_coefficient(model, solver.viscosity));
    return placed;
}

bool has_surfaces_to_meet(const Model& model, const BodyState& body) {
    return may_outlines_meet(model) || std::ranges::any_of(body.interfaces, [](InterfaceStatus status) {
               return status != InterfaceStatus::potential_crack;
           });
}

/// The largest stresses so far, which errors of the history are relative to.
void note_stresses(StepInProgress& p, const LoadedBody& body) {
    StressHistory& stresses = p.step.end.stresses;
    note_axial_stress(p.bench.stage(p.from), p.step.row, stresses);
    if (p.goal.accuracy > 0.0 && !prescribes_strain(p.bench.stage(p.from)))
        stresses.largest_mean = std::max(stresses.largest_mean, weighted_stresses(body, p.displacement()).norm());
}

} // namespace

StepInProgress begin_step(const StepBench& bench, const State& from, const StepGoal& goal) {
    StepInProgress p{bench, from, goal, {}, hold_of(bench.model, bench.loads, from.body)};
    p.step.end = from;
    p.step.end.is_settled = true;
    p.step.row = goal.row;
    return p;
}

Step finished(StepInProgress p) {
    Step& step = p.step;
    step.end.memory.near_pairs = p.bench.search.near_pairs();
    if (step.failure) keep_balanced_part(step);
    step.row.open_close_iterations = p.bench.journal.report().costs.open_close_iterations - p.goal.solves_before;
    step.row.balanced = step.balanced;
    step.row.unbalanced_ratio = step.worst_share;
    return std::move(step);
}

DetectedContacts detect(const StepInProgress& p) {
    const Model& model = p.bench.model;
    const BodyState& body = p.step.end.body;
    RunReport& report = p.bench.journal.report();
    const Stopwatch watch(report.costs.seconds.detection);
    const bool hold_tips = ground_holds_tips(model, p.from.at.stage);
    std::optional<LastDetection> last = std::exchange(p.bench.last_detection, std::nullopt);
    if (last && is_of(*last, body, hold_tips)) return std::move(last->contacts);
    ++report.detections;
    return detected_contacts(model, body, hold_tips);
}

void keep_detected(const StepInProgress& p, DetectedContacts contacts) {
    const bool hold_tips = ground_holds_tips(p.bench.model, p.from.at.stage);
    p.bench.last_detection = LastDetection{std::move(contacts), p.step.end.body, hold_tips};
}

PlacedState place(StepInProgress& p) {
    SolverMemory& memory = p.step.end.memory;
    memory.steps_since_detection = 0;
    memory.kept_points.clear();
    if (p.bench.solver.detection_every > 1) memory.detected_at = p.displacement();
    const bool meet = has_surfaces_to_meet(p.bench.model, p.step.end.body);
    watch_platens(p);
    return placed_with(p, meet ? detect(p) : DetectedContacts{});
}

PlacedState place_for_load_step(StepInProgress& p) {
    SolverMemory& memory = p.step.end.memory;
    const bool keeps = memory.steps_since_detection > 0 &&
                       memory.steps_since_detection < p.bench.solver.detection_every &&
                       relative_motion(p.bench.model.system, p.displacement() - memory.detected_at) <= kept_motion;
    PlacedState placed =
        keeps ? placed_with(p, {renewed_contacts(p.step.end.body, std::move(memory.kept_points)), {}}) : place(p);
    ++memory.steps_since_detection;
    if (p.bench.solver.detection_every > 1) memory.kept_points = placed.placement.contacts;
    return placed;
}

void renew(const StepInProgress& p, PlacedState& placed) {
    placed.placement.bonds = placed_bonds(p.bench.model, p.step.end.body);
    placed.placement.contacts = renewed_contacts(p.step.end.body, std::move(placed.placement.contacts));
}

EquilibriumProblem pose(const Model& model, const PlacedState& placed, const LoadsAt& at,
                        const Eigen::VectorXd& start) {
    return {loaded_body(model, placed.placement, at), placed.eta, least_mass_area(model.system), start};
}

Eigen::VectorXd predicted(const StepInProgress& p, double load_factor) {
    const Eigen::VectorXd& rate = p.step.end.memory.rate;
    if (rate.size() == 0) return p.displacement();
    return p.displacement() + (load_factor - p.load_factor()) * rate;
}

Equilibrium find_at(StepInProgress& p, const PlacedState& placed, double load_factor, Eigen::VectorXd guess) {
    const auto& [model, cracks, solver, loads, search, last_detection, journal, stop] = p.bench;
    if (stop) throw Interrupted{};
    require_memory();
    State& state = p.step.end;
    const LoadsAt at = p.loads_at(load_factor);
    if (model.kinematics == Kinematics::rigid) make_rigid(model.system, guess);
    const Circumstances circumstances{.unloaded = state.body.contacts.empty(),
                                      .given_loads = is_loaded_by_stress(p.bench.stage(p.from))};
    Equilibrium found = search.find(pose(model, placed, at, p.displacement()), guess, p.goal.balance, circumstances);
    found.load_factor = load_factor;
    found.strength_factor = at.strength_factor;
    count_solves(p, found);
    return found;
}

void follow_loads(StepInProgress& p, const PlacedState& placed, Equilibrium& found) {
    const Model& model = p.bench.model;
    if (p.goal.must_rest || !is_loaded_by_stress(p.bench.stage(p.from))) return;
    const LoadsAt at = p.loads_at(found);
    if (!at.loads.platens.empty()) return;
    const int so_far = std::exchange(found.iterations, 0);
    p.bench.search.follow_loads(pose(model, placed, at, found.displacement), p.from.body.displacement, p.goal.balance,
                                found);
    count_solves(p, found);
    found.iterations += so_far;
}

bool move_body(StepInProgress& p, const PlacedState& placed, const Equilibrium& found) {
    Step& step = p.step;
    const LoadsAt at = p.loads_at(found);
    const Eigen::VectorXd& q = found.displacement;
    const LoadedBody body = loaded_body(p.bench.model, placed.placement, at);
    if (auto flaw = flaw_of_displacements(body, q); !flaw.empty()) {
        step.failure =
            Failure{.kind = FailureKind::broken_body, .load_factor = at.load_factor, .what = std::move(flaw)};
        return false;
    }
    if (step.lost_contact.empty()) step.lost_contact = lost_contact(body, q);
    keep_histories(body, q, step.end.body);
    step.end.body.displacement = q;
    if (found.hold) p.hold = *found.hold;
    keep_slips(p.bench.model.system, q, at.loads.platens, p.hold.points);
    step.end.body.platen_points = p.hold.points;
    return true;
}

void reach(StepInProgress& p, PlacedState placed, const Equilibrium& found) {
    Step& step = p.step;
    LoadsAt at = p.loads_at(found);
    if (!move_body(p, placed, found)) return;
    step.end.at.load_factor = found.load_factor;
    Measured measured = measure(p, placed, at, found);
    step.row = std::move(measured.row);
    step.end.body.holding_forces = holding_forces(p.bench.model, p.bench.loads, at.loads, measured.forces);
    step.balanced = step.balanced && found.balanced;
    step.worst_share = std::max(step.worst_share, found.viscous_share);
    note_stresses(p, loaded_body(p.bench.model, placed.placement, at));
    step.equilibria.push_back(step.row);
    step.moving = moving_on(p, p.displacement(), found.verdict.moving);
    step.in_place = {std::move(placed.placement), std::move(at)};
    if (found.balanced) step.balanced_part.reset();
}

Measured measure(const StepInProgress& p, const PlacedState& placed, const LoadsAt& at, const Equilibrium& found) {
    const auto& [model, cracks, solver, loads, search, last_detection, journal, stop] = p.bench;
    const EquilibriumProblem problem{loaded_body(model, placed.placement, at), {}, 0.0, {}};
    Measured result;
    result.forces = search.forces(problem, found.displacement);
    StepRecord& row = result.row;
    row = measure_step(model, journal.gauges(), p.step.end, problem.body, loads, found.displacement, result.forces);
    row.open_close_iterations = journal.report().costs.open_close_iterations - p.goal.solves_before;
    row.crack_passes = p.step.crack_passes;
    row.unbalanced_ratio = found.viscous_share;
    row.balance_error = found.verdict.error;
    row.jumps = p.step.end.jumps;
    row.balanced = found.balanced;
    row.elapsed_s = journal.elapsed();
    if (reduction_of(model.loads, 0) != nullptr) row.strength_factor = at.strength_factor;
    return result;
}

std::vector<MovingBlock> moving_on(const StepInProgress& p, const Eigen::VectorXd& q, std::vector<MovingBlock> moving) {
    return moving_on(p.bench.model.system, p.from.body.displacement, q, std::move(moving));
}

void fail(StepInProgress& p, const Equilibrium& found, double residual_ratio, FailureKind kind) {
    p.step.failure = Failure{.kind = found.summary.flaw.empty() ? kind : FailureKind::broken_body,
                             .worst_block = found.worst_block,
                             .residual_ratio = residual_ratio,
                             .load_factor = found.load_factor,
                             .strength_factor = found.strength_factor,
                             .nothing_holds = p.bench.loads.constraints().rows().empty(),
                             .moving = moving_on(p, p.displacement(), found.verdict.moving),
                             .what = found.summary.flaw};
    Failure& failure = *p.step.failure;
    if (failure.kind == FailureKind::falling || p.goal.must_rest) // else what loads have displaced moves as far
        failure.along = moving_along(p.bench.model.system, p.from.body.displacement, p.displacement(), failure.moving);
}

void count_solves(StepInProgress& p, const Equilibrium& found) {
    RunCosts& costs = p.bench.journal.report().costs;
    costs.open_close_iterations += found.iterations;
    p.step.worst_block = found.worst_block;
    p.bench.journal.progress(p.step.end, p.step.row, found.load_factor, costs.open_close_iterations);
    if (costs.open_close_iterations - p.goal.solves_before > p.bench.solver.max_step_solves) throw SolvesSpent{found};
}

void fail(StepInProgress& p, const SolvesSpent& spent) {
    const Model& model = p.bench.model;
    fail(p, spent.last, spent.last.summary.residual_ratio, FailureKind::too_many_solves);
    Failure& failure = *p.step.failure;
    const std::string where = description(model, Failure{.worst_block = failure.worst_block,
                                                         .residual_ratio = failure.residual_ratio,
                                                         .moving = failure.moving,
                                                         .what = failure.what});
    const auto n_bonds = p.step.cracks.size();
    failure.what = fmt::format("{} linear solves, as many as one load step may take (`solver.max_step_solves`){}; {}",
                               p.bench.solver.max_step_solves,
                               n_bonds > 0 ? fmt::format(", in which {} bonds broke", n_bonds) : "", where);
}

void keep_rate(StepInProgress& p) {
    if (p.load_factor() == p.from.at.load_factor) return p.step.end.memory.rate.resize(0);
    p.step.end.memory.rate = (p.displacement() - p.from.body.displacement) / (p.load_factor() - p.from.at.load_factor);
}

} // namespace kluft

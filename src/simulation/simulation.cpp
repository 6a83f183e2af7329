#include "kluft/simulation/simulation.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "kluft/assembly/blas.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/simulation/accurate_steps.hpp"
#include "kluft/simulation/causes.hpp"
#include "kluft/simulation/fallen_blocks.hpp"
#include "kluft/simulation/fixed_steps.hpp"
#include "kluft/simulation/load_step.hpp"
#include "kluft/simulation/strength_reduction.hpp"
#include "kluft/simulation/strength_search.hpp"

namespace kluft {

namespace {

/// The state as it stands, under the loads of a load factor.
struct MeasuredState {
    Measured measured;
    LoadedPlacement in_place;
};

MeasuredState measure_state(const StepBench& bench, const State& state, double load_factor) {
    const StepGoal goal;
    StepInProgress p = begin_step(bench, state, goal);
    PlacedState placed = place_for_load_step(p);
    LoadsAt at = p.loads_at(load_factor);
    Equilibrium standing;
    standing.displacement = state.body.displacement;
    standing.balanced = true;
    MeasuredState result;
    result.measured = measure(p, placed, at, standing);
    result.in_place = {std::move(placed.placement), std::move(at)};
    return result;
}

/// Tells the state before any load; a resumed run goes on from the row of its state, which was told before.
void begin_run(const StepBench& bench, const State& state) {
    MeasuredState start = measure_state(bench, state, state.at.load_factor);
    start.measured.row.step = state.at.step;
    if (state.at.step == 0 && state.at.stage == 0)
        return bench.journal.begin(start.measured.row, state, std::move(start.in_place));
    bench.journal.go_on_from(std::move(start.measured.row));
}

StageLoads begin_stage(const Model& model, const SolverOptions& solver, EquilibriumSearch& search, State& state) {
    const Stage& stage = model.loads.stages[state.at.stage];
    if (state.at.is_at_stage_start()) {
        state.memory.rate.resize(0);
        state.control.size = 1.0 / stage.steps;
        state.control.lag = 0.0;
        state.memory.steps_since_detection = 0;
    }
    const auto& reduction = stage.strength_reduction;
    search.set_tolerance(reduction ? reduction_tolerance(*reduction, solver) : solver.tolerance);
    return enter_stage(model, state);
}

StageEnd run_stage(const StepBench& bench, State& state) {
    if (bench.stage(state).strength_reduction) return find_strength_limit(bench, state);
    if (StageEnd end = end_after(bench, state); end.ends_run()) return end; // as before it was resumed
    if (bench.solver.accuracy > 0.0) return run_accurate_steps(bench, state);
    return run_fixed_steps(bench, state);
}

LoadsAt loads_at(const StepBench& bench, const State& state, double load_factor) {
    return kluft::loads_at(bench.model, bench.loads, hold_of(bench.model, bench.loads, state.body), state.at.stage,
                           load_factor);
}

/// What the loads say of why a stage has ended out of balance.
std::vector<std::string> causes_of(const StepBench& bench, const State& state, const StageEnd& end) {
    const bool balanced = !end.failure && state.unbalanced_in_succession == 0;
    if (balanced) return {};
    const double load_factor = end.failure ? end.failure->load_factor : 1.0;
    const LoadsAt at = loads_at(bench, state, load_factor);
    return likely_causes(bench.model, at, end.failure ? end.failure->moving : state.imbalance.moving);
}

/// Blocks that give way by little may hold each other where they come to rest, as a row of columns does that topples. A reduction of strengths says
/// so itself.
void warn_of_small_jump(const StepBench& bench, const State& state) {
    const std::vector<Stage>& stages = bench.model.loads.stages;
    const int next = state.at.stage + 1;
    if (next < static_cast<int>(stages.size()) && stages[next].strength_reduction) return;
    const std::string jump = description_of_small_jump(bench.model, state.stage_start.displacement, state);
    if (jump.empty()) return;
    bench.journal.report().warnings.push_back(
        fmt::format("under the loads of stage {} the body has jumped (jumps.csv), and {}: it gave way as it was cut, "
                    "and stands where it has come to. A "
                    "stage of `strength_reduction` with `from` well below 1 finds the strength of the body as cut",
                    state.at.stage, jump));
}

/// A body that has given way under given loads, and stands elsewhere, is balanced like any other.
void warn_of_fall(const StepBench& bench, const State& state) {
    const Stage& stage = bench.stage(state);
    if (stage.motion || stage.strength_reduction) return;
    const std::string fall = description_of_fall(bench.model, state.stage_start.displacement, state);
    if (fall.empty()) return warn_of_small_jump(bench, state);
    bench.journal.report().warnings.push_back(fmt::format(
        "the body gave way under the loads of stage {} and came to rest elsewhere (a jump): {}. What is found of "
        "it then is not the strength of the body as cut",
        state.at.stage, fall));
}

/// Jumps of the path, and events in load steps that had to be relaxed, may cost more than was asked for.
void report_estimate(double accuracy, const State& state, RunReport& report) {
    const double estimate = state.control.estimated_error;
    report.results.estimated_error = estimate;
    if (estimate <= accuracy) return;
    report.warnings.push_back(fmt::format(
        "the estimated error of the load steps is {:.2g} %, more than the {:.2g} % of solver.accuracy: the path "
        "jumps, or no equilibrium was found where an event had to be met, and what lies between is not known",
        100.0 * estimate, 100.0 * accuracy));
}

void warn_of_late_checks(const CrackOptions& cracks, const Journal& journal, RunReport& report) {
    const bool by_every_event = cracks.update == CrackUpdate::event && cracks.every <= 1;
    if (by_every_event) return;
    std::string warning = warning_of_late_checks(
        journal.largest_checked(),
        cracks.every > 1 ? fmt::format("only one load step in {} checks them (cracks.every)", cracks.every)
                         : "a load step checks them at its end (cracks.update)",
        cracks.every > 1 ? "cracks.every: 1 with cracks.update: event" : "cracks.update: event");
    if (!warning.empty()) report.warnings.push_back(std::move(warning));
}

/// Of a search for the limit that was stopped: how far it had come. It claims no factor of safety.
std::string standing_in_words(const Model& model, const State& state) {
    if (!model.loads.stages[state.at.stage].strength_reduction) return {};
    return fmt::format(
        "the body stood with the strengths divided by {:.4g}, and larger factors were not searched to the "
        "end",
        strength_factor(model.loads, state.at.stage, state.at.load_factor));
}

/// The next stage starts from the loads at the end of this one.
void end_stage(const StepBench& bench, State& state) {
    const LoadsAt at = loads_at(bench, state, 1.0);
    const RunCosts costs = bench.journal.costs();
    leave_stage(bench.model, bench.loads, at.loads, state);
    state.costs = costs;
    state.remarks = bench.journal.remarks();
}

} // namespace

State initial_state(const Model& model) {
    State state;
    const auto n = static_cast<Eigen::Index>(n_block_unknowns) * model.system.n_blocks();
    state.body.displacement = Eigen::VectorXd::Zero(n);
    state.stage_start.displacement = state.body.displacement;
    for (const Interface& interface : model.system.interfaces) {
        state.body.interfaces.push_back(model.bonds[interface.interface_type] ? InterfaceStatus::potential_crack
                                                                              : InterfaceStatus::fracture);
    }
    state.body.bond_shear.assign(static_cast<std::size_t>(n_bond_points) * model.system.interfaces.size(), 0.0);
    state.stage_start.boundary_pressure.assign(model.system.boundaries.size(), 0.0);
    state.body.holding_forces.assign(model.system.boundaries.size(), 0.0);
    return state;
}

RunReport run_simulation(const Model& model, const CrackOptions& cracks, const SolverOptions& solver, State& state,
                         StepObserver& observer, const std::atomic<bool>& stop) {
    const OwnThreads of_run(1); // those of the BLAS would wait for work in a loop, and take as much time as the run
    EquilibriumSearch search(model, solver);
    std::optional<LastDetection> last_detection;
    Journal journal(model, state, observer, solver.accuracy > 0.0 ? 0 : number_of_steps(model), &search);
    RunReport report = report_of(journal, [&] {
        if (state.at.step > 0) search.order_for(state.memory.near_pairs);
        for (bool begins = true;; begins = false) {
            const StageLoads loads = begin_stage(model, solver, search, state);
            const StepBench bench{model, cracks, solver, loads, search, last_detection, journal, stop};
            if (begins) begin_run(bench, state);
            StageEnd end = run_stage(bench, state);
            const bool last = state.at.stage + 1 == static_cast<int>(model.loads.stages.size());
            end.causes = causes_of(bench, state, end);
            if (!end.failure && state.unbalanced_in_succession == 0) warn_of_fall(bench, state);
            if (end.ends_run() || last || state.unbalanced_in_succession > 0) return journal.ended(state, end);
            end_stage(bench, state);
        }
    });
    if (report.status == RunStatus::interrupted) report.diagnosis = standing_in_words(model, state);
    warn_of_late_checks(cracks, journal, report);
    if (solver.accuracy > 0.0) report_estimate(solver.accuracy, state, report);
    return report;
}

} // namespace kluft

// What load steps are made of: a step under way, its placements, its equilibria and where they lead.
#pragma once

#include <atomic>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "kluft/simulation/equilibrium_search.hpp"
#include "kluft/simulation/event_search.hpp"
#include "kluft/simulation/journal.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step.hpp"

namespace kluft {

/// What is asked of a load step.
struct StepGoal {
    double load_factor = 1.0;   ///< where it is to end
    BlockGoal balance;          ///< of its equilibria
    bool checks_cracks = false; ///< whether potential cracks may fail in it
    CrackOptions cracks;        ///< how
    bool must_rest =
        false; ///< a body that moves on in a relaxation, however slowly, has no equilibrium: strengths are reduced
    double accuracy = 0.0; ///< of a step whose size follows from it; 0: of one of a given size
    int solves_before = 0; ///< linear solves of the run before the step, and before those that it replaces
    StepRecord row;        ///< of the load step before
};

/// What the load steps of a stage work with. It refers to its parts and has no state of its own.
struct StepBench {
    const Model& model;
    const CrackOptions& cracks;
    const SolverOptions& solver;
    const StageLoads& loads;
    EquilibriumSearch& search;
    std::optional<LastDetection>& last_detection; ///< until somebody takes it
    Journal& journal;                             ///< counts what is spent, for steps that are kept and for others
    const std::atomic<bool>& stop;

    [[nodiscard]] const Stage& stage(const State& state) const { return model.loads.stages[state.at.stage]; }
};

/// A load step under way: `step.end` stands at the last equilibrium, or on the way to the next one.
struct StepInProgress {
    StepBench bench;
    const State& from;
    const StepGoal& goal;
    Step step;
    PlatenHold hold;          ///< of the platens where the step stands
    bool is_at_limit = false; ///< no equilibrium was found a little further on, and no potential crack fails before

    [[nodiscard]] const Eigen::VectorXd& displacement() const { return step.end.body.displacement; }
    [[nodiscard]] double load_factor() const { return step.end.at.load_factor; }
    [[nodiscard]] LoadsAt loads_at(double load_factor) const { return loads_at(hold, load_factor); }
    /// Under which an equilibrium was found.
    [[nodiscard]] LoadsAt loads_at(const Equilibrium& found) const {
        return loads_at(found.hold.value_or(hold), found.load_factor);
    }
    [[nodiscard]] LoadsAt loads_at(const PlatenHold& held, double load_factor) const {
        LoadsAt at = kluft::loads_at(bench.model, bench.loads, held, step.end.at.stage, load_factor);
        if (!has_given_loads(bench.model, at.loads)) at.carried_stress = from.stresses.largest_axial; // (27c)
        return at;
    }
    [[nodiscard]] bool failed() const { return step.failure.has_value(); }
};
[[nodiscard]] StepInProgress begin_step(const StepBench& bench, const State& from, const StepGoal& goal);
/// The step as it stands, with the totals of its row.
[[nodiscard]] Step finished(StepInProgress in_progress);

/// Bonds and contacts of the state that a step stands at, and what all trials from it share.
struct PlacedState {
    Placement placement;
    std::vector<double> eta; ///< of the mass-like term per block (Pa/m2); empty where nothing needs it
};
/// Contacts of surfaces that may touch where the step stands: those that were kept, or detected anew.
[[nodiscard]] DetectedContacts detect(const StepInProgress& in_progress);
/// For who detects next, if the body still stands there: a load step begins with what has told that the one before may end.
void keep_detected(const StepInProgress& in_progress, DetectedContacts contacts);

/// Detects contacts and gives them their memory; at the start of a load step the contacts may be those of the step before.
[[nodiscard]] PlacedState place(StepInProgress& in_progress);
[[nodiscard]] PlacedState place_for_load_step(StepInProgress& in_progress);
/// The same contacts in the same frames, with the histories of the state that the step stands at.
void renew(const StepInProgress& in_progress, PlacedState& placed);

/// The problem of the placed state under loads, with the mass-like term counted from `start`.
[[nodiscard]] EquilibriumProblem pose(const Model& model, const PlacedState& placed, const LoadsAt& at,
                                      const Eigen::VectorXd& start);

/// The displacements at a load factor if the last smooth step goes on.
[[nodiscard]] Eigen::VectorXd predicted(const StepInProgress& in_progress, double load_factor);

/// Searches the equilibrium at a load factor from the state that the step stands at.
[[nodiscard]] Equilibrium find_at(StepInProgress& in_progress, const PlacedState& placed, double load_factor,
                                  Eigen::VectorXd guess);

/// What balances a body beside all that it carries may be much beside loads that are small and are added to it, and hold back what is
/// soft: follows the loads to their end (docs/theory.md, (27e) and (27f)).
void follow_loads(StepInProgress& in_progress, const PlacedState& placed, Equilibrium& found);

/// Moves the body to what was found: contacts keep their histories. False, and the step has failed, where its displacements
/// are those of no body.
bool move_body(StepInProgress& in_progress, const PlacedState& placed, const Equilibrium& found);

/// Makes an equilibrium the end of the step, with a record of it.
void reach(StepInProgress& in_progress, PlacedState placed, const Equilibrium& found);

/// What an equilibrium measures, and its forces, internal - external without the supports' (N/m). The step need not have
/// reached it.
struct Measured {
    StepRecord row;
    Eigen::VectorXd forces;
};
[[nodiscard]] Measured measure(const StepInProgress& in_progress, const PlacedState& placed, const LoadsAt& at,
                               const Equilibrium& found);

/// Cuts the way to an equilibrium at its first event (event_search.hpp). `index_at(loads, q)`: the index that an event
/// belongs to.
template <class IndexAt>
[[nodiscard]] EventCut<Equilibrium> cut_at_event(StepInProgress& in_progress, const PlacedState& placed,
                                                 Equilibrium found, const EventGoal& goal, IndexAt index_at) {
    const double from = in_progress.load_factor();
    const Eigen::VectorXd start = in_progress.displacement();
    return first_event(
        goal, from, std::move(found),
        [&](const Equilibrium& at) { return index_at(in_progress.loads_at(at), at.displacement); },
        [&] { return index_at(in_progress.loads_at(from), start); },
        [&](double load_factor, double share, const Equilibrium& end) {
            return find_at(in_progress, placed, load_factor, start + share * (end.displacement - start));
        });
}

/// Thrown by find_at and solve_step where the load step has taken as many linear solves as it may.
struct SolvesSpent {
    Equilibrium last;
};
/// Counts the linear solves that led to `found`. Throws SolvesSpent.
void count_solves(StepInProgress& in_progress, const Equilibrium& found);
/// The step has failed: its solves are spent.
void fail(StepInProgress& in_progress, const SolvesSpent& spent);

/// Where blocks have moved away in the load step up to q, they go on in that direction (failure.hpp).
[[nodiscard]] std::vector<MovingBlock> moving_on(const StepInProgress& in_progress, const Eigen::VectorXd& q,
                                                 std::vector<MovingBlock> moving);

/// The step has failed at what was found.
void fail(StepInProgress& in_progress, const Equilibrium& found, double residual_ratio, FailureKind kind);

/// Keeps the rate of the smooth step so far, from which the next one is predicted; none of a step without length.
void keep_rate(StepInProgress& in_progress);

} // namespace kluft

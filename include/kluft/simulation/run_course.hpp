// The course of a run, whatever finds the equilibrium of its load steps: stages, committed load steps, how it ends.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/simulation_options.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_observer.hpp"

namespace kluft {

/// Thrown by an integrator that was asked to stop.
struct Interrupted {};

/// Thrown by an integrator that finds no equilibrium.
struct LostEquilibrium {
    std::string what;             ///< follows "no equilibrium in stage 1 at load step 7: "
    bool may_be_collapse = false; ///< where the load is a stress, past what the body carries
};

/// What a run has in hand. Only `accept` changes the accepted state.
struct RunCourse {
    RunCourse(const Model& model, State& state, StepObserver& observer, const std::atomic<bool>& stop);

    const Model& model;
    State& accepted; ///< at the last committed load step
    StepObserver& observer;
    const std::atomic<bool>& stop;
    State work; ///< at the last equilibrium
    Gauges gauges;
    std::optional<StageLoads> loads; ///< of the stage in progress
    StepRecord last_record;
    RunReport report;
    int n_steps = 0;            ///< of all stages
    int passes = 0;             ///< of crack checks in the load step that failed something
    bool chooses_steps = false; ///< their number is not known beforehand
    bool holds_back = false;    ///< what happens in a load step is told when it is committed: it may be taken back
    std::vector<StepRecord> waiting_equilibria;
    std::vector<CrackRecord> waiting_cracks;
    std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();

    /// Wall-clock time, also before the state that the run started from (s).
    [[nodiscard]] double elapsed() const;
    [[nodiscard]] const Stage& stage() const { return model.loads.stages[work.stage]; }
    [[nodiscard]] bool is_platen_loaded_by_stress() const;
    /// By pressures, weight or a platen under stress: past its strength the body has nothing to stop it.
    [[nodiscard]] bool is_loaded_by_stress() const;
};

/// What an integrator supplies. All work on the course's work state.
struct LoadSteps {
    std::function<void()> begin_stage;          ///< the loads of the stage are there
    std::function<StepRecord()> initial_record; ///< of the body before any load
    /// Finds the equilibrium at a load factor and returns its record, which lacks step and load factor.
    std::function<StepRecord(double load_factor, bool last_of_stage)> load_step;
    std::function<bool()> chooses_steps;    ///< in this stage: a load step may then end before its load factor
    std::function<void()> reduce_strengths; ///< all load steps of such a stage; throws with the factor of safety
    std::function<void(const StepRecord&)> look_back; ///< after a commit; throws where the run must not go on
    std::function<void()> end_stage;                  ///< calls leave_stage
    std::function<RunCosts()> costs;                  ///< so far
    std::function<FieldRecord()> fields;              ///< of the work state
};

/// Runs the stages of the course to their end, or to what ends them: Interrupted, LostEquilibrium, ResourceError or lack of
/// memory. Whichever it is, the accepted state is that of the last committed load step.
[[nodiscard]] RunReport run_stages(RunCourse& course, const LoadSteps& steps);

/// Makes the work state the accepted one, all or nothing, also out of memory.
void accept(RunCourse& course, const LoadSteps& steps);

/// Makes the work state, which stands at `load_factor` after another load step, the accepted one and tells the observer.
/// `regular`: one of the steps of the stage, and not one between two of them.
void commit_load_step(RunCourse& course, const LoadSteps& steps, StepRecord record, double load_factor,
                      bool last_of_stage, bool regular = true);

/// Tells the observer what was held back.
void tell_waiting(RunCourse& course);

/// Tells the observer of an equilibrium, or where the run stands; `n_solves`: the work done so far.
void notify_equilibrium(RunCourse& course, const StepRecord& record);
void notify_progress(RunCourse& course, double load_factor, int n_solves);

/// The potential cracks and how near to failure they are at displacements q. `bonded`: per interface of the work state;
/// `strengths`: per interface.
[[nodiscard]] std::vector<CrackCandidate> check_cracks(RunCourse& course, CrackCriterion criterion,
                                                       const std::vector<char>& bonded,
                                                       const std::vector<Strength>& strengths, const LoadedBody& body,
                                                       const Eigen::VectorXd& q);

/// Makes potential cracks of the work state fractures in one pass and tells the observer.
void weaken_together(RunCourse& course, const std::vector<CrackCandidate>& broken, double axial_strain);

} // namespace kluft

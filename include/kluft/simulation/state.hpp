// The state of a body: all that changes during a run, and only at commit. A checkpoint is a State.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/blocks/moving_block.hpp"
#include "kluft/contact/contact.hpp"
#include "kluft/loading/platen.hpp"
#include "kluft/simulation/run_costs.hpp"

namespace kluft {

/// What has become of an interface.
enum class InterfaceStatus : std::uint8_t {
    potential_crack, ///< bonded
    fracture,        ///< mapped as a fracture
    tension_crack,   ///< a potential crack broken in tension, now a fracture
    shear_crack      ///< a potential crack broken in shear, now a fracture
};

/// Where a run stands in its loads.
struct LoadPlace {
    int stage = 0;            ///< stage in progress, from 0
    int step_in_stage = 0;    ///< load steps of the stage committed
    int step = 0;             ///< load steps committed in all
    double load_factor = 0.0; ///< of the stage, 0..1

    /// Whether nothing of the stage is committed yet, not even a part of its first load step.
    [[nodiscard]] bool is_at_stage_start() const { return step_in_stage == 0 && load_factor == 0.0; }
};

/// The physics: what the next equilibrium follows from.
struct BodyState {
    Eigen::VectorXd displacement;            ///< (u, D) per block, size 6 n_blocks, m; see kinematics/affine.hpp
    std::vector<InterfaceStatus> interfaces; ///< one per interface
    std::vector<double> bond_shear; ///< shear traction at the two Gauss points of each bond, size 2 n_interfaces, Pa
    std::vector<ContactMemory> contacts;    ///< of touching contact points, sorted by key
    std::vector<PlatenPoint> platen_points; ///< of the stage's platens
    /// On each boundary that the stage holds, the normal force of its platen or support at the last equilibrium (N/m, positive in
    /// compression), else 0: what the next stage begins with.
    std::vector<double> holding_forces;
};

/// What the loads of a stage are counted from.
struct StageStart {
    Eigen::VectorXd displacement;          ///< size 6 n_blocks, m
    std::vector<double> boundary_pressure; ///< one per boundary, Pa
    /// Of a stage that reduces strengths: where the body stands without having slid there, displacement (m), and the largest
    /// strength factor with which it has stood near by (32c).
    Eigen::VectorXd near_place;
    double near_factor = 0.0;
};

/// What makes the next solve cheaper. Without it a run takes longer and its path changes within the tolerances.
struct SolverMemory {
    Eigen::VectorXd
        rate; ///< displacement per unit of load factor of a smooth last step: the predictor; empty without one
    std::vector<std::pair<int, int>> near_pairs; ///< blocks the matrix was ordered for, besides those at interfaces
    /// Contact points that the next load step may keep where blocks have hardly moved, and the load steps taken with
    /// them: only where contacts are not detected in each step.
    std::vector<ContactPoint> kept_points;
    int steps_since_detection = 0;
    Eigen::VectorXd detected_at; ///< displacement at the last detection (m)
};

/// The size of load steps that follow from an accuracy, and the errors made so far.
struct StepControl {
    double size = 0.0;            ///< of the next step, load factor
    double judged_size = 0.0;     ///< of the last step that was judged, load factor
    double judged_error = 0.0;    ///< of its path, relative
    double lag = 0.0;             ///< part of the error in proportion to the size, over the size: it does not add up
    double path_error = 0.0;      ///< sum over the steps so far, relative
    double event_error = 0.0;     ///< largest |f - 1| at an event so far
    double estimated_error = 0.0; ///< both, at the largest stress (so far, where loads are prescribed)
    int missed_events = 0;        ///< in succession: the last steps ended where an event was expected, in vain
    std::vector<int> slipped;     ///< mapped fractures that have slipped, in the order in which they did

    bool operator==(const StepControl&) const = default;
};

/// The stresses so far that errors of the history are relative to.
struct StressHistory {
    double axial = 0.0;         ///< at the last equilibrium (Pa)
    double largest_axial = 0.0; ///< magnitude, of all balanced equilibria (Pa)
    double largest_mean = 0.0;  ///< root of the mean square over the body, where loads are prescribed (Pa)
    int stage_of_largest = -1;  ///< in which the largest axial stress was reached
    /// Of the balanced equilibria of the stage in progress, in the sense of its platen; at least 0 (Pa).
    double largest_in_stage = 0.0;

    bool operator==(const StressHistory&) const = default;
};

/// What a load step has left out of balance.
struct Imbalance {
    int worst_block = -1;            ///< of the last solve; -1 after a balanced load step
    double share = 0.0;              ///< the largest of the mass-like term in F_ref
    std::vector<MovingBlock> moving; ///< at the last equilibrium, the worst first

    bool operator==(const Imbalance&) const = default;
};

/// The largest failure index of potential cracks at the first check of a load step, and the number of that step.
struct CheckedIndex {
    double index = 0.0;
    int step = 0;

    bool operator==(const CheckedIndex&) const = default;
};

/// What a run has to say at its end of the load steps so far.
struct Remarks {
    CheckedIndex largest_checked;
    std::vector<std::string> warnings;

    bool operator==(const Remarks&) const = default;
};

struct State {
    LoadPlace at;
    BodyState body;
    StageStart stage_start;
    Eigen::VectorXd strain_zero; ///< displacement at the start of the first stage that moves a platen (m); empty before
    SolverMemory memory;
    StepControl control;
    StressHistory stresses;
    bool is_settled = true; ///< false: bonds failed here, or the load step did, and no equilibrium has been found since
    int unbalanced_in_succession = 0; ///< load steps
    Imbalance imbalance;              ///< of the last load step: a run that ends with it ends the same when resumed
    int jumps = 0;                    ///< so far
    Remarks remarks;                  ///< so far
    RunCosts costs;                   ///< so far
};

/// Calls visit(name, member) for every member of a state that is saved, by its name in state.h5. `state`: State, const or
/// not.
template <class Members, class Visit> void visit_saved(Members& state, Visit&& visit) {
    visit("stage", state.at.stage);
    visit("step_in_stage", state.at.step_in_stage);
    visit("step", state.at.step);
    visit("load_factor", state.at.load_factor);
    visit("displacement", state.body.displacement);
    visit("interfaces", state.body.interfaces);
    visit("bond_shear", state.body.bond_shear);
    visit("contacts", state.body.contacts);
    visit("platen_points", state.body.platen_points);
    visit("holding_forces", state.body.holding_forces);
    visit("stage_start_displacement", state.stage_start.displacement);
    visit("stage_start_pressure", state.stage_start.boundary_pressure);
    visit("near_place", state.stage_start.near_place);
    visit("near_factor", state.stage_start.near_factor);
    visit("strain_zero", state.strain_zero);
    visit("rate", state.memory.rate);
    visit("near_pairs", state.memory.near_pairs);
    visit("kept_points", state.memory.kept_points);
    visit("steps_since_detection", state.memory.steps_since_detection);
    visit("detected_at", state.memory.detected_at);
    visit("step_size", state.control.size);
    visit("judged_size", state.control.judged_size);
    visit("judged_error", state.control.judged_error);
    visit("step_lag", state.control.lag);
    visit("path_error", state.control.path_error);
    visit("event_error", state.control.event_error);
    visit("estimated_error", state.control.estimated_error);
    visit("missed_events", state.control.missed_events);
    visit("slipped", state.control.slipped);
    visit("axial_stress", state.stresses.axial);
    visit("largest_axial_stress", state.stresses.largest_axial);
    visit("largest_mean_stress", state.stresses.largest_mean);
    visit("stage_of_largest_stress", state.stresses.stage_of_largest);
    visit("largest_axial_stress_in_stage", state.stresses.largest_in_stage);
    visit("is_settled", state.is_settled);
    visit("unbalanced_in_succession", state.unbalanced_in_succession);
    visit("worst_block", state.imbalance.worst_block);
    visit("imbalance", state.imbalance.share);
    visit("moving", state.imbalance.moving);
    visit("jumps", state.jumps);
    visit("checked_index", state.remarks.largest_checked.index);
    visit("checked_step", state.remarks.largest_checked.step);
    visit("warnings", state.remarks.warnings);
    visit("elapsed_s", state.costs.elapsed_s);
    visit("loading_cpu_s", state.costs.loading_cpu_s);
    visit_counts(state.costs, visit);
    visit_seconds(state.costs.seconds, visit);
}

} // namespace kluft

// What a stage does to the outline: pressures, and platens that prescribe displacements.
#pragma once

#include <optional>
#include <vector>

#include "kluft/loading/boundary_loads.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// Mean outward normal of a boundary before loading (unit), and its length (m).
struct BoundaryFrame {
    Vec2 normal = Vec2::Zero();
    double length = 0.0;
};
[[nodiscard]] BoundaryFrame boundary_frame(const BlockSystem& system, int boundary);

/// The boundary whose normal is most opposite to that of `boundary`; -1 if none faces the other way.
[[nodiscard]] int opposite_boundary(const BlockSystem& system, int boundary);

/// Mean position of a boundary before loading, local coordinates (m).
[[nodiscard]] Vec2 mean_position(const BlockSystem& system, int boundary);

/// Mean displacement of a boundary, weighted by length (m).
[[nodiscard]] Vec2 mean_displacement(const BlockSystem& system, const Eigen::VectorXd& q, int boundary);

/// The two boundaries across `boundary`, on the side of its normal turned clockwise first; empty if there are not two.
[[nodiscard]] std::vector<int> lateral_boundaries(const BlockSystem& system, int boundary);

/// The mean width between the lateral boundaries, for a platen on `boundary`: its length where there are none.
[[nodiscard]] PlatenForce width_across(const BlockSystem& system, int boundary);

/// The loads of one stage as functions of the load factor.
class StageLoads {
public:
    StageLoads(const Model& model, const State& stage_start, const Stage& stage);

    /// Pressure per boundary at a load factor (Pa); 0 on boundaries that platens hold.
    [[nodiscard]] std::vector<double> pressures(double load_factor) const;
    /// The prescribed displacements; targets are those of load factor 0.
    [[nodiscard]] const Constraints& constraints() const { return constraints_; }
    /// Sets the targets of a load factor.
    void set_targets(Constraints& constraints, double load_factor) const;
    /// The force on a platen that is loaded by stress.
    [[nodiscard]] std::optional<PlatenForce> platen_force(double load_factor) const;
    [[nodiscard]] bool is_held(int boundary) const { return held_[boundary] != 0; }
    /// The first prescribed displacement that contradicts others of its block over the stage; null if there is none.
    [[nodiscard]] const PrescribedDisplacement* contradicting_row() const;
    /// Boundaries under pressure at any time of the stage.
    [[nodiscard]] const std::vector<PressureEdge>& edges() const { return edges_; }

private:
    std::vector<double> start_pressure_, end_pressure_;
    std::vector<char> held_;
    std::vector<PressureEdge> edges_;
    Constraints constraints_;
    std::vector<double> start_targets_, target_rates_;
    std::optional<PlatenForce> platen_force_;
    double start_platen_stress_ = 0.0;
    double end_platen_stress_ = 0.0;
};

/// Throws InputError if a stage moves a platen against a support: where both have vertices of one block that no motion of
/// it can follow. Supports that only hold cannot contradict each other.
void refuse_contradicting_supports(const Model& model);

/// The loads of the state's stage. At its start the state remembers the displacements that it started from.
[[nodiscard]] StageLoads enter_stage(const Model& model, State& state);

/// Goes on to the next stage, with the pressures of the end of this one; on a boundary that was held it is the mean
/// normal stress. `forces` = internal - external forces without the supports'.
void leave_stage(const Model& model, const StageLoads& loads, const LoadedBody& body, const Eigen::VectorXd& forces,
                 State& state);

/// Sets pressures, platens, point forces and weight of a load factor. The weight grows in the first stage and in those
/// that have a gravity.
void apply_load(const Model& model, const StageLoads& loads, int stage, double load_factor, LoadedBody& body);

/// Mean normal stress on a boundary: its pressure, or the support's reaction over the current length (Pa).
/// `forces` = internal - external forces without the supports'.
[[nodiscard]] double boundary_stress(const LoadedBody& body, const Eigen::VectorXd& forces, int boundary, bool held,
                                     double current_length, const Vec2& normal);

} // namespace kluft

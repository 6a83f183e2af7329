// What a stage does to the body as a function of the load factor: pressures, weight, forces, platens, strengths.
#pragma once

#include <optional>
#include <vector>

#include "kluft/constitutive/interface_law.hpp"
#include "kluft/loading/boundary_loads.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// Of the body as it was cut, without pressures.
[[nodiscard]] StageStart start_at_rest(const BlockSystem& system);

/// The loads of one stage as functions of the load factor.
class StageLoads {
public:
    StageLoads(const Model& model, const StageStart& start, const Stage& stage);

    /// Pressure per boundary at a load factor (Pa); 0 on boundaries that platens hold.
    [[nodiscard]] std::vector<double> pressures(double load_factor) const;
    /// The prescribed displacements with all points of the platens touching; targets are those of load factor 0.
    [[nodiscard]] const Constraints& constraints() const { return constraints_; }
    /// The platen that is moved and the one opposite to it; none in a stage without a motion.
    [[nodiscard]] const std::vector<Platen>& platens() const { return platens_; }
    /// Those that the platens are laid on at the start of the stage: all of their boundaries, touching.
    [[nodiscard]] const std::vector<PlatenPoint>& platen_points() const { return platen_points_; }
    /// Puts the faces of the platens where their points are at the start of the stage.
    void place_platens(const BlockSystem& system, const std::vector<PlatenPoint>& points);
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
    std::vector<Platen> platens_;
    std::vector<PlatenPoint> platen_points_;
    std::optional<PlatenForce> platen_force_;
    double start_platen_stress_ = 0.0;
    double end_platen_stress_ = 0.0;
};

/// Throws InputError if a stage moves a platen against a support: where both have vertices of one block that no motion of
/// it can follow. Supports that only hold cannot contradict each other.
void refuse_contradicting_supports(const Model& model);

/// What the platens hold the body by: their points, the prescribed displacements (supports' too) and the friction that
/// follow from them.
struct PlatenHold {
    std::vector<PlatenPoint> points;
    Constraints constraints;
    std::vector<PointLoad> friction;
};
/// By the points of the state.
[[nodiscard]] PlatenHold hold_of(const Model& model, const StageLoads& stage_loads, const BodyState& state);

/// The loads at a load factor, and the strengths of the interfaces under them. A LoadedBody refers to `loads` and `laws`.
struct LoadsAt {
    Loads loads;
    std::vector<InterfaceLaw> laws; ///< per interface type and kind of broken edge, reduced by `strength_factor`
    double load_factor = 0.0;
    double strength_factor = 1.0; ///< F that strengths are divided by
    double carried_stress = 0.0;  ///< of LoadedBody
};
/// Whether anything but a platen that is moved and what it is held with loads the body.
[[nodiscard]] bool has_given_loads(const Model& model, const Loads& loads);
[[nodiscard]] LoadsAt loads_at(const Model& model, const StageLoads& stage_loads, const PlatenHold& hold, int stage,
                               double load_factor);

/// Sets all loads of a load factor but the rows of the constraints and the edges under pressure, which are the stage's.
/// The weight grows in the first stage and in those that have a gravity.
void move_loads(const Model& model, const StageLoads& stage_loads, int stage, double load_factor, Loads& loads);

/// The loads of the state's stage. At its start the state remembers the displacements that it started from, and platens are
/// laid on the body.
[[nodiscard]] StageLoads enter_stage(const Model& model, State& state);

/// Goes on to the next stage, with the pressures of the end of this one; on a boundary that was held it is the one with the
/// normal force of its platen or support, over the current mean width. `loads` are those at the end of the stage.
void leave_stage(const Model& model, const StageLoads& stage_loads, const Loads& loads, State& state);

/// Those of a state's body, under the loads of one of its stage: `forces` = internal - external forces without the supports'.
[[nodiscard]] std::vector<double> holding_forces(const Model& model, const StageLoads& stage_loads, const Loads& loads,
                                                 const Eigen::VectorXd& forces);

/// Normal force of the platen or support that holds a boundary (N/m, positive in compression). `forces` = internal - external
/// forces without the supports'.
[[nodiscard]] double holding_force(const BlockSystem& system, const Loads& loads, const Eigen::VectorXd& forces,
                                   int boundary);

} // namespace kluft

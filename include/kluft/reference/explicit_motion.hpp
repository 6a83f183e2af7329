// The motion of a body by central differences with local damping (Cundall 1971, 1987; docs/theory.md):
// M dv/dt = f - alpha |f| sign(v), f = external - internal forces.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// Where the work of the loads has gone, per metre of thickness (J/m).
struct EnergyBalance {
    double external_work = 0.0; ///< of pressures, weight, point loads, supports and platens
    double block_energy = 0.0;  ///< elastic
    double spring_energy = 0.0; ///< elastic, of bonds and contacts
    double kinetic_energy = 0.0;
    double friction_energy = 0.0; ///< lost by slip and dilation
    double damping_energy = 0.0;
    double crack_energy = 0.0;     ///< lost when bonds broke
    double detection_energy = 0.0; ///< lost by springs (gained where negative) when contacts were detected anew

    [[nodiscard]] double strain_energy() const { return block_energy + spring_energy; }
    /// External work less all that it has become, over the largest of the terms.
    [[nodiscard]] double error() const;
};

/// Displacements, velocities and the energies spent. Prescribed displacements hold exactly: the blocks move in the null
/// space of their rows, with inertia. A contact keeps its history at every time step.
class ExplicitMotion {
public:
    /// At rest at q. `masses`: one per block (kg/m). Placement and loads of `body` itself are not looked at.
    ExplicitMotion(const LoadedBody& body, Placement placement, Loads loads, std::vector<Mat6> masses, double damping,
                   Eigen::VectorXd q);
    ExplicitMotion(const ExplicitMotion&) = delete; // the body refers to the placement and the loads
    ExplicitMotion& operator=(const ExplicitMotion&) = delete;
    ~ExplicitMotion() = default;

    [[nodiscard]] const LoadedBody& body() const { return body_; }
    /// All but the rows of the constraints may be changed between time steps.
    [[nodiscard]] Loads& loads() { return loads_; }
    [[nodiscard]] Placement& placement() { return placement_; }
    /// Lets points leave the platens, touch, stick and slide as they are at the moment.
    void update_platens();
    /// To be called after the rows of the constraints or the points of bonds and contacts were replaced.
    void restart();
    /// A bond broke: `energy` is what its springs lost (J/m).
    void add_crack_energy(double energy) { spent_.crack_energy += energy; }
    /// Springs lost `energy` when contacts were detected anew: overlaps changed, pairs came and went (J/m).
    void add_detection_energy(double energy) { spent_.detection_energy += energy; }
    /// Elastic energy of bonds and contacts at the displacements reached (J/m).
    [[nodiscard]] double springs_energy() const;

    /// One time step with the loads of the body.
    void advance();

    [[nodiscard]] const Eigen::VectorXd& displacement() const { return q_; }
    [[nodiscard]] const Eigen::VectorXd& velocity() const { return velocity_; } ///< half a time step before (m/s)
    [[nodiscard]] double time_step() const { return time_step_; }               ///< s
    /// Norm of the forces that accelerate the body in its free directions at the last time step (N/m).
    [[nodiscard]] double unbalanced_force() const { return unbalanced_; }

    /// Internal - external forces at the displacements reached, without the supports'; keeps the contact histories.
    const BodyForces& evaluate();
    /// At the displacements reached; evaluates.
    [[nodiscard]] EnergyBalance energies();

private:
    struct HeldBlock {
        int block = 0;
        Mat6 projector;
        Mat6 mobility;  ///< pseudo-inverse of P M P: acceleration by force
        Mat6 free_part; ///< mobility M: of a velocity
        Vec6 travel;    ///< motion for unit travel of the platen, without free part; zero for others
    };
    struct Kept {
        double normal = 0.0;
        double shear = 0.0;
        double dilation = 0.0;
    };

    void hold_blocks();
    void keep_histories();
    void accelerate_free_blocks(double interval);
    void accelerate_held_blocks(double interval);

    Placement placement_; ///< with the histories of the last time step
    Loads loads_;
    LoadedBody body_;
    std::vector<Mat6> masses_, inverse_masses_;
    double damping_;
    Eigen::VectorXd q_, velocity_;
    std::vector<char> held_;       ///< per block
    std::vector<HeldBlock> holds_; ///< blocks with prescribed displacements
    double travel_mass_ = 0.0;     ///< of what a platen moves that is loaded by stress (kg/m)
    double travel_velocity_ = 0.0; ///< m/s
    std::vector<Kept> kept_;       ///< per contact, of the last time step
    std::vector<PointTraction> tractions_;
    BodyForces forces_, magnitudes_;
    Eigen::VectorXd external_, damping_force_, increment_, correction_;
    double time_step_ = 0.0;
    double last_time_step_ = 0.0; ///< of the velocity
    double unbalanced_ = 0.0;
    EnergyBalance spent_; ///< external work and what was lost
};

} // namespace kluft

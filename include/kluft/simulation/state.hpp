// The state of a body: all that changes during a run, and only at commit. A checkpoint is a State.
#pragma once

#include <compare>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "kluft/contact/contact.hpp"
#include "kluft/simulation/run_costs.hpp"

namespace kluft {

/// What has become of an interface.
enum class InterfaceStatus : std::uint8_t {
    potential_crack, ///< bonded
    fracture,        ///< mapped as a fracture
    tension_crack,   ///< a potential crack broken in tension, now a fracture
    shear_crack      ///< a potential crack broken in shear, now a fracture
};

/// Of runs whose load steps follow from an accuracy.
struct StepControl {
    double size = 0.0;           ///< of the next step, load factor
    double curvature = 0.0;      ///< path error of the last step that was judged, over the square of its size
    double lag = 0.0;            ///< part of the error in proportion to the size, over the size: it does not add up
    double axial_stress = 0.0;   ///< of the last equilibrium (Pa)
    double largest_stress = 0.0; ///< axial, of all equilibria so far (Pa)
    double largest_mean_stress = 0.0; ///< root of the mean square over the body, where loads are prescribed (Pa)
    double path_error = 0.0;          ///< sum over the steps so far, relative
    double event_error = 0.0;         ///< largest |f - 1| at an event so far
    double estimated_error = 0.0;     ///< both, at the largest stress (so far, where loads are prescribed)
    int stage_of_largest = -1;        ///< in which the largest stress was reached
    int missed_events = 0;            ///< in succession: the last steps ended where an event was expected, in vain
    std::vector<int> slipped;         ///< mapped fractures that have slipped, in the order in which they did

    bool operator==(const StepControl&) const = default;
};

struct State {
    int stage = 0;                            ///< stage in progress, from 0
    int step_in_stage = 0;                    ///< load steps accepted in it
    int step = 0;                             ///< load steps accepted in all
    double load_factor = 0.0;                 ///< of the stage, 0..1
    Eigen::VectorXd displacement;             ///< (u, D) per block, size 6 n_blocks, m; see kinematics/affine.hpp
    Eigen::VectorXd stage_start_displacement; ///< the same at the start of the stage
    Eigen::VectorXd
        reference_displacement; ///< at the start of the first stage that moves a platen: zero of the strains
    bool reference_set = false;
    std::vector<InterfaceStatus> interfaces; ///< one per interface
    std::vector<double> bond_shear; ///< shear traction at the two Gauss points of each bond, size 2 n_interfaces, Pa
    std::vector<ContactMemory> contacts;   ///< of touching contact points, sorted by key
    std::vector<double> boundary_pressure; ///< at the start of the stage, one per boundary, Pa
    double unbalanced_ratio = 0.0;
    int unbalanced_in_succession = 0;
    Eigen::VectorXd displacement_rate; ///< per unit of load factor, of a smooth last step; empty without one
    std::vector<double>
        viscosity_factor; ///< factor of the mass-like term per block since the last relaxation; empty: 1 everywhere
    std::vector<std::pair<int, int>>
        near_pairs; ///< blocks that the matrix was ordered for, besides those at interfaces
    StepControl control;
    RunCosts costs; ///< so far
};

} // namespace kluft

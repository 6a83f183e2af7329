// One load step as a minimisation, and the iteration on what is not conservative around it. Takes contact points, bonds,
// histories and loads from a LoadedBody and nothing else of the library but its plain values.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"
#include "oracle/potential.hpp"

namespace kluft::oracle {

/// What a minimisation holds fixed: it has no potential.
struct Lagged {
    std::vector<double> slip_limits;   ///< per contact: largest shear force (N/m); 0: none, infinity: sticks
    std::vector<Vec2> pressure_forces; ///< per pressure edge (N/m)
};

struct PosedMinimum {
    Potential potential;
    std::vector<int> closures; ///< per contact: the unknown z
    std::vector<int> slips;    ///< per contact: the unknown p+, followed by p-; -1 without
};

/// Unknowns: the change of (u, D) of the blocks since `start`, then z of the contacts, then p+ and p-.
/// Throws std::invalid_argument for what the formulation lacks: rounded laws, dilation, platens loaded by stress.
[[nodiscard]] PosedMinimum pose_minimum(const LoadedBody& body, const Eigen::VectorXd& start, const Lagged& lagged);

/// The unknowns of a minimisation at displacements q, with the z, p+ and p- that have the least energy there.
[[nodiscard]] Eigen::VectorXd closest_unknowns(const PosedMinimum& posed, const LoadedBody& body, const Lagged& lagged,
                                               const Eigen::VectorXd& start, const Eigen::VectorXd& q);

/// Largest shear force of each contact under given normal forces, with the cohesion of the closed part of its piece of the
/// overlap at q: Coulomb with the onset of cohesion, eq. (8) (N/m).
[[nodiscard]] std::vector<double> coulomb_limits(const LoadedBody& body, const std::vector<double>& normal_forces,
                                                 const Eigen::VectorXd& q);

/// Closing k_n w max(0, -gap) of the contacts at q (N/m).
[[nodiscard]] std::vector<double> normal_forces_at(const LoadedBody& body, const Eigen::VectorXd& q);

/// Forces of the pressures on the edges as they are at q (N/m).
[[nodiscard]] std::vector<Vec2> pressure_forces_at(const LoadedBody& body, const Eigen::VectorXd& q);

struct OracleSolution {
    Eigen::VectorXd q;                 ///< size 6 n_blocks (m)
    std::vector<double> normal_forces; ///< per contact, compression positive: the multipliers (N/m)
    std::vector<double> shear_forces;  ///< per contact (N/m)
    double energy = 0.0;               ///< of the last minimisation (J/m)
    double work_of_slip = 0.0;         ///< the part of it that friction takes (J/m)
    double missed_condition = 0.0;     ///< largest error of all prescribed displacements (m)
    int n_unknowns = 0;                ///< of the last minimisation
    int ipopt_iterations = 0;          ///< of all
    int outer_iterations = 0;
    double last_change = 0.0; ///< of the normal forces, relative to the largest
    bool converged = false;
    std::string diagnosis;
};

[[nodiscard]] OracleSolution solve_by_minimisation(const LoadedBody& body, const Eigen::VectorXd& start);

} // namespace kluft::oracle

// Strains, stresses and counts of an equilibrium, as rock engineers read them: positive in compression.
#pragma once

#include <array>
#include <vector>

#include "kluft/fracture/crack_check.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The boundaries that strains and stresses are measured on.
struct Gauges {
    int moved = -1; ///< boundary of the first platen that moves; the upper one without any
    int opposite = -1;
    std::array<Side, 2> lateral;       ///< the boundaries across; empty if there are not two sides
    Vec2 axial_normal = Vec2::UnitY(); ///< outward normal of `moved`
    Vec2 lateral_normal = Vec2::UnitX();
    double length = 0.0;         ///< distance of moved and opposite boundary before loading (m)
    double width = 0.0;          ///< distance of the lateral boundaries before loading (m)
    double pressed_share = 1.0;  ///< axial stress per pressure on the moved boundary, as cut; 1 without any platen
    int first_platen_stage = -1; ///< first stage that moves a platen; -1 without one
    /// Interfaces of the net that are potential cracks and have their middle in the middle half of the body along
    /// `axial_normal`, before loading. None where the net does not fill that half.
    std::vector<int> middle_bonds;
};
[[nodiscard]] Gauges make_gauges(const Model& model);

/// Strains since `reference` (m): axial and lateral, positive in compression.
struct Strains {
    double axial = 0.0;
    double lateral = 0.0;
};
/// Between displacements `reference` (empty: the body as it was cut) and q. A boundary with a platen, of which the loads
/// know, moves with its face, any other one by its mean displacement.
[[nodiscard]] Strains measure_strains(const Model& model, const Gauges& gauges, const Loads& loads,
                                      const Eigen::VectorXd& q, const Eigen::VectorXd& reference);

/// The worse of two contact states, to name an interface by its worst point: open, then locked, then sliding.
[[nodiscard]] ContactState worse(ContactState a, ContactState b);

/// Contact states by interface and further touching pairs, each counted once by its worst point.
struct ContactCounts {
    int open = 0;
    int sliding = 0;
    int locked = 0;
};
[[nodiscard]] ContactCounts count_contacts(const Model& model, const State& state, const LoadedBody& body,
                                           const Eigen::VectorXd& q);

/// Of a bond, mean of its points (Pa).
[[nodiscard]] InterfaceTraction mean_traction(const std::vector<InterfaceLaw>& laws, const Bond& bond,
                                              const Eigen::VectorXd& q);

/// Tractions of the bonded interfaces, mean of their points (Pa); zero for the others.
[[nodiscard]] std::vector<InterfaceTraction> bond_tractions(const Model& model, const LoadedBody& body,
                                                            const Eigen::VectorXd& q);

/// Strains, stresses, cracks and contact states at displacements q of the load step in progress. `forces` = internal -
/// external forces without the supports'.
[[nodiscard]] StepRecord measure_step(const Model& model, const Gauges& gauges, const State& state,
                                      const LoadedBody& body, const StageLoads& loads, const Eigen::VectorXd& q,
                                      const Eigen::VectorXd& forces);

} // namespace kluft

#include "kluft/simulation/released_energy.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "kluft/loading/stored_energy.hpp"
#include "kluft/simulation/mass_term.hpp"
#include "kluft/simulation/placement.hpp"

namespace kluft {

namespace {

/// Internal forces less loads, those of supports and platens not taken out (N/m).
Eigen::VectorXd forces_at(const StepInProgress& p, const PlacedState& placed, const LoadsAt& at,
                          const Eigen::VectorXd& q) {
    return p.bench.search.forces({loaded_body(p.bench.model, placed.placement, at), {}, 0.0, {}}, q);
}

/// By the trapezoidal rule, which is exact for forces that are linear on the way.
double work_of_loads(const LoadedBody& body, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    Eigen::VectorXd before, after;
    external_forces(body, from, before);
    external_forces(body, to, after);
    return 0.5 * (before + after).dot(to - from);
}

} // namespace

MotionEnergy energy_at_start(const StepInProgress& p, const PlacedState& placed, const LoadsAt& at) {
    MotionEnergy energy;
    energy.available = stored_energy(loaded_body(p.bench.model, placed.placement, at), p.displacement());
    return energy;
}

Eigen::VectorXd driving_forces(const BlockSystem& system, const Eigen::VectorXd& velocity) {
    Eigen::VectorXd forces(velocity.size());
    for (int b = 0; b < system.n_blocks(); ++b) {
        const auto rows = Eigen::seqN(n_block_unknowns * b, n_block_unknowns);
        forces(rows) = mass_product(system.blocks[b], 0.0, velocity(rows));
    }
    return forces;
}

void add_motion(const StepInProgress& p, const PlacedState& placed, const LoadsAt& at, const Eigen::VectorXd& end,
                Eigen::VectorXd driving, MotionEnergy& energy) {
    energy.available += work_of_loads(loaded_body(p.bench.model, placed.placement, at), p.displacement(), end);
    const bool changed = energy.driving.size() == 0;
    energy.by_forces += 0.5 * ((changed ? driving : energy.driving) + driving).dot(end - p.displacement());
    energy.driving = std::move(driving);
}

double work_of_platens(const StepInProgress& p, const PlacedState& placed) {
    const LoadsAt at = p.loads_at(p.load_factor());
    const Constraints& constraints = at.loads.constraints;
    const std::vector<double> held = constraints.row_forces(forces_at(p, placed, at, p.displacement()));
    double work = 0.0;
    for (std::size_t i = 0; i < held.size(); ++i) work += held[i] * constraints.rows()[i].velocity;
    return work;
}

void add_platen_motion(const StepInProgress& p, const PlacedState& placed, const LoadsAt& after,
                       const Eigen::VectorXd& end, double work, MotionEnergy& energy) {
    const Eigen::VectorXd sum =
        forces_at(p, placed, after, p.displacement()) + forces_at(p, placed, after, end); // internal - external
    energy.by_forces += work - 0.5 * sum.dot(end - p.displacement());
    energy.available +=
        work + work_of_loads(loaded_body(p.bench.model, placed.placement, after), p.displacement(), end);
}

double released_energy(const StepInProgress& p, const PlacedState& placed, const LoadsAt& at,
                       const Eigen::VectorXd& end, const MotionEnergy& energy) {
    if (at.loads.platen_force) return energy.by_forces;
    const double stored = stored_energy(loaded_body(p.bench.model, placed.placement, at), end);
    return std::max(0.0, std::min(energy.by_forces, energy.available - stored));
}

} // namespace kluft

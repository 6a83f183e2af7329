#include "body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kluft/equilibrium/boundary_terms.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/simulation.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft::bench {

namespace {

constexpr double growth = 1e-3; ///< of every block: far more than the rounding of the contact law
constexpr double viscosity = 0.05;

/// Every block grown about its own centroid.
Eigen::VectorXd grown(const BlockSystem& system) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * system.n_blocks());
    for (int b = 0; b < system.n_blocks(); ++b) {
        q[n_block_unknowns * b + 2] = growth * system.blocks[b].size;
        q[n_block_unknowns * b + 5] = growth * system.blocks[b].size;
    }
    return q;
}

State state_of(const Model& model, Joining joining, const Eigen::VectorXd& displacement) {
    State state = initial_state(model);
    state.body.displacement = displacement;
    if (joining == Joining::fractured) std::ranges::fill(state.body.interfaces, InterfaceStatus::shear_crack);
    return state;
}

BlockPattern pattern_of(const BlockSystem& system, std::vector<std::pair<int, int>> pairs) {
    for (const Interface& interface : system.interfaces) pairs.emplace_back(interface.block_a, interface.block_b);
    return {system.n_blocks(), pairs};
}

double mean_diagonal(const BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    double sum = 0.0;
    for (int b = 0; b < pattern.n_blocks(); ++b) sum += matrix.values[pattern.find(b, b)].trace();
    return sum / (n_block_unknowns * pattern.n_blocks());
}

} // namespace

Body::Body(const Model& model, Joining joining) : model_(&model), displacement_(grown(model.system)) {
    const BlockSystem& system = model.system;
    State state = state_of(model, joining, displacement_);
    placement_.bonds = placed_bonds(model, state.body);
    DetectedContacts contacts = detected_contacts(model, state.body, true);
    placement_.contacts = std::move(contacts.points);
    pattern_ = pattern_of(system, std::move(contacts.near_pairs));

    const int last = static_cast<int>(model.loads.stages.size()) - 1;
    const StageLoads stage_loads(model, state.stage_start, model.loads.stages.back());
    state.body.platen_points = stage_loads.platen_points(); // all of them touch
    at_ = loads_at(model, stage_loads, hold_of(model, stage_loads, state.body), last, 1.0);
    problem_.body = loaded_body(model, placement_, at_);
    problem_.start = displacement_;
    problem_.least_mass_area = std::sqrt(0.75) * system.spacing * system.spacing;
    const double height = (system.upper - system.lower).maxCoeff();
    problem_.eta.assign(system.blocks.size(), viscosity * model.effective_modulus / (height * height));
}

void Body::stiffness(EquilibriumEvaluator& evaluator, BlockMatrix& matrix) const {
    evaluator.tangent(displacement_, TangentKind::symmetric, matrix);
    project(at_.loads.constraints, matrix, mean_diagonal(matrix));
}

Eigen::VectorXd Body::load() const {
    Eigen::VectorXd forces(displacement_.size());
    for (Eigen::Index i = 0; i < forces.size(); ++i) forces[i] = 1.0 + std::sin(0.7 * static_cast<double>(i));
    at_.loads.constraints.project(forces);
    return forces;
}

Model read_model(const std::filesystem::path& scene, const std::vector<std::string>& overrides) {
    return build_scene_model(read_scene(scene, overrides)).model;
}

} // namespace kluft::bench

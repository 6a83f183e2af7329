#include "kluft/simulation/overloaded_bonds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

/// Bonds of a net, and of a trace through it, lie between cells as small as mean stresses want them.
bool is_of_large_blocks(const BlockSystem& system, bool has_net, const Interface& interface) {
    if (interface.origin == EdgeOrigin::tessellation) return false;
    if (interface.origin == EdgeOrigin::given || !has_net) return true;
    return std::ranges::any_of(std::array{interface.block_a, interface.block_b},
                               [&](int b) { return !is_cell_of_net(system, system.blocks[b]); });
}

} // namespace

double load_over_strength(double normal_traction, double shear_traction, const Strength& strength) {
    const double tensile_strength = capped(strength).strength.tensile_strength;
    const double tension = tensile_strength > 0.0 ? normal_traction / tensile_strength : 0.0;
    const double shear_strength = strength.cohesion - normal_traction * std::tan(strength.friction_angle);
    const double shear = shear_strength > 0.0 ? std::abs(shear_traction) / shear_strength : 0.0;
    return std::max(tension, shear);
}

std::vector<int> bonds_of_large_blocks(const Model& model) {
    const std::vector<Interface>& interfaces = model.system.interfaces;
    const bool has_net =
        std::ranges::any_of(interfaces, [](const Interface& each) { return each.origin == EdgeOrigin::tessellation; });
    std::vector<int> bonds;
    for (int i = 0; i < model.system.n_interfaces(); ++i)
        if (model.bonds[interfaces[i].interface_type] && is_of_large_blocks(model.system, has_net, interfaces[i]))
            bonds.push_back(i);
    return bonds;
}

BondWatch::BondWatch(const Model& model, CrackCriterion criterion) : model_(model) {
    if (criterion == CrackCriterion::principal_stress && model.has_potential_cracks)
        interfaces_ = bonds_of_large_blocks(model);
}

void BondWatch::step(const StepRecord& record, const State& state) {
    if (interfaces_.empty() || !record.balanced) return;
    const double factor = strength_factor(model_.loads, record.stage, record.load_factor);
    const std::vector<Strength> strengths = reduced_strengths(model_, record.stage, factor);
    for (const int i : interfaces_) {
        if (state.body.interfaces[i] != InterfaceStatus::potential_crack) continue;
        const Eigen::VectorXd& q = state.body.displacement;
        const Bond bond = bond_at(model_.system, i, q, &state.body.bond_shear[n_bond_points * i]);
        const auto [normal, shear] = mean_traction(model_.laws, bond, q);
        const double load = load_over_strength(normal, shear, strengths[i]);
        if (load > worst_.load) worst_ = {i, record.step, load, normal, shear};
    }
}

std::string BondWatch::warning() const {
    if (worst_.load <= clear_overload) return {};
    const BlockSystem& system = model_.system;
    const Interface& interface = system.interfaces[worst_.interface];
    const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
    const Vec2 middle = system.origin + 0.5 * (edge_start(system, edge) + edge_end(system, edge));
    return fmt::format(
        "the bond of blocks {} and {} at {} carries {:.3g} times its strength, by its own traction (in load step "
        "{}: {:.3g} MPa of shear, {:.3g} MPa of {}). With cracks.criterion: principal_stress it fails by the "
        "mean stress of these two blocks, which says little of a bond between blocks that are no cells of a "
        "net: strengths and factors of safety come out too high. cracks.criterion: interface_traction judges "
        "the bond itself",
        block_label(system, interface.block_a), block_label(system, interface.block_b), place_text(middle), worst_.load,
        worst_.step, 1e-6 * std::abs(worst_.shear), 1e-6 * std::abs(worst_.normal),
        worst_.normal > 0.0 ? "tension" : "pressure");
}

} // namespace kluft

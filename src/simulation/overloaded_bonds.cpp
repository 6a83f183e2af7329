#include "kluft/simulation/overloaded_bonds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/fracture/crack_check.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/state_fields.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

constexpr double clear_overload = 1.1; ///< of the strength: an event is met to less
constexpr double largest_cell = 2.0;   ///< in spacings of the net

/// A net's own bonds, and those of a trace through it, are many to a crack, between blocks that its size is chosen for.
bool is_of_large_blocks(const BlockSystem& system, bool has_net, const Interface& interface) {
    if (interface.origin == EdgeOrigin::tessellation) return false;
    if (interface.origin == EdgeOrigin::given || !has_net) return true;
    return std::ranges::any_of(std::array{interface.block_a, interface.block_b},
                               [&](int b) { return spacing_of(system.blocks[b]) > largest_cell * system.spacing; });
}

} // namespace

BondWatch::BondWatch(const Model& model, CrackCriterion criterion) : model_(model) {
    if (criterion != CrackCriterion::principal_stress || !model.has_potential_cracks) return;
    const std::vector<Interface>& interfaces = model.system.interfaces;
    const bool has_net =
        std::ranges::any_of(interfaces, [](const Interface& each) { return each.origin == EdgeOrigin::tessellation; });
    for (int i = 0; i < model.system.n_interfaces(); ++i)
        if (model.bonds[interfaces[i].interface_type] && is_of_large_blocks(model.system, has_net, interfaces[i]))
            interfaces_.push_back(i);
}

void BondWatch::step(const StepRecord& record, const State& state) {
    if (interfaces_.empty() || !record.balanced) return;
    const double factor = strength_factor(model_.loads, record.stage, record.load_factor);
    const std::vector<Strength> strengths = reduced_strengths(model_, record.stage, factor);
    with_body_of_state(model_, state, [&](const LoadedBody& body) {
        const auto tractions = bond_tractions(model_, body, state.body.displacement);
        for (const int i : interfaces_) {
            if (state.body.interfaces[i] != InterfaceStatus::potential_crack) continue;
            const auto [normal, shear] = tractions[i];
            const double index = failure_index_traction(normal, shear, strengths[i]).f;
            if (index > worst_.index) worst_ = {i, record.step, index, normal, shear};
        }
    });
}

std::string BondWatch::warning() const {
    if (worst_.index <= clear_overload) return {};
    const BlockSystem& system = model_.system;
    const Interface& interface = system.interfaces[worst_.interface];
    const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
    const Vec2 middle = system.origin + 0.5 * (edge_start(system, edge) + edge_end(system, edge));
    return fmt::format(
        "the bond of blocks {} and {} at {} carries {} times what its own traction allows (in load step {}: {:.3g} MPa "
        "of "
        "shear, {:.3g} MPa of {}). With cracks.criterion: principal_stress it fails by the mean stress of these two "
        "blocks, "
        "which says little of a bond between blocks that are no cells of a net: strengths and factors of safety come "
        "out too "
        "high. cracks.criterion: interface_traction judges the bond itself",
        block_label(system, interface.block_a), block_label(system, interface.block_b), place_text(middle),
        std::isfinite(worst_.index) ? fmt::format("{:.3g}", worst_.index) : std::string("many"), worst_.step,
        1e-6 * std::abs(worst_.shear), 1e-6 * std::abs(worst_.normal), worst_.normal > 0.0 ? "tension" : "pressure");
}

} // namespace kluft

#include "kluft/simulation/contact_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double plausible_ratio = 100.0; ///< of a contact's stress to the applied one

/// Sums over the contact points of two blocks.
struct PressedPair {
    double force = 0.0; ///< N/m
    double length = 0.0;
    Vec2 moment = Vec2::Zero(); ///< of the length (m2)
};

} // namespace

PressedContact largest_contact_pressure(const Model& model, const State& state) {
    const Eigen::VectorXd& q = state.body.displacement;
    std::map<std::pair<int, int>, PressedPair> pairs;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const auto& points = body.placement->contacts;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const ContactPoint& point = points[i];
            PressedPair& pair = pairs[std::minmax(point.block_a, point.block_b)];
            pair.force -= point.weight * contact_traction(body, static_cast<int>(i), q).normal;
            pair.length += point.weight;
            pair.moment += point.weight * current_position(model.system, q, point.block_a, point.xi_a);
        }
    });
    PressedContact largest;
    for (const auto& [blocks, pair] : pairs) {
        if (!(pair.length > 0.0) || !(pair.force / pair.length > largest.value)) continue;
        largest = {pair.force / pair.length, blocks.first, blocks.second,
                   model.system.origin + pair.moment / pair.length};
    }
    return largest;
}

double largest_applied_stress(const Model& model, const State& state) {
    const Vec2 extent = model.system.upper - model.system.lower;
    const double density =
        model.densities.empty() ? 0.0 : *std::max_element(model.densities.begin(), model.densities.end());
    double largest = density * model.gravity.norm() * extent.maxCoeff();
    for (int s = 0; s <= state.at.stage && s < static_cast<int>(model.loads.stages.size()); ++s) {
        const Stage& stage = model.loads.stages[s];
        for (const auto& [boundary, pressure] : stage.pressure) largest = std::max(largest, std::abs(pressure));
        for (const auto& [index, force] : stage.forces) largest = std::max(largest, force.norm() / extent.minCoeff());
        if (stage.gravity) largest = std::max(largest, density * stage.gravity->norm() * extent.maxCoeff());
        if (is_platen_loaded_by_stress(stage)) largest = std::max(largest, std::abs(stage.motion->value));
    }
    return largest;
}

std::string contact_pressure_warning(const Model& model, const State& state, double measured) {
    const double applied = std::max({largest_applied_stress(model, state), measured, state.stresses.largest_axial});
    const PressedContact found = largest_contact_pressure(model, state);
    if (!(applied > 0.0) || !(found.value > plausible_ratio * applied)) return {};
    return fmt::format(
        "the contact of blocks {} and {} at about {} is pressed with {:.3g} MPa, {:.0f} "
        "times the largest stress that is applied ({:.3g} MPa): look whether these blocks overlap or are "
        "wedged, or whether a load or a stiffness has a wrong unit",
        block_label(model.system, found.block_a), block_label(model.system, found.block_b), place_text(found.place),
        1e-6 * found.value, found.value / applied, 1e-6 * applied);
}

} // namespace kluft

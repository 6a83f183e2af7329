#include "kluft/simulation/pulling_support.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/loading/acting_forces.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double large_pull = 0.01; ///< of all loads

bool slides_along(Support support) { return support == Support::smooth || support == Support::pinned; }

} // namespace

PullingSupport strongest_pulling_support(const Model& model, const State& state) {
    PullingSupport strongest;
    if (std::ranges::any_of(model.loads.stages, [](const Stage& stage) { return stage.motion.has_value(); }))
        return strongest;
    double loads = 0.0;
    std::map<std::pair<int, int>, double> pulls; // by (boundary, block)
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        for (const SupportForce& each : support_forces(body, state.body.displacement)) {
            const bool is_load = each.kind == SupportKind::weight || each.kind == SupportKind::pressure ||
                                 each.kind == SupportKind::force;
            if (is_load) loads += each.force.norm();
            if (each.kind == SupportKind::support && slides_along(model.loads.supports[each.boundary]))
                pulls[{each.boundary, each.block}] +=
                    each.force.dot(boundary_frame(model.system, each.boundary).normal);
        }
    });
    for (const auto& [of, force] : pulls)
        if (force > strongest.force)
            strongest = {
                .boundary = of.first, .block = of.second, .force = force, .share = loads > 0.0 ? force / loads : 0.0};
    return strongest;
}

std::string pulling_support_warning(const Model& model, const State& state) {
    const PullingSupport found = strongest_pulling_support(model, state);
    if (!(found.share > large_pull)) return {};
    const BlockSystem& system = model.system;
    return fmt::format("the support of '{}' pulls block {} at {} with {:.3g} kN/m: it holds in tension, too. Rock that "
                       "may part from what "
                       "is behind it, as behind an open joint, stands beside a fixed block or has no support there",
                       system.boundaries[found.boundary].name, block_label(system, found.block),
                       place_text(system.origin + system.blocks[found.block].centroid), 1e-3 * found.force);
}

} // namespace kluft

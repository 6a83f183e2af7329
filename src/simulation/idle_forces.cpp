#include "kluft/simulation/idle_forces.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

namespace {

constexpr double motion_left = 1e-6; ///< of what the rows leave free, unknowns of length 1: less is round-off

/// Blocks that the supports of a stage hold so that no motion is left; not those that its platen moves.
std::set<int> wholly_held_blocks(const Model& model, const Stage& stage) {
    const BlockSystem& system = model.system;
    const StageStart rest = start_at_rest(system);
    const StageLoads loads(model, rest, stage);
    const auto is_of_platen = [&](int row) {
        return stage.motion && loads.constraints().rows()[row].boundary == stage.motion->boundary;
    };
    std::set<int> held;
    for (const ConstrainedBlock& each : loads.constraints().blocks()) {
        const double left =
            model.kinematics == Kinematics::affine ? each.projector.norm() : each.rigid_projector.norm();
        if (left < motion_left && std::ranges::none_of(each.rows, is_of_platen)) held.insert(each.block);
    }
    return held;
}

} // namespace

std::vector<std::string> idle_force_warnings(const Model& model) {
    const BlockSystem& system = model.system;
    std::vector<std::string> warnings;
    std::set<int> told;
    for (std::size_t s = 0; s < model.loads.stages.size(); ++s) {
        const Stage& stage = model.loads.stages[s];
        if (stage.forces.empty()) continue;
        const std::set<int> held = wholly_held_blocks(model, stage);
        for (const auto& [force, value] : stage.forces) {
            const int block = model.force_points[force].block;
            const bool is_idle = system.blocks[block].fixed || held.contains(block);
            if (value.isZero() || !is_idle || !told.insert(force).second) continue;
            warnings.push_back(fmt::format(
                "stages.{}.forces.{}: has no effect: it acts on block {}, which {}", s,
                model.loads.forces[static_cast<std::size_t>(force)].name, block_label(system, block),
                system.blocks[block].fixed ? "is fixed" : "supports hold so that it can neither move nor deform"));
        }
    }
    return warnings;
}

} // namespace kluft

#include "kluft/simulation/undeformable_blocks.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

namespace {

constexpr double strain_left = 1e-6; ///< of what the rows leave free, unknowns of length 1: less is round-off
constexpr double much_area = 0.01;   ///< of the body

/// Whether no motion that the prescribed displacements of an affine block leave free strains it.
bool prevents_strain(const ConstrainedBlock& held) {
    const Mat6& free = held.projector; // rows: u_x, u_y, D11, D21, D12, D22
    const double strain = std::max({free.row(2).norm(), free.row(5).norm(), (free.row(3) + free.row(4)).norm()});
    return strain < strain_left;
}

} // namespace

std::vector<int> undeformable_blocks(const Model& model) {
    if (model.kinematics == Kinematics::rigid) return {};
    const BlockSystem& system = model.system;
    const StageStart rest = start_at_rest(system);
    std::set<int> found;
    for (const Stage& stage : model.loads.stages) {
        const StageLoads loads(model, rest, stage);
        const auto is_moved = [&](int row) { // a platen that moves strains it
            return stage.motion && loads.constraints().rows()[row].boundary == stage.motion->boundary;
        };
        for (const ConstrainedBlock& each : loads.constraints().blocks())
            if (!system.blocks[each.block].fixed && prevents_strain(each) && std::ranges::none_of(each.rows, is_moved))
                found.insert(each.block);
    }
    return {found.begin(), found.end()};
}

std::string undeformable_blocks_warning(const Model& model) {
    const BlockSystem& system = model.system;
    double of_all = 0.0;
    for (const Block& block : system.blocks) of_all += block.fixed ? 0.0 : block.area;
    const std::vector<int> found = undeformable_blocks(model);
    double area = 0.0;
    for (const int b : found) area += system.blocks[b].area;
    if (area <= much_area * of_all) return {};
    const auto area_of_block = [&](int b) { return system.blocks[b].area; };
    const int largest = *std::ranges::max_element(found, {}, area_of_block);
    const std::string which = fmt::format("block {} at {}", block_label(system, largest),
                                          place_text(system.origin + system.blocks[largest].centroid));
    const std::string who =
        found.size() == 1 ? which : fmt::format("{} blocks, the largest of which is {},", found.size(), which);
    return fmt::format(
        "{} cannot deform, since supports or platens hold corners of {} that do not lie in one line: "
        "{:.3g} % of the body's area, for which stress 0 is written (or what was there before a platen "
        "came) whatever acts on it. A net (geometry.tessellation) makes blocks small beside the "
        "supports; smooth supports (boundaries.<name>.support) on straight sides leave them free along these",
        who, found.size() == 1 ? "it" : "each", 100.0 * area / of_all);
}

} // namespace kluft

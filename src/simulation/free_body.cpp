#include "kluft/simulation/free_body.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kluft/core/dense_decompositions.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/whole_body.hpp"

namespace kluft {

namespace {

constexpr double no_resistance = 1e-9; ///< of the largest eigenvalue: a direction that no row resists
constexpr double no_component = 1e-6;  ///< of a unit vector

/// The translation (unit vector) that is free where the one across it is held.
std::optional<Vec2> free_translation(const Mat3& resistance) {
    const SymmetricEigen eigen = symmetric_eigen(resistance.topLeftCorner<2, 2>());
    if (eigen.values[1] <= 0.0 || eigen.values[0] > no_resistance * eigen.values[1]) return std::nullopt;
    const Vec2 free = eigen.vectors.col(0);
    return free.x() < -no_component || (free.x() < no_component && free.y() < 0.0) ? Vec2(-free) : free;
}

bool presses_along(const BlockSystem& system, int boundary, const Vec2& direction) {
    return std::ranges::any_of(system.boundaries[boundary].edges, [&](const BoundaryEdge& each) {
        const Edge& edge = system.blocks[each.block].edges[each.edge];
        const Vec2 side = edge_end(system, edge) - edge_start(system, edge);
        return std::abs(right_normal(side).dot(direction)) > no_component * side.norm();
    });
}

bool is_pressed_along(const Model& model, const StageLoads& loads, const Vec2& direction) {
    const std::vector<double> before = loads.pressures(0.0);
    const std::vector<double> after = loads.pressures(1.0);
    for (int i = 0; i < static_cast<int>(before.size()); ++i)
        if ((before[i] != 0.0 || after[i] != 0.0) && presses_along(model.system, i, direction)) return true;
    return false;
}

bool has_weight_along(const Model& model, const StageLoads& stage_loads, int stage, const Vec2& direction) {
    Loads loads;
    move_loads(model, stage_loads, stage, 1.0, loads);
    return std::abs(loads.gravity.dot(direction)) > no_component * loads.gravity.norm();
}

/// Two digits; what is less than the last one is none.
std::string rounded_direction(const Vec2& direction) {
    const auto rounded = [](double component) { return std::abs(component) < 0.005 ? 0.0 : component; };
    return fmt::format("({:.2g}, {:.2g})", rounded(direction.x()), rounded(direction.y()));
}

} // namespace

std::string free_body_warning(const Model& model) {
    const BlockSystem& system = model.system;
    StageStart start = start_at_rest(system);
    for (int s = 0; s < static_cast<int>(model.loads.stages.size()); ++s) {
        const Stage& stage = model.loads.stages[s];
        const StageLoads loads(model, start, stage);
        start.boundary_pressure = loads.pressures(1.0);
        const auto free = free_translation(resistance(system, loads.constraints()));
        if (!free || has_weight_along(model, loads, s, *free) || !is_pressed_along(model, loads, *free)) continue;
        return fmt::format("nothing but friction holds the body along {} in stage {}: where joints slide it may find "
                           "no equilibrium, though its pressures balance; a support that is `pinned` holds one "
                           "vertex, too",
                           rounded_direction(*free), stage.name.empty() ? std::to_string(s) : stage.name);
    }
    return {};
}

} // namespace kluft

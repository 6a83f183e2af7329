#include "kluft/simulation/fallen_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/core/units.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/kinematics/rigid.hpp"

namespace kluft {

namespace {

constexpr double large_turn = 5.0 / degrees;
constexpr double large_motion = 0.25; ///< of the smaller block's motion_scale

/// How two neighbours of the body as cut lie otherwise beside each other than before.
struct Parting {
    double turn = 0.0;   ///< rad
    double motion = 0.0; ///< of the middle of what they had in common (m)
    double share = 0.0;  ///< the larger of both, over what is large
};

double turn_of(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now, int b) {
    const double size = system.blocks[b].size;
    return rotation_of(now, b, size) - rotation_of(before, b, size);
}

Parting parting(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now,
                const Interface& interface) {
    const int a = interface.block_a;
    const int b = interface.block_b;
    const Edge& edge = system.blocks[a].edges[interface.edge_a];
    const Vec2 middle = 0.5 * (edge_start(system, edge) + edge_end(system, edge));
    const auto moved = [&](int block) {
        const Vec2 xi = block_coordinates(system.blocks[block], middle);
        return Vec2(displacement_at(now, block, xi) - displacement_at(before, block, xi));
    };
    Parting found;
    found.turn = std::abs(
        std::remainder(turn_of(system, before, now, b) - turn_of(system, before, now, a), 2.0 * std::numbers::pi));
    found.motion = (moved(b) - moved(a)).norm();
    const double scale = std::min(motion_scale(system, system.blocks[a]), motion_scale(system, system.blocks[b]));
    found.share = std::max(found.turn / large_turn, found.motion / (large_motion * scale));
    return found;
}

} // namespace

std::string description_of_fall(const Model& model, const Eigen::VectorXd& before, const State& state) {
    if (state.jumps == 0) return {};
    const BlockSystem& system = model.system;
    const Eigen::VectorXd& now = state.body.displacement;
    const Interface* farthest = nullptr;
    Parting most{.share = 1.0};
    for (const Interface& interface : system.interfaces) {
        const Parting each = parting(system, before, now, interface);
        if (each.share <= most.share) continue;
        most = each;
        farthest = &interface;
    }
    if (farthest == nullptr) return {};
    const auto way = [&](int b) {
        const int first = n_block_unknowns * b;
        return (now.segment<2>(first) - before.segment<2>(first)).norm();
    };
    const bool a_moved = way(farthest->block_a) > way(farthest->block_b);
    const int moved = a_moved ? farthest->block_a : farthest->block_b;
    const int beside = a_moved ? farthest->block_b : farthest->block_a;
    return fmt::format("block {} at {} has turned by {:.3g} degrees and moved by {:.3g} m beside block {}",
                       block_label(system, moved), place_text(system.origin + system.blocks[moved].centroid),
                       most.turn * degrees, most.motion, block_label(system, beside));
}

} // namespace kluft

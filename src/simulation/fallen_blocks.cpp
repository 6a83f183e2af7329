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
#include "kluft/simulation/over_damped_motion.hpp"

namespace kluft {

namespace {

constexpr double large_turn = 5.0 / degrees;
constexpr double large_motion = 0.25; ///< of the smaller block's motion_scale

/// How a block lies otherwise than before beside a neighbour of the body as cut, or in space if it has none.
struct Parting {
    int block = -1;
    int beside = -1;     ///< -1: nothing
    double turn = 0.0;   ///< rad
    double motion = 0.0; ///< of the middle of what the two had in common, or of the block's (m)
    double share = 0.0;  ///< the larger of both, over what is large
};

double turn_of(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now, int b) {
    const double size = system.blocks[b].size;
    return rotation_of(now, b, size) - rotation_of(before, b, size);
}

double share_of(double turn, double motion, double scale) {
    return std::max(turn / large_turn, motion / (large_motion * scale));
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
    const auto way = [&](int block) { return (now - before).segment<2>(n_block_unknowns * block).norm(); };
    const bool a_moved = way(a) > way(b);
    Parting found{.block = a_moved ? a : b, .beside = a_moved ? b : a};
    found.turn = std::abs(
        std::remainder(turn_of(system, before, now, b) - turn_of(system, before, now, a), 2.0 * std::numbers::pi));
    found.motion = (moved(b) - moved(a)).norm();
    const double scale = std::min(motion_scale(system, system.blocks[a]), motion_scale(system, system.blocks[b]));
    found.share = share_of(found.turn, found.motion, scale);
    return found;
}

/// Of a block that is no neighbour of any.
Parting parting(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now, int block) {
    Parting found{.block = block};
    found.turn = std::abs(std::remainder(turn_of(system, before, now, block), 2.0 * std::numbers::pi));
    found.motion = (now - before).segment<2>(n_block_unknowns * block).norm();
    found.share = share_of(found.turn, found.motion, motion_scale(system, system.blocks[block]));
    return found;
}

bool lies_alone(const Block& block) {
    return !block.fixed && std::ranges::all_of(block.edges, [](const Edge& edge) { return edge.interface < 0; });
}

} // namespace

std::string description_of_fall(const Model& model, const Eigen::VectorXd& before, const State& state) {
    if (state.jumps == 0) return {};
    const BlockSystem& system = model.system;
    const Eigen::VectorXd& now = state.body.displacement;
    Parting most{.share = 1.0};
    const auto look_at = [&](const Parting& each) {
        if (each.share > most.share) most = each;
    };
    for (const Interface& interface : system.interfaces) look_at(parting(system, before, now, interface));
    for (int b = 0; b < system.n_blocks(); ++b)
        if (lies_alone(system.blocks[b])) look_at(parting(system, before, now, b));
    if (most.block < 0) return {};
    const std::string beside = most.beside < 0 ? "" : " beside block " + block_label(system, most.beside);
    return fmt::format("block {} at {} has turned by {:.3g} degrees and moved by {:.3g} m{}",
                       block_label(system, most.block), place_text(system.origin + system.blocks[most.block].centroid),
                       most.turn * degrees, most.motion, beside);
}

std::string description_of_small_jump(const Model& model, const Eigen::VectorXd& before, const State& state) {
    if (state.jumps == 0 || !description_of_fall(model, before, state).empty()) return {};
    const BlockSystem& system = model.system;
    const Eigen::VectorXd moved = state.body.displacement - before;
    int farthest = -1;
    double most = jump_motion;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double share = moved.segment<2>(n_block_unknowns * b).norm() / motion_scale(system, system.blocks[b]);
        if (share <= most) continue;
        most = share;
        farthest = b;
    }
    if (farthest < 0) return {};
    return fmt::format("block {} has moved by {:.3g} m in all", block_label(system, farthest),
                       moved.segment<2>(n_block_unknowns * farthest).norm());
}

} // namespace kluft

#include "kluft/simulation/fallen_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/kinematics/rigid.hpp"

namespace kluft {

namespace {

constexpr double large_turn = 5.0 * std::numbers::pi / 180.0;
constexpr double large_motion = 0.25; ///< of a block's size (motion_scale)

/// How a block lies otherwise than before.
struct Displaced {
    double turn = 0.0;   ///< rad
    double motion = 0.0; ///< of its middle (m)
    double share = 0.0;  ///< the larger of both, over what is large
};

Displaced displaced(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now, int b) {
    const Block& block = system.blocks[b];
    const int first = n_block_unknowns * b;
    Displaced result;
    result.turn = std::abs(
        std::remainder(rotation_of(now, b, block.size) - rotation_of(before, b, block.size), 2.0 * std::numbers::pi));
    result.motion = (now.segment<2>(first) - before.segment<2>(first)).norm();
    result.share = std::max(result.turn / large_turn, result.motion / (large_motion * motion_scale(system, block)));
    return result;
}

} // namespace

std::string description_of_fall(const Model& model, const Eigen::VectorXd& before, const State& state) {
    if (state.jumps == 0) return {};
    const BlockSystem& system = model.system;
    int n_fallen = 0;
    int farthest = -1;
    Displaced most;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Displaced each = displaced(system, before, state.body.displacement, b);
        if (each.share <= 1.0) continue;
        ++n_fallen;
        if (each.share <= most.share) continue;
        most = each;
        farthest = b;
    }
    if (n_fallen == 0) return {};
    return fmt::format("{}block {} at {} has turned by {:.3g} degrees and moved by {:.3g} m",
                       n_fallen == 1 ? std::string()
                                     : fmt::format("{} blocks have fallen, the farthest is this: ", n_fallen),
                       block_label(system, farthest), place_text(system.origin + system.blocks[farthest].centroid),
                       most.turn * 180.0 / std::numbers::pi, most.motion);
}

} // namespace kluft

#include "kluft/simulation/failure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/kinematics/rigid.hpp"

namespace kluft {

namespace {

constexpr double clear_motion = 0.1;     ///< of a block in a load step, in spacings of hexagons of its size
constexpr double share_of_largest = 0.1; ///< of the farthest motion: a block that moves less stands beside it
constexpr double share_along = 0.3;      ///< of the farthest motion: a block that moves as much moves along
constexpr double clear_turn =
    0.1; ///< rotation times sqrt(area) over motion: a block turns too, as one that topples does

std::string block_description(const BlockSystem& system, int index) {
    const Block& block = system.blocks[index];
    const Vec2 at = system.origin + block.centroid;
    std::string text =
        fmt::format("block {} at {}, area {:.3g} m2", block_label(system, index), place_text(at), block.area);
    std::string interfaces;
    for (const Edge& edge : block.edges) {
        if (edge.interface >= 0) interfaces += fmt::format(" {}", edge.interface);
    }
    return interfaces.empty() ? text : text + ", interfaces" + interfaces;
}

std::set<int> blocks_of(const std::vector<MovingBlock>& moving) {
    std::set<int> blocks;
    for (const MovingBlock& each : moving) blocks.insert(each.block);
    return blocks;
}

/// A unit vector with two digits; what is less than their last one beside its larger component is none.
std::string direction_text(const Vec2& direction) {
    const auto rounded = [](double component) { return std::abs(component) < 0.005 ? 0.0 : component; };
    return fmt::format("({:.2g}, {:.2g})", rounded(direction.x()), rounded(direction.y()));
}

/// Where some have moved, others that have not stand: what presses on them is not balanced, and so are they not.
std::vector<MovingBlock> those_that_move(std::vector<MovingBlock> moving, const std::vector<double>& lengths) {
    const double largest = lengths.empty() ? 0.0 : std::ranges::max(lengths);
    std::vector<MovingBlock> result;
    for (std::size_t i = 0; i < moving.size(); ++i)
        if (lengths[i] >= share_of_largest * largest) result.push_back(moving[i]);
    return result;
}

Vec2 motion_of(const Eigen::VectorXd& before, const Eigen::VectorXd& now, int block) {
    const int first = n_block_unknowns * block;
    return now.segment<2>(first) - before.segment<2>(first);
}

/// Where a block that has moved has gone, and whether it has turned.
MovingBlock moved_block(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now,
                        int index) {
    const Block& block = system.blocks[index];
    const Vec2 motion = motion_of(before, now, index);
    const double length = motion.norm();
    const double turned = std::remainder(rotation_of(now, index, block.size) - rotation_of(before, index, block.size),
                                         2.0 * std::numbers::pi);
    const bool turns = std::abs(turned) * std::sqrt(block.area) > clear_turn * length;
    return {index, motion / length, turns ? (turned > 0.0 ? 1 : -1) : 0};
}

} // namespace

std::vector<MovingBlock> moving_on(const BlockSystem& system, const Eigen::VectorXd& before, const Eigen::VectorXd& now,
                                   std::vector<MovingBlock> moving) {
    std::vector<double> lengths; // of the motions
    for (MovingBlock& each : moving) {
        const double length = motion_of(before, now, each.block).norm();
        lengths.push_back(length);
        if (length > clear_motion * spacing_of(system.blocks[each.block]))
            each = moved_block(system, before, now, each.block);
    }
    return those_that_move(std::move(moving), lengths);
}

std::vector<MovingBlock> moving_along(const BlockSystem& system, const Eigen::VectorXd& before,
                                      const Eigen::VectorXd& now, const std::vector<MovingBlock>& moving) {
    double farthest = 0.0;
    for (int b = 0; b < system.n_blocks(); ++b) farthest = std::max(farthest, motion_of(before, now, b).norm());
    std::set<int> reached = blocks_of(moving);
    std::vector<int> next(reached.begin(), reached.end());
    std::vector<MovingBlock> along;
    while (!next.empty()) {
        const int from = next.back();
        next.pop_back();
        for (const Edge& edge : system.blocks[from].edges) {
            if (edge.interface < 0) continue;
            const Interface& interface = system.interfaces[edge.interface];
            const int to = interface.block_a == from ? interface.block_b : interface.block_a;
            const double length = motion_of(before, now, to).norm();
            if (length == 0.0 || length < share_along * farthest || !reached.insert(to).second) continue;
            next.push_back(to);
            along.push_back(moved_block(system, before, now, to));
        }
    }
    return along;
}

std::vector<MovingBlock> all_moving(const Failure& failure) {
    std::vector<MovingBlock> all = failure.moving;
    all.insert(all.end(), failure.along.begin(), failure.along.end());
    return all;
}

std::string description(const Model& model, const std::vector<MovingBlock>& moving) {
    if (moving.empty()) return "";
    const auto& [block, direction, turn] = moving.front();
    std::string text = block_description(model.system, block);
    text += direction.norm() > 0.0 ? " moves towards " + direction_text(direction) : std::string(" turns");
    if (turn != 0 && direction.norm() > 0.0) text += " and turns";
    const std::set<int> all = blocks_of(moving);
    if (all.size() > 1) text += fmt::format(", and {} more", all.size() - 1);
    double area = 0.0;
    for (const int b : all) area += model.system.blocks[b].area;
    return text + fmt::format(", {:.3g} % of the body", 100.0 * area / area_of(model.system));
}

std::string description(const Model& model, const Failure& failure) {
    std::string text = failure.what;
    if (text.empty()) text = description(model, all_moving(failure));
    if (text.empty()) {
        text = fmt::format("residual {:.2g} of the forces", failure.residual_ratio);
        if (failure.worst_block >= 0) text += ", worst is " + block_description(model.system, failure.worst_block);
    }
    if (failure.strength_factor != 1.0)
        text += fmt::format("; with the strengths divided by {:.6g}", failure.strength_factor);
    if (failure.nothing_holds) text += "; nothing holds the body, which has neither a support nor a platen";
    return text;
}

} // namespace kluft

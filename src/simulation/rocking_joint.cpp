#include "kluft/simulation/rocking_joint.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/overlap_rule.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double large_shortfall = 0.1;

/// (18a): the load N at the height h turns a block over about the edge of a joint of the length L once the least of
/// x/3 + omega h, with x = sqrt(2 N/(k_n omega)), is what the load has of lever; over L/2.
double shortfall_of_hinge(double force, double normal_stiffness, double height, double length) {
    const double strip = std::sqrt(2.0 * force / normal_stiffness);
    const double rotation = std::pow(strip / (6.0 * height), 2.0 / 3.0);
    return 6.0 * rotation * height / length;
}

double height_above(const BlockSystem& system, const Eigen::VectorXd& q, int block, const Vec2& place,
                    const Vec2& normal) {
    if (system.blocks[block].fixed) return 0.0;
    return std::abs(normal.dot(current_position(system, q, block, Vec2::Zero()) - place));
}

/// A platen holds what leans, and cells of a net turn by little: there a joint's stiffness along a part of it decides nothing.
bool may_turn_over(const Model& model, const State& state) {
    const bool has_platen = model.loads.stages[static_cast<std::size_t>(state.at.stage)].motion.has_value();
    return !has_platen && std::ranges::none_of(model.system.interfaces, [](const Interface& interface) {
        return interface.origin == EdgeOrigin::tessellation;
    });
}

} // namespace

RockingJoint softest_rocking_joint(const Model& model, const State& state) {
    const Eigen::VectorXd& q = state.body.displacement;
    RockingJoint softest;
    if (!may_turn_over(model, state)) return softest;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const auto& points = body.placement->contacts;
        const auto is_open = [&](std::size_t k) {
            return contact_traction(body, static_cast<int>(k), q).state == ContactState::open;
        };
        for (std::size_t i = 0; i + 2 < points.size(); ++i) {
            const ContactPoint& start = points[i];
            const ContactPoint& end = points[i + 2];
            const bool is_hinge = start.interface >= 0 && start.key.point == 0 && end.interface == start.interface &&
                                  model.overlap_points[start.interface] == least_overlap_points;
            if (!is_hinge || is_open(i) == is_open(i + 2)) continue;
            double force = 0.0;
            double length = 0.0;
            for (std::size_t k = i; k < i + 3; ++k) {
                force -= points[k].weight * contact_traction(body, static_cast<int>(k), q).normal;
                length += points[k].weight;
            }
            const ContactPoint& middle = points[i + 1];
            const Vec2 place = current_position(model.system, q, middle.block_a, middle.xi_a);
            const double height = std::max(height_above(model.system, q, middle.block_a, place, middle.normal),
                                           height_above(model.system, q, middle.block_b, place, middle.normal));
            if (!(force > 0.0) || !(height > 0.0)) continue;
            const double shortfall = shortfall_of_hinge(force, model.laws[middle.law].normal_stiffness, height, length);
            if (shortfall <= softest.shortfall) continue;
            softest = {shortfall, middle.block_a, middle.block_b, middle.law, model.system.origin + place};
        }
    });
    return softest;
}

std::string rocking_joint_warning(const Model& model, const State& state) {
    const RockingJoint found = softest_rocking_joint(model, state);
    if (!(found.shortfall > large_shortfall)) return {};
    const double less = 100.0 * found.shortfall;
    return fmt::format(
        "the joint of blocks {} and {} at about {} is open over a part of its length. Its three points are a hinge in "
        "the corner; on a joint of its normal stiffness ({:.3g} Pa/m) a block turns over {}: "
        "overlap_points: 15 for its interface computes that, and with a larger normal_stiffness it is less",
        block_label(model.system, found.block_a), block_label(model.system, found.block_b), place_text(found.place),
        model.laws[found.law].normal_stiffness,
        less < 99.0 ? fmt::format("at about {:.0f} % less", less) : "by itself");
}

} // namespace kluft

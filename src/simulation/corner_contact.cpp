#include "kluft/simulation/corner_contact.hpp"

#include <algorithm>
#include <compare>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double short_contact = 0.02; ///< of the spacing of a hexagon as large as the smaller block
constexpr double large_share = 0.05;   ///< of what acts on a block (measured: below 0.01, or above 0.1)
constexpr double as_much = 0.98;       ///< of the largest axial stress

/// Two blocks and the edges with which they touch.
struct Overlap {
    int block_a = 0;
    int block_b = 0;
    int edge_a = 0;
    int edge_b = 0;
    auto operator<=>(const Overlap&) const = default;
};

/// Sums over the contact points of an overlap.
struct Touching {
    double length = 0.0;   ///< none, of a vertex on a face: what its point stands for is of the iteration
    double pressing = 0.0; ///< N/m, in compression
    double acting = 0.0;   ///< magnitudes of the forces (N/m)
    Vec2 place = Vec2::Zero();
};

using Overlaps = std::map<Overlap, Touching>;

Overlaps pressed_overlaps(const LoadedBody& body, const Eigen::VectorXd& q) {
    Overlaps overlaps;
    for (const ContactPoint& point : body.placement->contacts) {
        const PointTraction traction = contact_traction(*body.laws, point, q);
        if (traction.normal >= 0.0) continue;
        Touching& touching = overlaps[{point.block_a, point.block_b, point.key.edge_a, point.key.edge_b}];
        if (point.key.point >= 0) touching.length += point.weight;
        touching.pressing -= point.weight * traction.normal;
        touching.acting += point.weight * Vec2(traction.normal, traction.shear).norm();
        touching.place = current_position(*body.system, q, point.block_a, point.xi_a);
    }
    return overlaps;
}

/// On each block, infinite on a fixed one (N/m).
std::vector<double> acting_on_blocks(const LoadedBody& body, const Overlaps& overlaps) {
    std::vector<double> acting(body.system->blocks.size(), 0.0);
    for (const auto& [overlap, touching] : overlaps) {
        acting[overlap.block_a] += touching.acting;
        acting[overlap.block_b] += touching.acting;
    }
    for (int b = 0; b < body.system->n_blocks(); ++b) {
        acting[b] = std::max(acting[b], weight_of(body, b).norm());
        if (body.system->blocks[b].fixed) acting[b] = std::numeric_limits<double>::infinity();
    }
    return acting;
}

/// Whether it is one of the tip's block with the ground before it: the outline, or the edge into which the tip has sunk.
bool is_with_ground(const BlockSystem& system, const Overlap& overlap, const UnheldTip& tip) {
    const auto is_before_tip = [&](int edge) {
        return edge == tip.ground_edge || system.blocks[tip.ground].edges[edge].interface < 0;
    };
    if (overlap.block_a == tip.block && overlap.block_b == tip.ground) return is_before_tip(overlap.edge_b);
    if (overlap.block_a == tip.ground && overlap.block_b == tip.block) return is_before_tip(overlap.edge_a);
    return false;
}

/// What carries most of the tips that lean on the ground before them, and of which strength reduction takes no count.
std::optional<CornerContact> tip_on_ground(const Model& model, const State& state) {
    std::optional<CornerContact> largest;
    const auto tips = unheld_tips(model, state);
    if (tips.empty()) return largest;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const Overlaps overlaps = pressed_overlaps(body, state.body.displacement);
        const std::vector<double> acting = acting_on_blocks(body, overlaps);
        for (const UnheldTip& tip : tips) {
            CornerContact contact{.block_a = tip.block, .block_b = tip.ground, .held = tip.block};
            contact.place = model.system.origin + tip.place;
            for (const auto& [overlap, touching] : overlaps) {
                if (!is_with_ground(model.system, overlap, tip)) continue;
                contact.length += touching.length;
                contact.force += touching.pressing;
            }
            contact.share = contact.force / acting[tip.block];
            if (contact.share >= large_share && (!largest || contact.force > largest->force)) largest = contact;
        }
    });
    return largest;
}

} // namespace

std::vector<CornerContact> corner_contacts(const Model& model, const State& state) {
    const BlockSystem& system = model.system;
    std::vector<CornerContact> corners;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const Overlaps overlaps = pressed_overlaps(body, state.body.displacement);
        const std::vector<double> acting = acting_on_blocks(body, overlaps);
        for (const auto& [overlap, touching] : overlaps) {
            const int a = overlap.block_a;
            const int b = overlap.block_b;
            const double size = std::min(spacing_of(system.blocks[a]), spacing_of(system.blocks[b]));
            const int held = acting[a] < acting[b] ? a : b;
            const double share = touching.pressing / acting[held];
            if (touching.length > short_contact * size || share < large_share) continue;
            corners.push_back({a, b, held, touching.length, touching.pressing, share, system.origin + touching.place});
        }
    });
    std::ranges::stable_sort(corners, std::greater(), &CornerContact::force);
    return corners;
}

std::vector<UnheldTip> unheld_tips(const Model& model, const State& state) {
    std::vector<UnheldTip> tips = detected_contacts(model, state.body, false).unheld_tips;
    std::ranges::stable_sort(tips, std::greater(), &UnheldTip::depth);
    return tips;
}

std::string description(const Model& model, const UnheldTip& tip) {
    return fmt::format("the tip of block {} at {} goes into the ground before it, block {}, which is not taken to "
                       "hold it while strengths are reduced: rock would break there, or ride over",
                       block_label(model.system, tip.block), place_text(model.system.origin + tip.place),
                       block_label(model.system, tip.ground));
}

std::string description(const Model& model, const CornerContact& corner) {
    const int other = corner.held == corner.block_a ? corner.block_b : corner.block_a;
    const std::string length = corner.length > 0.0 ? fmt::format("{:.2g} mm long", 1e3 * corner.length) : "a point";
    return fmt::format("a corner holds block {}: its contact with block {}, {} at about {}, carries {:.3g} kN/m, "
                       "{:.3g} % of what acts "
                       "on it",
                       block_label(model.system, corner.held), block_label(model.system, other), length,
                       place_text(corner.place), 1e-3 * corner.force, 100.0 * corner.share);
}

std::string corner_contact_warning(const Model& model, const State& state) {
    if (model.loads.stages[state.at.stage].strength_reduction) return {};
    if (const auto tip = has_gravity(model) ? tip_on_ground(model, state) : std::nullopt)
        return description(model, *tip) +
               ": a tip leans there on the ground before it, on which rock would break or ride over; a stage of "
               "`strength_reduction` takes no count of it, and tells whether the body stands without";
    if (model.has_potential_cracks) return {};
    const auto corners = corner_contacts(model, state);
    if (corners.empty()) return {};
    return description(model, corners.front()) +
           ": blocks without potential cracks keep their corners, and one, as "
           "at the toe of a block that turns over or where joints cross, may carry what rock would not";
}

void TipWatch::step(const StepRecord& record, const State& state) {
    const Stage& stage = model_.loads.stages[record.stage];
    if (!stage.motion || stage.strength_reduction || !record.balanced) return;
    if (model_.has_potential_cracks && !has_gravity(model_)) return; // a specimen, without ground
    const double stress = std::abs(record.axial_stress);
    if (stress <= without_) return;
    const auto tip = tip_on_ground(model_, state);
    if (!tip) without_ = stress;
    if (stress <= largest_stress_) return;
    largest_stress_ = stress;
    tip_ = tip;
    step_ = record.step;
}

std::string TipWatch::warning() const {
    if (!tip_ || without_ >= as_much * largest_stress_) return {};
    return fmt::format(
        "load step {}: at the largest axial stress, {:.4g} MPa, {}: a tip leans there on the ground before it, on "
        "which rock would break or ride over{}",
        step_, 1e-6 * largest_stress_, description(model_, *tip_),
        without_ > 0.0 ? fmt::format(". Without one the body has borne {:.4g} MPa", 1e-6 * without_) : "");
}

} // namespace kluft

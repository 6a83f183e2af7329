#include "kluft/simulation/corner_contact.hpp"

#include <algorithm>
#include <compare>
#include <limits>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double short_contact = 0.02; ///< of the spacing of a hexagon as large as the smaller block
constexpr double large_share = 0.05;   ///< of what acts on a block (measured: below 0.01, or above 0.1)

/// Two blocks and the direction in which they touch, which is one along an overlap.
struct Overlap {
    int block_a = 0;
    int block_b = 0;
    double normal_x = 0.0;
    double normal_y = 0.0;
    auto operator<=>(const Overlap&) const = default;
};

/// Sums over the contact points of an overlap.
struct Touching {
    double length = 0.0;
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
        const Block& block = body.system->blocks[point.block_a];
        Touching& touching = overlaps[{point.block_a, point.block_b, point.normal.x(), point.normal.y()}];
        touching.length += point.weight;
        touching.pressing -= point.weight * traction.normal;
        touching.acting += point.weight * Vec2(traction.normal, traction.shear).norm();
        touching.place = block.centroid + block.size * point.xi_a + displacement_at(q, point.block_a, point.xi_a);
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

} // namespace

std::string corner_contact_warning(const Model& model, const State& state) {
    const BlockSystem& system = model.system;
    std::string warning;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const Overlaps overlaps = pressed_overlaps(body, state.body.displacement);
        const std::vector<double> acting = acting_on_blocks(body, overlaps);
        double largest = 0.0;
        for (const auto& [overlap, touching] : overlaps) {
            const int a = overlap.block_a;
            const int b = overlap.block_b;
            const double size = std::min(spacing_of(system.blocks[a]), spacing_of(system.blocks[b]));
            const int held = acting[a] < acting[b] ? a : b;
            const double share = touching.pressing / acting[held];
            if (touching.length > short_contact * size || share < large_share || touching.pressing <= largest) continue;
            largest = touching.pressing;
            warning =
                fmt::format("a corner holds block {}: its contact with block {}, {:.2g} mm long at about {}, carries "
                            "{:.3g} kN/m, {:.2g} "
                            "% of what acts on it. Where blocks have slid so little that corners catch, they may stand "
                            "by them alone: "
                            "without such a corner the factor of safety is lower",
                            block_label(system, held), block_label(system, held == a ? b : a), 1e3 * touching.length,
                            place_text(system.origin + touching.place), 1e-3 * touching.pressing, 100.0 * share);
        }
    });
    return warning;
}

} // namespace kluft

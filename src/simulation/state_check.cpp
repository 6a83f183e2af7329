#include "kluft/simulation/state_check.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/detection.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

std::string block_text(const BlockSystem& system, int b) {
    const Vec2 at = system.origin + system.blocks[b].centroid;
    return fmt::format("block {} at {}", block_label(system, b), place_text(at));
}

/// Of the extent of a block across an interface: the face of its neighbour is about to leave on the other side.
constexpr double largest_overlap = 0.75;

/// Of a block in its place, in a direction (m): that of the rectangle with its area and second moment.
double extent_along(const LoadedBody& body, const Eigen::VectorXd& q, int b, const Vec2& direction) {
    const Block& block = body.system->blocks[b];
    const Vec2 before = deformation_gradient(q, b, block.size).transpose() * direction;
    return std::sqrt(12.0 * before.dot(block.second_moment * before) / block.area);
}

bool is_own(const ContactPoint& point) { return point.interface >= 0; }

/// Whether a contact that is too deep tells of a body that is none any more: that of two faces of an interface, unless
/// one of them is a fragment's; of blocks that are given, which are few, wherever they meet.
bool ends_a_run(const BlockSystem& system, const ContactPoint& point) {
    const bool given = system.outline_type >= 0;
    return given || (is_own(point) && !is_fragment(system, point.block_a) && !is_fragment(system, point.block_b));
}

/// The first contact that is too deep, of those that end a run or of the others; "" if there is none.
std::string deep_contact(const LoadedBody& body, const Eigen::VectorXd& q, bool ending) {
    const BlockSystem& system = *body.system;
    for (const ContactPoint& point : body.placement->contacts) {
        const double depth = -gap_and_slip(point, q).gap;
        if (depth <= 0.0 || ends_a_run(system, point) != ending) continue;
        const bool own = is_own(point);
        const Block& a = system.blocks[point.block_a];
        const Block& b = system.blocks[point.block_b];
        const bool ends_by_extent = ending && own;
        const double deepest = ends_by_extent
                                   ? largest_overlap * std::min(extent_along(body, q, point.block_a, point.normal),
                                                                extent_along(body, q, point.block_b, point.normal))
                                   : deepest_contact(system, point.block_a, point.block_b, own);
        if (!(depth > deepest)) continue;
        return fmt::format(
            "{} and {} overlap by {:.3g} m, {:.0f} % of the size of the smaller one: the loads are too large "
            "for the normal stiffness of the interface between them",
            block_text(system, point.block_a), block_text(system, point.block_b), depth,
            100.0 * depth / std::min(a.size, b.size));
    }
    return {};
}

} // namespace

std::string flaw_of_displacements(const LoadedBody& body, const Eigen::VectorXd& q) {
    if (!q.allFinite()) return "displacements are no finite numbers any more";
    const BlockSystem& system = *body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double ratio = deformation_gradient(q, b, system.blocks[b].size).determinant();
        if (ratio <= 0.0)
            return fmt::format("{} is turned inside out: {:.3g} of its area is left", block_text(system, b), ratio);
    }
    return deep_contact(body, q, true);
}

std::string lost_contact(const LoadedBody& body, const Eigen::VectorXd& q) { return deep_contact(body, q, false); }

} // namespace kluft

#include "kluft/simulation/state_check.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/detection.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

std::string block_text(const BlockSystem& system, int b) {
    const Vec2 at = system.origin + system.blocks[b].centroid;
    return fmt::format("block {} at ({:.6g}, {:.6g})", block_label(system, b), at.x(), at.y());
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

/// The first contact of two faces of an interface, or of others, that is too deep; "" if there is none.
std::string deep_contact(const LoadedBody& body, const Eigen::VectorXd& q, bool own) {
    const BlockSystem& system = *body.system;
    for (const ContactPoint& point : body.contacts) {
        if (is_own(point) != own) continue;
        const Block& a = system.blocks[point.block_a];
        const Block& b = system.blocks[point.block_b];
        const double depth = -gap_and_slip(point, q).gap;
        const double deepest = own ? largest_overlap * std::min(extent_along(body, q, point.block_a, point.normal),
                                                                extent_along(body, q, point.block_b, point.normal))
                                   : deepest_contact(a, b, false);
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
    const bool given = system.outline_type >= 0; // has few blocks, and where they meet later counts as much
    auto flaw = deep_contact(body, q, true);
    return flaw.empty() && given ? deep_contact(body, q, false) : flaw;
}

std::string lost_contact(const LoadedBody& body, const Eigen::VectorXd& q) { return deep_contact(body, q, false); }

} // namespace kluft

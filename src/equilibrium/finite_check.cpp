#include "kluft/equilibrium/finite_check.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/place_text.hpp"

namespace kluft {

namespace {

std::string placed_block(const BlockSystem& system, int b) {
    const Vec2 at = system.origin + system.blocks[b].centroid;
    return fmt::format("block {} at {}", block_label(system, b), place_text(at));
}

NumberFlaw flaw_of_block(const BlockSystem& system, const char* quantity, int b) {
    return {fmt::format("{} of {} is no finite number", quantity, placed_block(system, b)), b};
}

NumberFlaw flaw_between(const BlockSystem& system, int a, int b, int interface) {
    std::string place = fmt::format("between {} and {}", placed_block(system, a), placed_block(system, b));
    if (interface >= 0) place = fmt::format("on interface {} {}", interface, place);
    return {"the traction " + place + " is no finite number", a};
}

/// The first block with a number of `values` that is not finite; of size n numbers for each block.
std::optional<int> block_that_is_not_finite(const BlockSystem& system, const Eigen::VectorXd& values) {
    const Eigen::Index n = values.size() / system.n_blocks();
    for (int b = 0; b < system.n_blocks(); ++b)
        if (!values.segment(n * b, n).allFinite()) return b;
    return std::nullopt;
}

bool is_finite(const PointTraction& traction) {
    return std::isfinite(traction.normal) && std::isfinite(traction.shear);
}

std::optional<NumberFlaw> flaw_of_tractions(const LoadedBody& body, const Eigen::VectorXd& q) {
    const Placement& placement = *body.placement;
    for (int i = 0; i < static_cast<int>(placement.contacts.size()); ++i) {
        const ContactPoint& point = placement.contacts[i];
        if (!is_finite(contact_traction(body, i, q)))
            return flaw_between(*body.system, point.block_a, point.block_b, point.interface);
    }
    for (int i = 0; i < static_cast<int>(placement.bonds.size()); ++i) {
        const Bond& bond = placement.bonds[i];
        for (int point = 0; point < n_bond_points; ++point)
            if (!is_finite(bond_traction(body, i, point, q)))
                return flaw_between(*body.system, bond.block_a, bond.block_b, bond.interface);
    }
    return std::nullopt;
}

} // namespace

NumberFlaw flaw_of_forces(const EquilibriumProblem& problem, const Eigen::VectorXd& q, const Eigen::VectorXd& forces) {
    const BlockSystem& system = *problem.body.system;
    if (const auto b = block_that_is_not_finite(system, q)) return flaw_of_block(system, "the displacement", *b);
    if (auto flaw = flaw_of_tractions(problem.body, q)) return std::move(*flaw);
    if (const auto b = block_that_is_not_finite(system, forces)) return flaw_of_block(system, "a force", *b);
    return {"the forces are too large to be summed", 0};
}

NumberFlaw flaw_of_increment(const EquilibriumProblem& problem, const Eigen::VectorXd& increment) {
    const BlockSystem& system = *problem.body.system;
    return flaw_of_block(system, "the increment", block_that_is_not_finite(system, increment).value_or(0));
}

} // namespace kluft

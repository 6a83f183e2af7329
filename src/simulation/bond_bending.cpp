#include "kluft/simulation/bond_bending.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/overloaded_bonds.hpp"
#include "kluft/simulation/state_fields.hpp"

namespace kluft {

namespace {

constexpr double clear_excess = 2.0; ///< of the tensile strength

/// Normal tractions of a bond along which it is linear (Pa): its points are Gauss's.
struct NormalTractions {
    double mean = 0.0;
    double largest = 0.0; ///< at one of its ends
};

NormalTractions normal_tractions(const LoadedBody& body, int bond, const Eigen::VectorXd& q) {
    static_assert(n_bond_points == 2);
    const double first = bond_traction(body, bond, 0, q).normal;
    const double second = bond_traction(body, bond, 1, q).normal;
    const double mean = 0.5 * (first + second);
    return {mean, mean + 0.5 * std::numbers::sqrt3 * std::abs(first - second)};
}

} // namespace

std::string bond_bending_warning(const Model& model, const State& state) {
    double largest = 0.0;
    std::string warning;
    with_body_of_state(model, state, [&](const LoadedBody& body) {
        const auto& bonds = body.placement->bonds;
        for (int i = 0; i < static_cast<int>(bonds.size()); ++i) {
            const Bond& bond = bonds[i];
            if (model.system.interfaces[bond.interface].origin != EdgeOrigin::given) continue;
            const double strength = model.strengths[bond.interface].tensile_strength;
            const auto [mean, tension] = normal_tractions(body, i, state.body.displacement);
            const bool is_torn = mean > clear_overload * strength; // BondWatch says so
            if (is_torn || tension <= clear_excess * strength || tension <= largest) continue;
            largest = tension;
            warning = fmt::format(
                "the bond of blocks {} and {} bends: one of its ends is pulled by {:.3g} MPa, {:.2g} times its tensile "
                "strength. Bonds fail by mean stresses, so that bending breaks none: where it decides, cut the body by "
                "a "
                "net (geometry.tessellation) that has several bonds across it",
                block_label(model.system, bond.block_a), block_label(model.system, bond.block_b), 1e-6 * tension,
                tension / strength);
        }
    });
    return warning;
}

} // namespace kluft

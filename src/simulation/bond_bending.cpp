#include "kluft/simulation/bond_bending.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/simulation/overloaded_bonds.hpp"

namespace kluft {

namespace {

/// Normal tractions of a bond along which it is linear (Pa): its points are Gauss's.
struct NormalTractions {
    double mean = 0.0;
    double largest = 0.0; ///< at one of its ends
};

NormalTractions normal_tractions(const InterfaceLaw& law, const Bond& bond, const Eigen::VectorXd& q) {
    static_assert(n_bond_points == 2);
    const double first = bond_traction(law, bond, 0, q).normal;
    const double second = bond_traction(law, bond, 1, q).normal;
    const double mean = 0.5 * (first + second);
    return {mean, mean + 0.5 * std::numbers::sqrt3 * std::abs(first - second)};
}

/// What round-off leaves of tractions where the displacements of the two blocks are equal (Pa).
double round_off_of_tractions(const InterfaceLaw& law, const Bond& bond, const Eigen::VectorXd& q) {
    constexpr double round_off = 1e-9;
    double displacement = 0.0;
    for (int k = 0; k < n_bond_points; ++k)
        displacement = std::max(displacement, displacement_at(q, bond.block_a, bond.xi_a[k]).norm());
    return round_off * law.normal_stiffness * displacement;
}

} // namespace

BendingWatch::BendingWatch(const Model& model) : model_(model) {
    if (model.has_potential_cracks) interfaces_ = bonds_of_large_blocks(model);
}

void BendingWatch::step(const StepRecord& record, const State& state) {
    if (interfaces_.empty() || !record.balanced) return;
    const Eigen::VectorXd& q = state.body.displacement;
    for (const int i : interfaces_) {
        if (state.body.interfaces[i] != InterfaceStatus::potential_crack) continue;
        const Bond bond = bond_at(model_.system, i, q, &state.body.bond_shear[n_bond_points * i]);
        const InterfaceLaw& law = model_.laws[bond.law];
        const double strength = model_.strengths[i].tensile_strength;
        const auto [mean, tension] = normal_tractions(law, bond, q);
        const bool is_torn = mean > clear_overload * strength; // BondWatch says so
        const bool bends = tension > std::max(clear_overload * strength, round_off_of_tractions(law, bond, q));
        if (is_torn || !bends) continue;
        const double load = tension / strength;
        if (std::tie(load, tension) > std::tie(worst_.load, worst_.tension)) worst_ = {i, record.step, tension, load};
    }
}

std::string BendingWatch::warning() const {
    if (worst_.interface < 0) return {};
    const Interface& interface = model_.system.interfaces[worst_.interface];
    const std::string load = std::isfinite(worst_.load) ? fmt::format("{:.3g} times its tensile strength", worst_.load)
                                                        : "and it has no tensile strength";
    return fmt::format("the bond of blocks {} and {} bends: one of its ends is pulled by {:.3g} MPa, {} (in load step "
                       "{}). Bonds fail by mean "
                       "stresses, so that bending breaks none: where it decides, cut the body by a net "
                       "(geometry.tessellation) that has "
                       "several bonds across it",
                       block_label(model_.system, interface.block_a), block_label(model_.system, interface.block_b),
                       1e-6 * worst_.tension, load, worst_.step);
}

} // namespace kluft

#include "kluft/simulation/bond_bending.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/simulation/overloaded_bonds.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

constexpr double clear_excess = 2.0; ///< of the tensile strength

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

} // namespace

BendingWatch::BendingWatch(const Model& model) : model_(model) {
    if (model.has_potential_cracks) interfaces_ = bonds_of_large_blocks(model);
}

void BendingWatch::step(const StepRecord& record, const State& state) {
    if (interfaces_.empty() || !record.balanced) return;
    const double factor = strength_factor(model_.loads, record.stage, record.load_factor);
    const std::vector<Strength> strengths = reduced_strengths(model_, record.stage, factor);
    const Eigen::VectorXd& q = state.body.displacement;
    for (const int i : interfaces_) {
        if (state.body.interfaces[i] != InterfaceStatus::potential_crack) continue;
        const Bond bond = bond_at(model_.system, i, q, &state.body.bond_shear[n_bond_points * i]);
        const double strength = strengths[i].tensile_strength;
        const auto [mean, tension] = normal_tractions(model_.laws[bond.law], bond, q);
        const bool is_torn = mean > clear_overload * strength; // BondWatch says so
        if (is_torn || tension <= clear_excess * strength || tension <= worst_.tension) continue;
        worst_ = {i, record.step, tension, tension / strength};
    }
}

std::string BendingWatch::warning() const {
    if (worst_.interface < 0) return {};
    const Interface& interface = model_.system.interfaces[worst_.interface];
    const std::string load = std::isfinite(worst_.load) ? fmt::format("{:.2g} times its tensile strength", worst_.load)
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

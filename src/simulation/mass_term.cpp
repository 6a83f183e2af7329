#include "kluft/simulation/mass_term.hpp"

#include <algorithm>
#include <cmath>

#include "kluft/core/disjoint_sets.hpp"
#include "kluft/simulation/whole_body.hpp"

namespace kluft {

namespace {

constexpr double growth = 16.0; ///< of eta on the blocks that stop the iteration
constexpr double decay = 4.0;   ///< after a solve in a few iterations, also of later load steps
constexpr double largest_factor = 4.0e6;
constexpr double least_factor = 1e-4; ///< of blocks on their way in a relaxation

/// The groups of bonded blocks.
DisjointSets bonded_groups(const BlockSystem& system, const std::vector<char>& bonded) {
    DisjointSets groups(system.n_blocks());
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (bonded[i]) groups.join(system.interfaces[i].block_a, system.interfaces[i].block_b);
    }
    return groups;
}

} // namespace

bool is_held(const BlockSystem& system, const std::vector<char>& bonded, const Constraints& constraints) {
    DisjointSets groups = bonded_groups(system, bonded);
    std::vector<Mat3> resistance(system.blocks.size(), Mat3::Zero());
    const WholeBody body(system);
    for (const auto& held : constraints.rows()) {
        if (held.rate != 0.0) continue; // the platen travels
        const Vec3 row = body.row(system, held);
        resistance[groups.root(held.block)] += row * row.transpose();
    }
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (groups.root(b) == b && !free_motions(resistance[b]).empty()) return false;
    }
    return true;
}

double mass_coefficient(const Model& model, double viscosity) {
    const double height = (model.system.upper - model.system.lower).maxCoeff();
    return viscosity * model.effective_modulus / (height * height);
}

std::vector<double> mass_coefficients(const Model& model, double viscosity, const std::vector<double>& factors) {
    std::vector<double> eta(model.system.blocks.size(), mass_coefficient(model, viscosity));
    for (std::size_t b = 0; b < factors.size(); ++b) eta[b] *= factors[b];
    return eta;
}

double least_mass_area(const BlockSystem& system) { return std::sqrt(0.75) * system.spacing * system.spacing; }

bool grow_mass(const std::vector<int>& blocks, std::vector<double>& factors) {
    bool grown = false;
    const auto grow = [&](double& f) {
        grown = grown || f < largest_factor;
        f = std::min(largest_factor, growth * f);
    };
    for (const int b : blocks) grow(factors[b]);
    if (blocks.empty()) std::ranges::for_each(factors, grow);
    return grown;
}

void quicken(double& factor) { factor = std::max(least_factor, factor / decay); }

void decay_mass(std::vector<double>& factors) {
    bool any = false;
    for (double& f : factors) {
        f = std::max(1.0, f / decay);
        any = any || f > 1.0;
    }
    if (!any) factors.clear();
}

} // namespace kluft

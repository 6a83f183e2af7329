#include "kluft/simulation/mass_term.hpp"

#include <cmath>

#include "kluft/core/disjoint_sets.hpp"
#include "kluft/simulation/whole_body.hpp"

namespace kluft {

namespace {

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

double least_mass_area(const BlockSystem& system) { return std::sqrt(0.75) * system.spacing * system.spacing; }

} // namespace kluft

#include "kluft/simulation/parts_at_rest.hpp"

#include "kluft/constitutive/interface_law.hpp"
#include "kluft/core/disjoint_sets.hpp"
#include "kluft/simulation/whole_body.hpp"

namespace kluft {

std::vector<char> parts_at_rest(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    const BlockSystem& system = *problem.body.system;
    const int n = system.n_blocks();
    DisjointSets parts(n);
    std::vector<int> sliding;
    std::vector<int> held;
    const auto meet = [&](int a, int b, bool holds) {
        if (!system.blocks[a].fixed && !system.blocks[b].fixed)
            parts.join(a, b);
        else if (holds)
            held.push_back(system.blocks[a].fixed ? b : a);
    };
    for (const Bond& bond : problem.body.placement->bonds) meet(bond.block_a, bond.block_b, true);
    for (const ContactPoint& point : problem.body.placement->contacts) {
        const ContactState state = contact_traction(*problem.body.laws, point, q).state;
        if (state == ContactState::open) continue;
        meet(point.block_a, point.block_b, state == ContactState::locked);
        const InterfaceLaw& law = (*problem.body.laws)[point.law];
        const bool has_shear_strength = law.tan_friction > 0.0 || law.cohesion > 0.0;
        if (state == ContactState::sliding && has_shear_strength)
            sliding.insert(sliding.end(), {point.block_a, point.block_b});
    }
    std::vector<Mat3> resistance(n, Mat3::Zero());
    const WholeBody body(system);
    for (const PrescribedDisplacement& support : problem.body.loads->constraints.rows()) {
        const Vec3 row = body.row(system, support);
        resistance[parts.root(support.block)] += row * row.transpose();
    }
    std::vector<char> rests(n, 0); // at the roots, then everywhere
    for (int b = 0; b < n; ++b) rests[b] = static_cast<char>(parts.root(b) == b && free_motions(resistance[b]).empty());
    for (const int b : held) rests[parts.root(b)] = 1;
    for (const int b : sliding) rests[parts.root(b)] = 0;
    const std::vector<char> at_root = rests;
    for (int b = 0; b < n; ++b) rests[b] = static_cast<char>(at_root[parts.root(b)] != 0 && !system.blocks[b].fixed);
    return rests;
}

} // namespace kluft

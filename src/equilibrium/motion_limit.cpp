#include "kluft/equilibrium/motion_limit.hpp"

#include <algorithm>

#include "kluft/core/disjoint_sets.hpp"

namespace kluft {

namespace {

/// Calls `visit(block_a, block_b, motion of b relative to a)` for each point where blocks are bonded or may touch; `moved`:
/// the changes of the six numbers of all blocks.
template <class Visit>
void for_relative_motions(const Placement& placement, const Eigen::VectorXd& moved, Visit visit) {
    for (const Bond& bond : placement.bonds)
        for (int k = 0; k < n_bond_points; ++k)
            visit(bond.block_a, bond.block_b, relative_displacement(bond, k, moved).norm());
    for (const ContactPoint& point : placement.contacts) {
        const Vec2 relative =
            displacement_at(moved, point.block_b, point.xi_b) - displacement_at(moved, point.block_a, point.xi_a);
        visit(point.block_a, point.block_b, relative.norm());
    }
}

/// Whether a chain of points leads from each block to a prescribed motion or a platen.
std::vector<char> are_attached(const EquilibriumProblem& problem) {
    const int n_blocks = problem.body.system->n_blocks();
    const Placement& placement = *problem.body.placement;
    DisjointSets groups(n_blocks);
    for (const Bond& bond : placement.bonds) groups.join(bond.block_a, bond.block_b);
    for (const ContactPoint& point : placement.contacts) groups.join(point.block_a, point.block_b);
    std::vector<char> is_held(n_blocks, 0); // at the root of a group
    for (const auto& row : problem.body.loads->constraints.rows()) is_held[groups.root(row.block)] = 1;
    std::vector<char> attached(n_blocks);
    for (int b = 0; b < n_blocks; ++b) attached[b] = is_held[groups.root(b)];
    return attached;
}

} // namespace

std::vector<double> motions_over_limit(const EquilibriumProblem& problem, const Coordinates& coordinates,
                                       const Eigen::VectorXd& q, const Eigen::VectorXd& increment, double share) {
    const BlockSystem& system = *problem.body.system;
    const int n_blocks = system.n_blocks();
    std::vector<double> limits(n_blocks);
    std::vector<double> over(n_blocks);
    for (int b = 0; b < n_blocks; ++b) {
        limits[b] = share * motion_scale(system, system.blocks[b]);
        over[b] = coordinates.motion(increment, b) / limits[b];
    }
    if (std::ranges::all_of(over, [](double each) { return each <= 1.0; })) return {};
    const std::vector<char> attached = are_attached(problem);
    const double limit_of_body = share * (system.upper - system.lower).maxCoeff();
    for (int b = 0; b < n_blocks; ++b) {
        if (attached[b] == 0) continue;
        over[b] = std::max(coordinates.distortion(increment, b) / limits[b],
                           coordinates.motion(increment, b) / limit_of_body);
    }
    Eigen::VectorXd moved;
    coordinates.move(q, increment, 1.0, moved);
    moved -= q;
    for_relative_motions(*problem.body.placement, moved, [&](int a, int b, double motion) {
        const double limit = std::min(limits[a], limits[b]);
        for (const int block : {a, b}) over[block] = std::max(over[block], motion / limit);
    });
    return over;
}

} // namespace kluft

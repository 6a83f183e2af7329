#include "kluft/equilibrium/boundary_terms.hpp"
#include "tangent_terms.hpp"

namespace kluft {

namespace {

void add_rigid_pair_tangent(const RigidPairMoments& moments, const Mat2& stiffness, const PairBlocks<Mat3>& blocks) {
    const auto& [n, a, b, aa, ab, bb] = moments;
    add_rigid_product(1.0, n, a, a, aa, stiffness, blocks.aa);
    add_rigid_product(-1.0, n, a, b, ab, stiffness, blocks.ab);
    add_rigid_product(-1.0, n, b, a, ab.transpose(), stiffness, blocks.ba);
    add_rigid_product(1.0, n, b, b, bb, stiffness, blocks.bb);
}

void set_bond_tangents(const EquilibriumProblem& problem, const RigidTurns& turns, BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    RowClearing clearing(matrix.rigid_values, pattern);
    for (const Bond& bond : problem.body.placement->bonds) {
        clearing.advance(std::max(bond.block_a, bond.block_b) + 1);
        RigidPairMoments moments;
        for (int k = 0; k < n_bond_points; ++k)
            moments.add(turns.lever(bond.block_a, bond.xi_a[k]), turns.lever(bond.block_b, bond.xi_b[k]));
        add_rigid_pair_tangent(
            moments, point_stiffness(bond.normal(), bond.weight, full_stiffness((*problem.body.laws)[bond.law])),
            PairBlocks(matrix.rigid_values, pattern, bond.block_a, bond.block_b));
    }
    clearing.advance(pattern.n_blocks());
}

/// d2q/dw2 = -R/h in the numbers of D: under compression the forces on D push a turning block on, and that part of the
/// stiffness is negative; only the exact tangent has it.
void add_block_tangents(const EquilibriumProblem& problem, const RigidTurns& turns,
                        const std::vector<double>& curvatures, TangentKind kind, BlockMatrix& matrix) {
    const BlockSystem& system = *problem.body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        Mat3& diagonal = matrix.rigid_values[matrix.pattern->diagonal(b)];
        diagonal(2, 2) += kind == TangentKind::exact ? curvatures[b] : std::max(0.0, curvatures[b]);
        if (problem.eta.empty()) continue;
        diagonal += problem.eta[b] * turns.reduced(mass_matrix(system.blocks[b], problem.least_mass_area), b);
    }
}

void add_tilt_tangent(const TiltTangent& tilt, const ContactPoint& point, const RigidTurns& turns,
                      const PairBlocks<Mat3>& blocks) {
    const Vec3 force_a = turns.reduced_forces(tilt.force_a, point.block_a);
    const Vec3 force_b = turns.reduced_forces(tilt.force_b, point.block_b);
    const Vec3 row_a = turns.reduced_forces(tilt.row_a, point.block_a);
    const Vec3 row_b = turns.reduced_forces(tilt.row_b, point.block_b);
    blocks.aa += force_a * row_a.transpose();
    blocks.ab += force_a * row_b.transpose();
    blocks.ba += force_b * row_a.transpose();
    blocks.bb += force_b * row_b.transpose();
}

void add_contact_tangents(const EquilibriumProblem& problem, const RigidTurns& turns, const Eigen::VectorXd& q,
                          TangentKind kind, BlockMatrix& matrix) {
    for (const ContactPoint& point : problem.body.placement->contacts) {
        const auto [tangent, by_tilt] = point_tangent(problem, point, q, kind);
        if (tangent.isZero(0.0) && by_tilt.isZero(0.0)) continue;
        const PairBlocks blocks(matrix.rigid_values, *matrix.pattern, point.block_a, point.block_b);
        RigidPairMoments moments;
        moments.add(turns.lever(point.block_a, point.xi_a), turns.lever(point.block_b, point.xi_b));
        add_rigid_pair_tangent(moments, point_stiffness(point.normal, point.weight, tangent), blocks);
        if (!by_tilt.isZero(0.0)) add_tilt_tangent({point, by_tilt}, point, turns, blocks);
    }
}

void add_pressure_tangents(const EquilibriumProblem& problem, const RigidTurns& turns, const Eigen::VectorXd& q,
                           BlockMatrix& matrix) {
    for (const PressureEdge& edge : problem.body.loads->pressure_edges) {
        const double pressure = problem.body.loads->pressures[edge.boundary];
        if (pressure == 0.0) continue;
        Mat6 stiffness = Mat6::Zero();
        add_pressure_tangent(edge, pressure, q, stiffness);
        matrix.rigid_values[matrix.pattern->diagonal(edge.block)] += turns.reduced(stiffness, edge.block);
    }
}

} // namespace

void rigid_tangent(const EquilibriumProblem& problem, const RigidTurns& turns, const std::vector<double>& curvatures,
                   const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) {
    set_bond_tangents(problem, turns, matrix);
    add_block_tangents(problem, turns, curvatures, kind, matrix);
    add_contact_tangents(problem, turns, q, kind, matrix);
    if (kind == TangentKind::exact) add_pressure_tangents(problem, turns, q, matrix);
}

} // namespace kluft

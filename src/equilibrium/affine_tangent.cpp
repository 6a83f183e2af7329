#include <array>

#include "kluft/equilibrium/boundary_terms.hpp"
#include "kluft/kinematics/affine.hpp"
#include "tangent_terms.hpp"

namespace kluft {

namespace {

/// (1, xi): the weights of u, D's first and D's second column in the displacement of a point.
using Shape = std::array<double, 3>;
Shape shape(const Vec2& xi) { return {1.0, xi.x(), xi.y()}; }

/// Sums of s s^T over points of a pair with the same stiffness, s the shape on either side. Not Eigen's matrices: they
/// would stop in memory between single and paired numbers.
struct PairMoments {
    using Moments = std::array<Shape, 3>;
    Moments aa{};
    Moments ab{};
    Moments bb{};

    void add(const Vec2& xi_a, const Vec2& xi_b) {
        const Shape a = shape(xi_a);
        const Shape b = shape(xi_b);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                aa[i][j] += a[i] * a[j];
                ab[i][j] += a[i] * b[j];
                bb[i][j] += b[i] * b[j];
            }
        }
    }
};

/// Adds the Kronecker product of moments (transposed or not) and a stiffness.
template <bool transposed>
void add_product(const PairMoments::Moments& moments, const Vec2& first_column, const Vec2& second_column,
                 Mat6& block) {
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            const double moment = transposed ? moments[j][i] : moments[i][j];
            block.col(2 * j).segment<2>(2 * i) += moment * first_column;
            block.col(2 * j + 1).segment<2>(2 * i) += moment * second_column;
        }
    }
}

void add_pair_tangent(const PairMoments& moments, const Mat2& stiffness, const PairBlocks<Mat6>& blocks) {
    const Vec2 first = stiffness.col(0);
    const Vec2 second = stiffness.col(1);
    add_product<false>(moments.aa, first, second, blocks.aa);
    add_product<false>(moments.ab, -first, -second, blocks.ab);
    add_product<true>(moments.ab, -first, -second, blocks.ba);
    add_product<false>(moments.bb, first, second, blocks.bb);
}

/// The bonds are in the order of their lower block, so that only a band of rows is in use at a time.
void set_bond_tangents(const EquilibriumProblem& problem, BlockMatrix& matrix) {
    const BlockPattern& pattern = *matrix.pattern;
    RowClearing clearing(matrix.values, pattern);
    for (const Bond& bond : problem.body.placement->bonds) {
        clearing.advance(std::max(bond.block_a, bond.block_b) + 1);
        const Mat2 stiffness =
            point_stiffness(bond.normal(), bond.weight, full_stiffness((*problem.body.laws)[bond.law]));
        PairMoments moments;
        for (int k = 0; k < n_bond_points; ++k) moments.add(bond.xi_a[k], bond.xi_b[k]);
        add_pair_tangent(moments, stiffness, PairBlocks(matrix.values, pattern, bond.block_a, bond.block_b));
    }
    clearing.advance(pattern.n_blocks());
}

void add_block_tangents(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
                        BlockMatrix& matrix) {
    const BlockSystem& system = *problem.body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        Mat6& diagonal = matrix.values[matrix.pattern->diagonal(b)];
        if (!problem.eta.empty()) diagonal += problem.eta[b] * mass_matrix(block, problem.least_mass_area);
        diagonal.block<4, 4>(2, 2) += elastic_tangent(
            deformation_gradient(q, b, block.size), (*problem.body.moduli)[block.material], kind != TangentKind::exact);
    }
}

void add_tilt_tangent(const TiltTangent& tilt, const PairBlocks<Mat6>& blocks) {
    blocks.aa += tilt.force_a * tilt.row_a.transpose();
    blocks.ab += tilt.force_a * tilt.row_b.transpose();
    blocks.ba += tilt.force_b * tilt.row_a.transpose();
    blocks.bb += tilt.force_b * tilt.row_b.transpose();
}

void add_contact_tangents(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
                          BlockMatrix& matrix) {
    for (const ContactPoint& point : problem.body.placement->contacts) {
        const auto [tangent, by_tilt] = point_tangent(problem, point, q, kind);
        if (tangent.isZero(0.0) && by_tilt.isZero(0.0)) continue;
        const PairBlocks blocks(matrix.values, *matrix.pattern, point.block_a, point.block_b);
        PairMoments moments;
        moments.add(point.xi_a, point.xi_b);
        add_pair_tangent(moments, point_stiffness(point.normal, point.weight, tangent), blocks);
        if (!by_tilt.isZero(0.0)) add_tilt_tangent({point, by_tilt}, blocks);
    }
}

void add_pressure_tangents(const EquilibriumProblem& problem, const Eigen::VectorXd& q, BlockMatrix& matrix) {
    for (const PressureEdge& edge : problem.body.loads->pressure_edges) {
        const double pressure = problem.body.loads->pressures[edge.boundary];
        if (pressure == 0.0) continue;
        add_pressure_tangent(edge, pressure, q, matrix.values[matrix.pattern->diagonal(edge.block)]);
    }
}

} // namespace

void affine_tangent(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind,
                    BlockMatrix& matrix) {
    set_bond_tangents(problem, matrix);
    add_block_tangents(problem, q, kind, matrix);
    add_contact_tangents(problem, q, kind, matrix);
    if (kind == TangentKind::exact) add_pressure_tangents(problem, q, matrix);
}

} // namespace kluft

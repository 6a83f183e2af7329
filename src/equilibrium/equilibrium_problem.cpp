#include "kluft/equilibrium/equilibrium_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double touching_gap = 1e-6; ///< of the lattice spacing

/// (1, xi): the weights of u, D's first and D's second column in the displacement of a point.
using Shape = std::array<double, 3>;
Shape shape(const Vec2& xi) { return {1.0, xi.x(), xi.y()}; }

/// Sets the rows of a matrix to zero shortly before they are used: what is then added finds them in the cache.
class RowClearing {
public:
    RowClearing(BlockMatrix& matrix, const BlockPattern& pattern) : matrix_(matrix), pattern_(pattern) {
        matrix.pattern = &pattern;
        matrix.values.resize(static_cast<std::size_t>(pattern.n_entries()));
    }
    /// All rows below `row_end`, as far as they are not zero yet.
    void advance(int row_end) {
        if (row_end <= n_cleared_) return;
        std::fill(matrix_.values.begin() + pattern_.row_start(n_cleared_),
                  matrix_.values.begin() + pattern_.row_start(row_end), Mat6::Zero());
        n_cleared_ = row_end;
    }

private:
    BlockMatrix& matrix_;
    const BlockPattern& pattern_;
    int n_cleared_ = 0;
};

/// The four blocks of the matrix that a pair of blocks has.
struct PairBlocks {
    PairBlocks(BlockMatrix& matrix, int a, int b)
        : aa(matrix.values[matrix.pattern->diagonal(a)]), ab(matrix.values[matrix.pattern->find(a, b)]),
          ba(matrix.values[matrix.pattern->find(b, a)]), bb(matrix.values[matrix.pattern->diagonal(b)]) {}
    Mat6 &aa, &ab, &ba, &bb;
};

/// `tangent`: of the traction with respect to (gap, slip), in the frame of `normal` (Pa/m).
Mat2 point_stiffness(const Vec2& normal, double weight, const Mat2& tangent) {
    Mat2 frame;
    frame << normal, Vec2(-normal.y(), normal.x());
    return weight * frame * tangent * frame.transpose();
}

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

void add_pair_tangent(const PairMoments& moments, const Mat2& stiffness, const PairBlocks& blocks) {
    const Vec2 first = stiffness.col(0);
    const Vec2 second = stiffness.col(1);
    add_product<false>(moments.aa, first, second, blocks.aa);
    add_product<false>(moments.ab, -first, -second, blocks.ab);
    add_product<true>(moments.ab, -first, -second, blocks.ba);
    add_product<false>(moments.bb, first, second, blocks.bb);
}

Mat2 full_stiffness(const InterfaceLaw& law) {
    return Eigen::Vector2d(law.normal_stiffness, law.shear_stiffness).asDiagonal();
}

struct GapAndSlip {
    double gap;
    double slip;
};

GapAndSlip gap_and_slip(const ContactPoint& point, const Eigen::VectorXd& q) {
    const Vec2 relative = relative_position(point, q);
    return {point.normal.dot(relative), point.tangent.dot(relative) - point.slip_start};
}

PointTraction traction_of(const std::vector<InterfaceLaw>& laws, const ContactPoint& point, const Eigen::VectorXd& q) {
    const auto [gap, slip] = gap_and_slip(point, q);
    return fracture_traction(laws[point.law], point.history, gap, slip);
}

Mat2 point_tangent(const EquilibriumProblem& problem, const ContactPoint& point, const Eigen::VectorXd& q,
                   TangentKind kind) {
    if (kind == TangentKind::touching) {
        const bool touches = gap_and_slip(point, q).gap <= touching_gap * problem.system->spacing;
        return touches ? full_stiffness((*problem.laws)[point.law]) : Mat2(Mat2::Zero());
    }
    const PointTraction traction = traction_of(*problem.laws, point, q);
    if (traction.state == ContactState::open) return Mat2::Zero();
    return kind == TangentKind::symmetric ? symmetric_tangent(traction) : traction.tangent;
}

} // namespace

Mat6 mass_matrix(const Block& block, double least_area) {
    const double factor = std::max(1.0, least_area / block.area);
    Mat6 m = Mat6::Zero();
    m.block<2, 2>(0, 0) = factor * block.area * Mat2::Identity();
    const Mat2 second = factor * block.second_moment / (block.size * block.size);
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) m.block<2, 2>(2 + 2 * i, 2 + 2 * j) = second(i, j) * Mat2::Identity();
    }
    return m;
}

Mat2 symmetric_tangent(const PointTraction& traction) {
    Mat2 tangent = Mat2::Zero();
    tangent(0, 0) = std::max(0.0, traction.tangent(0, 0));
    tangent(1, 1) = traction.state == ContactState::locked ? std::max(0.0, traction.tangent(1, 1)) : 0.0;
    return tangent;
}

PointTraction contact_traction(const EquilibriumProblem& problem, int i, const Eigen::VectorXd& q) {
    return traction_of(*problem.laws, problem.contacts[i], q);
}

PointTraction bond_traction(const EquilibriumProblem& problem, int i, int point, const Eigen::VectorXd& q) {
    const Bond& bond = problem.bonds[i];
    return bond_traction((*problem.laws)[bond.law], bond, point, q);
}

// ---- the residual ------------------------------------------------------------------------------------------------------

/// The sums that R and F_ref are made of, size 6 n_blocks.
struct EquilibriumEvaluator::Sums {
    Eigen::VectorXd& forces;
    Eigen::VectorXd& magnitudes;
    double stiffest = 0.0; ///< of the springs and blocks met so far (Pa)

    void add(int block, const Vec2& xi, const Vec2& force) {
        add_force(forces, block, xi, force);
        add_force(magnitudes, block, xi.cwiseAbs(), force.cwiseAbs());
    }
};

void EquilibriumEvaluator::residual(const Eigen::VectorXd& q, Residual& result) {
    result.forces.setZero(q.size());
    magnitudes_.setZero(q.size());
    Sums sums{result.forces, magnitudes_};
    add_block_forces(q, sums);
    add_bond_forces(q, sums);
    add_contact_forces(q, sums);
    add_pressures(q, sums);
    if (!problem_.eta.empty()) add_mass_forces(q, result.forces);
    result.force_scale = magnitudes_.norm();
    result.roundoff = 64.0 * std::numeric_limits<double>::epsilon() * sums.stiffest * q.lpNorm<Eigen::Infinity>() *
                      std::sqrt(static_cast<double>(q.size()));
}

void EquilibriumEvaluator::add_block_forces(const Eigen::VectorXd& q, Sums& sums) const {
    const BlockSystem& system = *problem_.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        const ElasticModuli& moduli = (*problem_.moduli)[block.material];
        const Mat2 force = block.size * stress_of_gradient(displacement_gradient(q, b, block.size), moduli);
        const Eigen::Map<const Eigen::Vector4d> columns(force.data());
        sums.forces.segment<4>(n_block_unknowns * b + 2) += columns;
        sums.magnitudes.segment<4>(n_block_unknowns * b + 2) += columns.cwiseAbs();
        sums.stiffest = std::max(sums.stiffest, 2.0 * moduli.mu + moduli.lambda);
        if (!problem_.densities.empty()) {
            const Vec2 weight = problem_.densities[block.material] * block.area * problem_.gravity;
            sums.forces.segment<2>(n_block_unknowns * b) -= weight;
            sums.magnitudes.segment<2>(n_block_unknowns * b) += weight.cwiseAbs();
        }
    }
}

/// Interface forces are internal: R gets +f on b where f is what b's opening stretches.
void EquilibriumEvaluator::add_bond_forces(const Eigen::VectorXd& q, Sums& sums) const {
    for (const Bond& bond : problem_.bonds) {
        const InterfaceLaw& law = (*problem_.laws)[bond.law];
        for (int k = 0; k < n_bond_points; ++k) {
            const auto traction = bond_traction(law, bond, k, q);
            const Vec2 force = bond.weight * (traction.normal * bond.normal() + traction.shear * bond.tangent);
            sums.add(bond.block_b, bond.xi_b[k], force);
            sums.add(bond.block_a, bond.xi_a[k], -force);
        }
        sums.stiffest = std::max(sums.stiffest, bond.weight * law.normal_stiffness);
    }
}

void EquilibriumEvaluator::add_contact_forces(const Eigen::VectorXd& q, Sums& sums) const {
    for (const ContactPoint& point : problem_.contacts) {
        const auto traction = traction_of(*problem_.laws, point, q);
        const Vec2 force = point.weight * (traction.normal * point.normal + traction.shear * point.tangent);
        sums.add(point.block_b, point.xi_b, force);
        sums.add(point.block_a, point.xi_a, -force);
        sums.stiffest = std::max(sums.stiffest, point.weight * (*problem_.laws)[point.law].normal_stiffness);
    }
}

void EquilibriumEvaluator::add_pressures(const Eigen::VectorXd& q, Sums& sums) const {
    for (const PressureEdge& edge : problem_.pressure_edges) {
        const double pressure = problem_.pressures[edge.boundary];
        if (pressure != 0.0) sums.add(edge.block, edge.xi_middle, -pressure_force(edge, pressure, q));
    }
}

void EquilibriumEvaluator::add_mass_forces(const Eigen::VectorXd& q, Eigen::VectorXd& forces) const {
    const BlockSystem& system = *problem_.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem_.start.segment<n_block_unknowns>(n_block_unknowns * b);
        forces.segment<n_block_unknowns>(n_block_unknowns * b) +=
            problem_.eta[b] * (mass_matrix(system.blocks[b], problem_.least_mass_area) * moved);
    }
}

// ---- its derivative ----------------------------------------------------------------------------------------------------

void EquilibriumEvaluator::tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const {
    set_bond_tangents(matrix);
    add_block_tangents(q, kind, matrix);
    add_contact_tangents(q, kind, matrix);
    if (kind != TangentKind::exact) return;
    for (const PressureEdge& edge : problem_.pressure_edges) {
        const double pressure = problem_.pressures[edge.boundary];
        if (pressure == 0.0) continue;
        add_pressure_tangent(edge, pressure, matrix.values[pattern_.diagonal(edge.block)]);
    }
}

void EquilibriumEvaluator::add_block_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const {
    const BlockSystem& system = *problem_.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        Mat6& diagonal = matrix.values[pattern_.diagonal(b)];
        if (!problem_.eta.empty()) diagonal += problem_.eta[b] * mass_matrix(block, problem_.least_mass_area);
        diagonal.block<4, 4>(2, 2) += elastic_tangent(deformation_gradient(q, b, block.size),
                                                      (*problem_.moduli)[block.material], kind != TangentKind::exact);
    }
}

/// The bonds are in the order of their lower block, so that only a band of rows is in use at a time.
void EquilibriumEvaluator::set_bond_tangents(BlockMatrix& matrix) const {
    RowClearing clearing(matrix, pattern_);
    for (const Bond& bond : problem_.bonds) {
        clearing.advance(std::max(bond.block_a, bond.block_b) + 1);
        const Mat2 stiffness = point_stiffness(bond.normal(), bond.weight, full_stiffness((*problem_.laws)[bond.law]));
        PairMoments moments;
        for (int k = 0; k < n_bond_points; ++k) moments.add(bond.xi_a[k], bond.xi_b[k]);
        add_pair_tangent(moments, stiffness, PairBlocks(matrix, bond.block_a, bond.block_b));
    }
    clearing.advance(pattern_.n_blocks());
}

void EquilibriumEvaluator::add_contact_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const {
    for (const ContactPoint& point : problem_.contacts) {
        const Mat2 tangent = point_tangent(problem_, point, q, kind);
        if (tangent.isZero(0.0)) continue;
        PairMoments moments;
        moments.add(point.xi_a, point.xi_b);
        add_pair_tangent(moments, point_stiffness(point.normal, point.weight, tangent),
                         PairBlocks(matrix, point.block_a, point.block_b));
    }
}

double viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    if (problem.eta.empty()) return 0.0;
    double sum = 0.0;
    for (int b = 0; b < problem.system->n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem.start.segment<n_block_unknowns>(n_block_unknowns * b);
        sum += (problem.eta[b] * mass_matrix(problem.system->blocks[b], problem.least_mass_area) * moved).squaredNorm();
    }
    return std::sqrt(sum);
}

std::vector<Mat2> block_stresses(const BlockSystem& system, const std::vector<ElasticModuli>& moduli,
                                 const Eigen::VectorXd& q) {
    std::vector<Mat2> stresses;
    stresses.reserve(system.blocks.size());
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        stresses.push_back(cauchy_stress(deformation_gradient(q, b, block.size), moduli[block.material]));
    }
    return stresses;
}

} // namespace kluft

#include "kluft/equilibrium/equilibrium_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double touching_gap = 1e-6; ///< of the lattice spacing
/// Smallest pieces of a net have 1/20 of a hexagon. What is smaller was given so, and with the mass of a hexagon it would
/// not settle on its contacts.
constexpr double largest_mass_growth = 20.0;

/// (1, xi): the weights of u, D's first and D's second column in the displacement of a point.
using Shape = std::array<double, 3>;
Shape shape(const Vec2& xi) { return {1.0, xi.x(), xi.y()}; }

/// Sets the rows of a matrix to zero shortly before they are used: what is then added finds them in the cache.
template <class Block> class RowClearing {
public:
    RowClearing(std::vector<Block>& values, const BlockPattern& pattern) : values_(values), pattern_(pattern) {
        values.resize(static_cast<std::size_t>(pattern.n_entries()));
    }
    /// All rows below `row_end`, as far as they are not zero yet.
    void advance(int row_end) {
        if (row_end <= n_cleared_) return;
        std::fill(values_.begin() + pattern_.row_start(n_cleared_), values_.begin() + pattern_.row_start(row_end),
                  Block::Zero());
        n_cleared_ = row_end;
    }

private:
    std::vector<Block>& values_;
    const BlockPattern& pattern_;
    int n_cleared_ = 0;
};

/// The four blocks of the matrix that a pair of blocks has.
template <class Block> struct PairBlocks {
    PairBlocks(std::vector<Block>& values, const BlockPattern& pattern, int a, int b)
        : aa(values[pattern.diagonal(a)]), ab(values[pattern.find(a, b)]), ba(values[pattern.find(b, a)]),
          bb(values[pattern.diagonal(b)]) {}
    Block &aa, &ab, &ba, &bb;
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

void add_pair_tangent(const PairMoments& moments, const Mat2& stiffness, const PairBlocks<Mat6>& blocks) {
    const Vec2 first = stiffness.col(0);
    const Vec2 second = stiffness.col(1);
    add_product<false>(moments.aa, first, second, blocks.aa);
    add_product<false>(moments.ab, -first, -second, blocks.ab);
    add_product<true>(moments.ab, -first, -second, blocks.ba);
    add_product<false>(moments.bb, first, second, blocks.bb);
}

void add_rigid_pair_tangent(const RigidPairMoments& moments, const Mat2& stiffness, const PairBlocks<Mat3>& blocks) {
    const auto& [n, a, b, aa, ab, bb] = moments;
    add_rigid_product(1.0, n, a, a, aa, stiffness, blocks.aa);
    add_rigid_product(-1.0, n, a, b, ab, stiffness, blocks.ab);
    add_rigid_product(-1.0, n, b, a, ab.transpose(), stiffness, blocks.ba);
    add_rigid_product(1.0, n, b, b, bb, stiffness, blocks.bb);
}

Mat2 full_stiffness(const InterfaceLaw& law) {
    return Eigen::Vector2d(law.normal_stiffness, law.shear_stiffness).asDiagonal();
}

Mat2 point_tangent(const EquilibriumProblem& problem, const ContactPoint& point, const Eigen::VectorXd& q,
                   TangentKind kind) {
    if (kind == TangentKind::touching) {
        const bool touches = gap_and_slip(point, q).gap <= touching_gap * problem.body.system->spacing;
        return touches ? full_stiffness((*problem.body.laws)[point.law]) : Mat2(Mat2::Zero());
    }
    const PointTraction traction = contact_traction(*problem.body.laws, point, q);
    if (traction.state == ContactState::open) return Mat2::Zero();
    return kind == TangentKind::symmetric ? symmetric_tangent(traction) : traction.tangent;
}

} // namespace

Mat6 mass_matrix(const Block& block, double least_area) {
    return area_matrix(block, std::clamp(least_area / block.area, 1.0, largest_mass_growth));
}

Mat2 symmetric_tangent(const PointTraction& traction) {
    Mat2 tangent = Mat2::Zero();
    tangent(0, 0) = std::max(0.0, traction.tangent(0, 0));
    tangent(1, 1) = traction.state == ContactState::locked ? std::max(0.0, traction.tangent(1, 1)) : 0.0;
    return tangent;
}

// ---- the residual ------------------------------------------------------------------------------------------------------

void EquilibriumEvaluator::residual(const Eigen::VectorXd& q, Residual& result) {
    body_forces(problem_.body, q, body_forces_);
    result.forces.swap(body_forces_.forces);
    if (!problem_.eta.empty()) add_mass_forces(q, result.forces);
    if (problem_.body.kinematics == Kinematics::rigid) {
        turned_to_ = q;
        turns_.set(*problem_.body.system, q);
        turns_.curvatures(*problem_.body.system, result.forces, curvatures_);
        result.force_scale = turns_.norm_of_magnitudes(body_forces_.magnitudes);
    } else {
        result.force_scale = body_forces_.magnitudes.norm();
    }
    result.roundoff = 64.0 * std::numeric_limits<double>::epsilon() * body_forces_.stiffest *
                      q.lpNorm<Eigen::Infinity>() * std::sqrt(static_cast<double>(q.size()));
}

void EquilibriumEvaluator::reduce_to_unknowns(const Eigen::VectorXd& forces, Eigen::VectorXd& reduced) const {
    turns_.reduce(forces, reduced);
}

void EquilibriumEvaluator::add_mass_forces(const Eigen::VectorXd& q, Eigen::VectorXd& forces) const {
    const BlockSystem& system = *problem_.body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem_.start.segment<n_block_unknowns>(n_block_unknowns * b);
        forces.segment<n_block_unknowns>(n_block_unknowns * b) +=
            problem_.eta[b] * (mass_matrix(system.blocks[b], problem_.least_mass_area) * moved);
    }
}

// ---- its derivative ----------------------------------------------------------------------------------------------------

void EquilibriumEvaluator::tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) {
    matrix.pattern = &pattern_;
    if (problem_.body.kinematics == Kinematics::rigid) return rigid_tangent(q, kind, matrix);
    set_bond_tangents(matrix);
    add_block_tangents(q, kind, matrix);
    add_contact_tangents(q, kind, matrix);
    if (kind == TangentKind::exact) {
        for (const PressureEdge& edge : problem_.body.loads->pressure_edges) {
            const double pressure = problem_.body.loads->pressures[edge.boundary];
            if (pressure == 0.0) continue;
            add_pressure_tangent(edge, pressure, matrix.values[pattern_.diagonal(edge.block)]);
        }
    }
}

void EquilibriumEvaluator::rigid_tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) {
    if (turned_to_.size() != q.size() || turned_to_ != q) {
        Residual unused;
        residual(q, unused);
    }
    set_rigid_bond_tangents(matrix);
    add_rigid_block_tangents(kind, matrix);
    add_rigid_contact_tangents(q, kind, matrix);
    if (kind != TangentKind::exact) return;
    for (const PressureEdge& edge : problem_.body.loads->pressure_edges) {
        const double pressure = problem_.body.loads->pressures[edge.boundary];
        if (pressure == 0.0) continue;
        Mat6 stiffness = Mat6::Zero();
        add_pressure_tangent(edge, pressure, stiffness);
        matrix.rigid_values[pattern_.diagonal(edge.block)] += turns_.reduced(stiffness, edge.block);
    }
}

void EquilibriumEvaluator::set_rigid_bond_tangents(BlockMatrix& matrix) const {
    RowClearing clearing(matrix.rigid_values, pattern_);
    for (const Bond& bond : problem_.body.placement->bonds) {
        clearing.advance(std::max(bond.block_a, bond.block_b) + 1);
        RigidPairMoments moments;
        for (int k = 0; k < n_bond_points; ++k)
            moments.add(turns_.lever(bond.block_a, bond.xi_a[k]), turns_.lever(bond.block_b, bond.xi_b[k]));
        add_rigid_pair_tangent(
            moments, point_stiffness(bond.normal(), bond.weight, full_stiffness((*problem_.body.laws)[bond.law])),
            PairBlocks(matrix.rigid_values, pattern_, bond.block_a, bond.block_b));
    }
    clearing.advance(pattern_.n_blocks());
}

void EquilibriumEvaluator::add_rigid_contact_tangents(const Eigen::VectorXd& q, TangentKind kind,
                                                      BlockMatrix& matrix) const {
    for (const ContactPoint& point : problem_.body.placement->contacts) {
        const Mat2 tangent = point_tangent(problem_, point, q, kind);
        if (tangent.isZero(0.0)) continue;
        RigidPairMoments moments;
        moments.add(turns_.lever(point.block_a, point.xi_a), turns_.lever(point.block_b, point.xi_b));
        add_rigid_pair_tangent(moments, point_stiffness(point.normal, point.weight, tangent),
                               PairBlocks(matrix.rigid_values, pattern_, point.block_a, point.block_b));
    }
}

/// d2q/dw2 = -R/h in the numbers of D: under compression the forces on D push a turning block on, and that part of the
/// stiffness is negative; only the exact tangent has it.
void EquilibriumEvaluator::add_rigid_block_tangents(TangentKind kind, BlockMatrix& matrix) const {
    const BlockSystem& system = *problem_.body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        Mat3& diagonal = matrix.rigid_values[pattern_.diagonal(b)];
        diagonal(2, 2) += kind == TangentKind::exact ? curvatures_[b] : std::max(0.0, curvatures_[b]);
        if (problem_.eta.empty()) continue;
        diagonal += problem_.eta[b] * turns_.reduced(mass_matrix(system.blocks[b], problem_.least_mass_area), b);
    }
}

void EquilibriumEvaluator::add_block_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const {
    const BlockSystem& system = *problem_.body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        Mat6& diagonal = matrix.values[pattern_.diagonal(b)];
        if (!problem_.eta.empty()) diagonal += problem_.eta[b] * mass_matrix(block, problem_.least_mass_area);
        diagonal.block<4, 4>(2, 2) +=
            elastic_tangent(deformation_gradient(q, b, block.size), (*problem_.body.moduli)[block.material],
                            kind != TangentKind::exact);
    }
}

/// The bonds are in the order of their lower block, so that only a band of rows is in use at a time.
void EquilibriumEvaluator::set_bond_tangents(BlockMatrix& matrix) const {
    RowClearing clearing(matrix.values, pattern_);
    for (const Bond& bond : problem_.body.placement->bonds) {
        clearing.advance(std::max(bond.block_a, bond.block_b) + 1);
        const Mat2 stiffness =
            point_stiffness(bond.normal(), bond.weight, full_stiffness((*problem_.body.laws)[bond.law]));
        PairMoments moments;
        for (int k = 0; k < n_bond_points; ++k) moments.add(bond.xi_a[k], bond.xi_b[k]);
        add_pair_tangent(moments, stiffness, PairBlocks(matrix.values, pattern_, bond.block_a, bond.block_b));
    }
    clearing.advance(pattern_.n_blocks());
}

void EquilibriumEvaluator::add_contact_tangents(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) const {
    for (const ContactPoint& point : problem_.body.placement->contacts) {
        const Mat2 tangent = point_tangent(problem_, point, q, kind);
        if (tangent.isZero(0.0)) continue;
        PairMoments moments;
        moments.add(point.xi_a, point.xi_b);
        add_pair_tangent(moments, point_stiffness(point.normal, point.weight, tangent),
                         PairBlocks(matrix.values, pattern_, point.block_a, point.block_b));
    }
}

double viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    if (problem.eta.empty()) return 0.0;
    double sum = 0.0;
    for (int b = 0; b < problem.body.system->n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem.start.segment<n_block_unknowns>(n_block_unknowns * b);
        const Block& block = problem.body.system->blocks[b];
        if (problem.body.kinematics == Kinematics::rigid) {
            const Vec6 force = problem.eta[b] * (mass_matrix(block, problem.least_mass_area) * moved);
            sum += (rigid_motion(q, b, block.size).transpose() * force).squaredNorm();
            continue;
        }
        sum += (problem.eta[b] * mass_matrix(block, problem.least_mass_area) * moved).squaredNorm();
    }
    return std::sqrt(sum);
}

} // namespace kluft

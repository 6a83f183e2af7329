#include "kluft/loading/boundary_loads.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "kluft/core/dense_decompositions.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

/// Rows of a block whose singular values are below this part of the largest are taken as dependent.
constexpr double rank_tolerance = 1e-8;
/// Prescribed rates of a block that no motion meets to this part of the largest contradict each other.
constexpr double contradiction = 1e-6;
/// Cosine of the turn from which on the pressure on an edge fades: of 80 degrees.
constexpr double fading_cosine = 0.17364817766693036;

/// Projector onto the null space of the rows of `matrix`, and its pseudo-inverse.
template <int n>
void decompose(const Eigen::MatrixXd& matrix, Eigen::Matrix<double, n, n>& projector,
               Eigen::Matrix<double, n, Eigen::Dynamic>& inverse) {
    const SingularValues singular = singular_values(matrix);
    const Eigen::Index rank = singular.rank(rank_tolerance);
    const Eigen::MatrixXd range = singular.v.leftCols(rank);
    projector.setZero(); // exactly, where nothing is left free
    if (rank < n) projector = Eigen::Matrix<double, n, n>::Identity() - range * range.transpose();
    inverse = pseudo_inverse(singular, rank);
}

} // namespace

std::vector<PressureEdge> pressure_edges(const BlockSystem& system, int boundary) {
    std::vector<PressureEdge> edges;
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        const Block& block = system.blocks[b];
        const Vec2& start = edge_start(system, block.edges[e]);
        const Vec2& end = edge_end(system, block.edges[e]);
        edges.push_back(
            {b, boundary, block_coordinates(block, 0.5 * (start + end)), end - start, (end - start) / block.size});
    }
    return edges;
}

Vec2 current_extent(const PressureEdge& edge, const Eigen::VectorXd& q) {
    const double* v = q.data() + n_block_unknowns * edge.block;
    return edge.extent + Vec2(v[2], v[3]) * edge.xi_extent.x() + Vec2(v[4], v[5]) * edge.xi_extent.y();
}

PressedShare pressed_share(const PressureEdge& edge, const Vec2& extent) {
    const Vec2 slope = edge.extent / (edge.extent.squaredNorm() * fading_cosine);
    const double share = extent.dot(slope);
    if (share >= 1.0) return {};
    if (share <= 0.0) return {.value = 0.0};
    return {share, slope};
}

Vec2 pressure_force(const PressureEdge& edge, double pressure, const Eigen::VectorXd& q) {
    const Vec2 extent = current_extent(edge, q);
    return -pressure * pressed_share(edge, extent).value * right_normal(extent);
}

Constraints::Constraints(std::vector<PrescribedDisplacement> rows) : rows_(std::move(rows)) {
    std::map<int, std::vector<int>> by_block;
    for (int r = 0; r < static_cast<int>(rows_.size()); ++r) by_block[rows_[r].block].push_back(r);
    for (const auto& [block, indices] : by_block) {
        Eigen::MatrixXd matrix(indices.size(), n_block_unknowns);
        for (std::size_t i = 0; i < indices.size(); ++i) {
            const auto& row = rows_[indices[i]];
            matrix.row(i) = displacement_row(row.direction, row.xi).transpose();
        }
        ConstrainedBlock& constrained = blocks_.emplace_back();
        constrained.block = block;
        constrained.rows = indices;
        decompose<n_block_unknowns>(matrix, constrained.projector, constrained.inverse);
    }
}

Constraints::Constraints(std::vector<PrescribedDisplacement> rows, const BlockSystem& system, const Eigen::VectorXd& q)
    : Constraints(std::move(rows)) {
    kinematics_ = Kinematics::rigid;
    for (ConstrainedBlock& c : blocks_) {
        c.motion = rigid_motion(q, c.block, system.blocks[c.block].size);
        Eigen::MatrixXd matrix(c.rows.size(), n_rigid_unknowns);
        for (std::size_t i = 0; i < c.rows.size(); ++i) {
            const auto& row = rows_[c.rows[i]];
            matrix.row(i) = displacement_row(row.direction, row.xi).transpose() * c.motion;
        }
        decompose<n_rigid_unknowns>(matrix, c.rigid_projector, c.rigid_inverse);
    }
}

void Constraints::correction(const Eigen::VectorXd& q, Eigen::VectorXd& dq, double roundoff) const {
    const bool rigid = kinematics_ == Kinematics::rigid;
    dq.setZero(rigid ? q.size() / n_block_unknowns * n_rigid_unknowns : q.size());
    const auto missing_at = [&](const PrescribedDisplacement& row) {
        return row.target - row.direction.dot(displacement_at(q, row.block, row.xi));
    };
    double travel = 0.0;
    double squares = 0.0;
    for (const auto& row : rows_) {
        travel -= row.rate * missing_at(row);
        squares += row.rate * row.rate;
    }
    if (squares > 0.0) travel /= squares;
    for (const ConstrainedBlock& c : blocks_) {
        Eigen::VectorXd missing(c.rows.size());
        for (std::size_t i = 0; i < c.rows.size(); ++i) {
            const auto& row = rows_[c.rows[i]];
            missing[i] = missing_at(row) + row.rate * travel;
        }
        if (missing.lpNorm<Eigen::Infinity>() <= roundoff) continue;
        if (rigid) {
            dq.segment<n_rigid_unknowns>(n_rigid_unknowns * c.block) = c.rigid_inverse * missing;
        } else {
            dq.segment<n_block_unknowns>(n_block_unknowns * c.block) = c.inverse * missing;
        }
    }
}

void Constraints::move_to(double load_factor) {
    for (PrescribedDisplacement& row : rows_) row.target = row.start + load_factor * row.velocity;
}

int Constraints::contradicting_row() const {
    for (const ConstrainedBlock& c : blocks_) {
        Eigen::VectorXd wanted(c.rows.size());
        for (std::size_t i = 0; i < c.rows.size(); ++i) wanted[i] = rows_[c.rows[i]].velocity + rows_[c.rows[i]].rate;
        const double largest = wanted.lpNorm<Eigen::Infinity>();
        const Vec6 motion =
            kinematics_ == Kinematics::rigid ? Vec6(c.motion * (c.rigid_inverse * wanted)) : Vec6(c.inverse * wanted);
        for (std::size_t i = 0; i < c.rows.size(); ++i) {
            const auto& row = rows_[c.rows[i]];
            const double found = displacement_row(row.direction, row.xi).dot(motion);
            if (std::abs(found - wanted[i]) > contradiction * largest) return c.rows[i];
        }
    }
    return -1;
}

Eigen::VectorXd Constraints::travel_motion(Eigen::Index n) const {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(n);
    for (const ConstrainedBlock& c : blocks_) {
        Eigen::VectorXd rates(c.rows.size());
        for (std::size_t i = 0; i < c.rows.size(); ++i) rates[i] = rows_[c.rows[i]].rate;
        if (kinematics_ == Kinematics::rigid) {
            motion.segment<n_rigid_unknowns>(n_rigid_unknowns * c.block) = c.rigid_inverse * rates;
        } else {
            motion.segment<n_block_unknowns>(n_block_unknowns * c.block) = c.inverse * rates;
        }
    }
    return motion;
}

void Constraints::project(Eigen::VectorXd& v) const {
    for (const ConstrainedBlock& c : blocks_) {
        if (kinematics_ == Kinematics::rigid) {
            auto segment = v.segment<n_rigid_unknowns>(n_rigid_unknowns * c.block);
            segment = (c.rigid_projector * segment).eval();
            continue;
        }
        auto segment = v.segment<n_block_unknowns>(n_block_unknowns * c.block);
        segment = (c.projector * segment).eval();
    }
}

void Constraints::project(int block, Vec6& v) const {
    const auto at = std::ranges::lower_bound(blocks_, block, {}, &ConstrainedBlock::block);
    if (at == blocks_.end() || at->block != block) return;
    if (kinematics_ == Kinematics::rigid) {
        v.head<n_rigid_unknowns>() = (at->rigid_projector * v.head<n_rigid_unknowns>()).eval();
    } else {
        v = (at->projector * v).eval();
    }
}

/// The force along each row that the support exerts.
Eigen::VectorXd Constraints::multipliers(const ConstrainedBlock& c, const Eigen::VectorXd& residual) const {
    const auto forces = residual.segment<n_block_unknowns>(n_block_unknowns * c.block);
    if (kinematics_ == Kinematics::rigid) return c.rigid_inverse.transpose() * (c.motion.transpose() * forces);
    return c.inverse.transpose() * forces;
}

void Constraints::add_reactions(Eigen::VectorXd& residual) const {
    for (const ConstrainedBlock& c : blocks_) {
        const Eigen::VectorXd along = multipliers(c, residual);
        for (std::size_t i = 0; i < c.rows.size(); ++i) {
            const auto& row = rows_[c.rows[i]];
            add_force(residual, c.block, row.xi, -along[i] * row.direction);
        }
    }
}

std::vector<double> Constraints::row_forces(const Eigen::VectorXd& residual) const {
    std::vector<double> forces(rows_.size());
    for (const ConstrainedBlock& c : blocks_) {
        const Eigen::VectorXd along = multipliers(c, residual);
        for (std::size_t i = 0; i < c.rows.size(); ++i) forces[c.rows[i]] = along[i];
    }
    return forces;
}

Vec2 Constraints::reaction(const Eigen::VectorXd& residual, int boundary) const {
    Vec2 sum = Vec2::Zero();
    for (const ConstrainedBlock& c : blocks_) {
        const Eigen::VectorXd along = multipliers(c, residual);
        for (std::size_t i = 0; i < c.rows.size(); ++i) {
            const auto& row = rows_[c.rows[i]];
            if (row.boundary == boundary) sum += along[i] * row.direction;
        }
    }
    return sum;
}

} // namespace kluft

#include "kluft/loading/boundary_loads.hpp"

#include <algorithm>
#include <map>

#include <Eigen/SVD>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

/// Rows of a block whose singular values are below this part of the largest are taken as dependent.
constexpr double rank_tolerance = 1e-8;

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

Vec2 pressure_force(const PressureEdge& edge, double pressure, const Eigen::VectorXd& q) {
    const double* v = q.data() + n_block_unknowns * edge.block;
    const Vec2 extent = edge.extent + Vec2(v[2], v[3]) * edge.xi_extent.x() + Vec2(v[4], v[5]) * edge.xi_extent.y();
    return -pressure * right_normal(extent);
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
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeFullV);
        const auto& singular = svd.singularValues();
        const auto rank = (singular.array() > rank_tolerance * singular[0]).count();
        const Eigen::MatrixXd range = svd.matrixV().leftCols(rank);
        ConstrainedBlock constrained{block, indices, Mat6::Zero(), {}};
        if (rank < n_block_unknowns) constrained.projector = Mat6::Identity() - range * range.transpose();
        constrained.inverse =
            range * singular.head(rank).cwiseInverse().asDiagonal() * svd.matrixU().leftCols(rank).transpose();
        blocks_.push_back(std::move(constrained));
    }
}

void Constraints::correction(const Eigen::VectorXd& q, Eigen::VectorXd& dq) const {
    dq.setZero(q.size());
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
        dq.segment<n_block_unknowns>(n_block_unknowns * c.block) = c.inverse * missing;
    }
}

Eigen::VectorXd Constraints::travel_motion(Eigen::Index n) const {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(n);
    for (const ConstrainedBlock& c : blocks_) {
        Eigen::VectorXd rates(c.rows.size());
        for (std::size_t i = 0; i < c.rows.size(); ++i) rates[i] = rows_[c.rows[i]].rate;
        motion.segment<n_block_unknowns>(n_block_unknowns * c.block) = c.inverse * rates;
    }
    return motion;
}

void Constraints::project(Eigen::VectorXd& v) const {
    for (const ConstrainedBlock& c : blocks_) {
        auto segment = v.segment<n_block_unknowns>(n_block_unknowns * c.block);
        segment = (c.projector * segment).eval();
    }
}

void Constraints::project(int block, Vec6& v) const {
    const auto at = std::ranges::lower_bound(blocks_, block, {}, &ConstrainedBlock::block);
    if (at != blocks_.end() && at->block == block) v = (at->projector * v).eval();
}

Vec2 Constraints::reaction(const Eigen::VectorXd& residual, int boundary) const {
    Vec2 sum = Vec2::Zero();
    for (const ConstrainedBlock& c : blocks_) {
        const Eigen::VectorXd multipliers =
            c.inverse.transpose() * residual.segment<n_block_unknowns>(n_block_unknowns * c.block);
        for (std::size_t i = 0; i < c.rows.size(); ++i) {
            const auto& row = rows_[c.rows[i]];
            if (row.boundary == boundary) sum += multipliers[i] * row.direction;
        }
    }
    return sum;
}

} // namespace kluft

#include "kluft/equilibrium/boundary_terms.hpp"

#include <vector>

namespace kluft {

void add_pressure_tangent(const PressureEdge& edge, double pressure, const Eigen::VectorXd& q, Mat6& diagonal) {
    Mat2 turn;
    turn << 0.0, 1.0, -1.0, 0.0; // right_normal
    const Vec2 extent = current_extent(edge, q);
    const PressedShare share = pressed_share(edge, extent);
    const Mat2 by_extent = share.value * turn + right_normal(extent) * share.by_extent.transpose();
    const double position[3] = {1.0, edge.xi_middle.x(), edge.xi_middle.y()};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) {
            diagonal.block<2, 2>(2 * i, 2 + 2 * j) += pressure * position[i] * edge.xi_extent[j] * by_extent;
        }
    }
}

namespace {

template <class Block>
void project_block(const BlockPattern& pattern, int b, const Block& projector, double scale,
                   std::vector<Block>& values) {
    for (int entry = pattern.row_start(b); entry < pattern.row_start(b + 1); ++entry) {
        Block& right = values[entry];
        right = (projector * right).eval();
        Block& below = values[pattern.find(pattern.column(entry), b)];
        below = (below * projector).eval();
    }
    values[pattern.find(b, b)] += scale * (Block::Identity() - projector);
}

} // namespace

void project(const Constraints& constraints, BlockMatrix& matrix, double scale) {
    for (const ConstrainedBlock& c : constraints.blocks()) {
        if (matrix.is_rigid()) {
            project_block(*matrix.pattern, c.block, c.rigid_projector, scale, matrix.rigid_values);
        } else {
            project_block(*matrix.pattern, c.block, c.projector, scale, matrix.values);
        }
    }
}

} // namespace kluft

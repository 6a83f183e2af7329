#include "kluft/equilibrium/boundary_terms.hpp"

namespace kluft {

void add_pressure_tangent(const PressureEdge& edge, double pressure, Mat6& diagonal) {
    Mat2 turn;
    turn << 0.0, 1.0, -1.0, 0.0; // right_normal
    const double position[3] = {1.0, edge.xi_middle.x(), edge.xi_middle.y()};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) {
            diagonal.block<2, 2>(2 * i, 2 + 2 * j) += pressure * position[i] * edge.xi_extent[j] * turn;
        }
    }
}

void project(const Constraints& constraints, BlockMatrix& matrix, double scale) {
    const BlockPattern& pattern = *matrix.pattern;
    for (const ConstrainedBlock& c : constraints.blocks()) {
        for (int entry = pattern.row_start(c.block); entry < pattern.row_start(c.block + 1); ++entry) {
            Mat6& right = matrix.values[entry];
            right = (c.projector * right).eval();
            Mat6& below = matrix.values[pattern.find(pattern.column(entry), c.block)];
            below = (below * c.projector).eval();
        }
        matrix.values[pattern.find(c.block, c.block)] += scale * (Mat6::Identity() - c.projector);
    }
}

} // namespace kluft

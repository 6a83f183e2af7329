// Affine kinematics of a block: x = X + u + D xi with xi = (X - X_c)/h. Unknowns per block, all lengths:
// q = (u_x, u_y, D11, D21, D12, D22); F = I + D/h. Exact under any rotation (docs/theory.md).
#pragma once

#include <Eigen/Core>

#include "kluft/blocks/block_system.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

inline constexpr int n_block_unknowns = 6;

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// xi of a material point X of the block (dimensionless).
[[nodiscard]] inline Vec2 block_coordinates(const Block& block, const Vec2& x) {
    return (x - block.centroid) / block.size;
}

/// Displacement of the point xi of block `b` (m); q has size 6 n_blocks.
[[nodiscard]] inline Vec2 displacement_at(const Eigen::VectorXd& q, int b, const Vec2& xi) {
    const double* v = q.data() + n_block_unknowns * b;
    return {v[0] + v[2] * xi.x() + v[4] * xi.y(), v[1] + v[3] * xi.x() + v[5] * xi.y()};
}

/// direction . displacement_at as a row over the six unknowns of the block.
[[nodiscard]] inline Vec6 displacement_row(const Vec2& direction, const Vec2& xi) {
    Vec6 row;
    row << direction, xi.x() * direction, xi.y() * direction;
    return row;
}

/// H = D/h of block `b`.
[[nodiscard]] inline Mat2 displacement_gradient(const Eigen::VectorXd& q, int b, double size) {
    const double* v = q.data() + n_block_unknowns * b;
    Mat2 h;
    h << v[2] / size, v[4] / size, v[3] / size, v[5] / size;
    return h;
}

/// F = I + D/h of block `b`.
[[nodiscard]] inline Mat2 deformation_gradient(const Eigen::VectorXd& q, int b, double size) {
    return Mat2::Identity() + displacement_gradient(q, b, size);
}

/// Adds the force f at the point xi to the generalised forces of block `b` (N per metre of thickness).
inline void add_force(Eigen::VectorXd& forces, int b, const Vec2& xi, const Vec2& f) {
    double* v = forces.data() + n_block_unknowns * b;
    v[0] += f.x();
    v[1] += f.y();
    v[2] += xi.x() * f.x();
    v[3] += xi.x() * f.y();
    v[4] += xi.y() * f.x();
    v[5] += xi.y() * f.y();
}

/// Integral of N^T N over the block, N the displacement of a point by the unknowns, times `factor` (m2).
[[nodiscard]] inline Mat6 area_matrix(const Block& block, double factor) {
    Mat6 m = Mat6::Zero();
    m.block<2, 2>(0, 0) = factor * block.area * Mat2::Identity();
    const Mat2 second = factor * block.second_moment / (block.size * block.size);
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) m.block<2, 2>(2 + 2 * i, 2 + 2 * j) = second(i, j) * Mat2::Identity();
    }
    return m;
}

/// The product of area_matrix with six numbers of the block.
[[nodiscard]] inline Vec6 area_product(const Block& block, double factor, const Vec6& of) {
    const Mat2 second = factor * block.second_moment / (block.size * block.size);
    Vec6 product;
    product.head<2>() = factor * block.area * of.head<2>();
    product.segment<2>(2) = second(0, 0) * of.segment<2>(2) + second(0, 1) * of.segment<2>(4);
    product.segment<2>(4) = second(1, 0) * of.segment<2>(2) + second(1, 1) * of.segment<2>(4);
    return product;
}

/// The largest change of a block's unknowns over its motion_scale. `motion`: of all of them, six or three per block (m).
[[nodiscard]] double relative_motion(const BlockSystem& system, const Eigen::VectorXd& motion);

/// Current position of a vertex as a corner of a block, local coordinates (m).
[[nodiscard]] inline Vec2 current_position(const BlockSystem& system, const Eigen::VectorXd& q, int b, int vertex) {
    const Vec2& x = system.vertices[vertex];
    return x + displacement_at(q, b, block_coordinates(system.blocks[b], x));
}

/// The same of the point of a block that has the block coordinates xi.
[[nodiscard]] inline Vec2 current_position(const BlockSystem& system, const Eigen::VectorXd& q, int b, const Vec2& xi) {
    const Block& block = system.blocks[b];
    return block.centroid + block.size * xi + displacement_at(q, b, xi);
}

} // namespace kluft

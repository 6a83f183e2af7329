// Rigid kinematics of a block: x = X_c + u + R(theta) (X - X_c). Three unknowns per block, all lengths: (u_x, u_y, w)
// with dw = h dtheta. States stay in the six numbers of affine.hpp, with D = h (R - I); here is the way between both.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

enum class Kinematics {
    affine, ///< six unknowns per block
    rigid   ///< three: no strain of the blocks
};

inline constexpr int n_rigid_unknowns = 3;

using Vec3 = Eigen::Matrix<double, 3, 1>;
using Mat3 = Eigen::Matrix<double, 3, 3>;
using Mat63 = Eigen::Matrix<double, 6, 3>;

[[nodiscard]] inline int unknowns_per_block(Kinematics kinematics) {
    return kinematics == Kinematics::rigid ? n_rigid_unknowns : n_block_unknowns;
}

/// The rotation of block `b` (radians, from -pi to pi): of D = h (R - I), or the nearest one to another D.
[[nodiscard]] inline double rotation_of(const Eigen::VectorXd& q, int b, double size) {
    const double* v = q.data() + n_block_unknowns * b;
    return std::atan2(v[3] - v[4], 2.0 * size + v[2] + v[5]);
}

/// D = h (R - I) for block `b`, without loss of digits at small angles.
inline void set_rotation(Eigen::VectorXd& q, int b, double size, double angle) {
    const double half = std::sin(0.5 * angle);
    const double shrinking = -2.0 * size * half * half;
    const double turning = size * std::sin(angle);
    q.segment<4>(n_block_unknowns * b + 2) << shrinking, turning, -turning, shrinking;
}

/// T: derivative of the six numbers of block `b` with respect to (u_x, u_y, w).
[[nodiscard]] inline Mat63 rigid_motion(const Eigen::VectorXd& q, int b, double size) {
    const double angle = rotation_of(q, b, size);
    Mat63 motion = Mat63::Zero();
    motion(0, 0) = motion(1, 1) = 1.0;
    motion.col(2).tail<4>() << -std::sin(angle), std::cos(angle), -std::cos(angle), -std::sin(angle);
    return motion;
}

/// Moves rigid blocks by `share` times the increment (size 3 n_blocks): rotations add up exactly.
inline void move_rigid(const BlockSystem& system, const Eigen::VectorXd& increment, double share, Eigen::VectorXd& q) {
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double size = system.blocks[b].size;
        const double* d = increment.data() + n_rigid_unknowns * b;
        q[n_block_unknowns * b] += share * d[0];
        q[n_block_unknowns * b + 1] += share * d[1];
        set_rotation(q, b, size, rotation_of(q, b, size) + share * d[2] / size);
    }
}

/// Takes the strains out of a guess: every D becomes that of the nearest rotation.
inline void make_rigid(const BlockSystem& system, Eigen::VectorXd& q) {
    for (int b = 0; b < system.n_blocks(); ++b)
        set_rotation(q, b, system.blocks[b].size, rotation_of(q, b, system.blocks[b].size));
}

} // namespace kluft

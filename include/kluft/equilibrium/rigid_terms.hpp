// Forces and stiffnesses of rigid blocks: those on the six numbers of each block seen from its three unknowns (u_x, u_y, w).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "kluft/kinematics/rigid.hpp"

namespace kluft {

/// Where the blocks of a body have turned to: the columns of T = dq/d(u, w) of each block.
class RigidTurns {
public:
    /// Of the displacements q, size 6 n_blocks.
    void set(const BlockSystem& system, const Eigen::VectorXd& q);
    [[nodiscard]] int n_blocks() const { return static_cast<int>(cosine_sine_.size()); }

    /// The displacement of the point xi of block `b` per unit of w.
    [[nodiscard]] Vec2 lever(int b, const Vec2& xi) const {
        const Vec2& turn = cosine_sine_[b];
        return {-turn.y() * xi.x() - turn.x() * xi.y(), turn.x() * xi.x() - turn.y() * xi.y()};
    }
    /// reduced = T' forces: from size 6 n_blocks to 3 n_blocks.
    void reduce(const Eigen::VectorXd& forces, Eigen::VectorXd& reduced) const;
    /// The norm of |T|' magnitudes, sums of magnitudes of size 6 n_blocks.
    [[nodiscard]] double norm_of_magnitudes(const Eigen::VectorXd& magnitudes) const;
    /// T' forces of block `b`.
    [[nodiscard]] Vec3 reduced_forces(const Vec6& forces, int b) const;
    /// T' stiffness T of block `b`.
    [[nodiscard]] Mat3 reduced(const Mat6& stiffness, int b) const;
    /// The part -(R : f_D)/h of the stiffness against w that the forces f_D on the turning block make.
    void curvatures(const BlockSystem& system, const Eigen::VectorXd& forces, std::vector<double>& result) const;

private:
    std::vector<Vec2> cosine_sine_;
};

/// Sums over points of a pair with the same stiffness that its four blocks of 3 x 3 are made of. Levers l as above.
struct RigidPairMoments {
    double n = 0.0;
    Vec2 a = Vec2::Zero(); ///< sum of l_a
    Vec2 b = Vec2::Zero();
    Mat2 aa = Mat2::Zero(); ///< sum of l_a l_a'
    Mat2 ab = Mat2::Zero();
    Mat2 bb = Mat2::Zero();

    void add(const Vec2& lever_a, const Vec2& lever_b) {
        n += 1.0;
        a += lever_a;
        b += lever_b;
        aa += lever_a * lever_a.transpose();
        ab += lever_a * lever_b.transpose();
        bb += lever_b * lever_b.transpose();
    }
};

/// block += sign * sum of [I l]' stiffness [I m] with the sums of l, m and l m'.
inline void add_rigid_product(double sign, double n, const Vec2& l, const Vec2& m, const Mat2& lm,
                              const Mat2& stiffness, Mat3& block) {
    const Mat2 signed_stiffness = sign * stiffness;
    block.topLeftCorner<2, 2>() += n * signed_stiffness;
    block.topRightCorner<2, 1>() += signed_stiffness * m;
    block.bottomLeftCorner<1, 2>() += l.transpose() * signed_stiffness;
    block(2, 2) += signed_stiffness.cwiseProduct(lm).sum();
}

} // namespace kluft

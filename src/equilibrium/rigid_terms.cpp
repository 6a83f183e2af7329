#include "kluft/equilibrium/rigid_terms.hpp"

#include <cmath>

namespace kluft {

void RigidTurns::set(const BlockSystem& system, const Eigen::VectorXd& q) {
    cosine_sine_.resize(system.blocks.size());
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double* const v = q.data() + n_block_unknowns * b;
        cosine_sine_[b] = Vec2(2.0 * system.blocks[b].size + v[2] + v[5], v[3] - v[4]).normalized();
    }
}

void RigidTurns::reduce(const Eigen::VectorXd& forces, Eigen::VectorXd& reduced) const {
    reduced.resize(n_rigid_unknowns * n_blocks());
    for (int b = 0; b < n_blocks(); ++b) {
        reduced.segment<n_rigid_unknowns>(n_rigid_unknowns * b) =
            reduced_forces(forces.segment<n_block_unknowns>(n_block_unknowns * b), b);
    }
}

Vec3 RigidTurns::reduced_forces(const Vec6& f, int b) const {
    const double cosine = cosine_sine_[b].x();
    const double sine = cosine_sine_[b].y();
    return {f[0], f[1], -sine * f[2] + cosine * f[3] - cosine * f[4] - sine * f[5]};
}

double RigidTurns::norm_of_magnitudes(const Eigen::VectorXd& magnitudes) const {
    double sum = 0.0;
    for (int b = 0; b < n_blocks(); ++b) {
        const double* const f = magnitudes.data() + n_block_unknowns * b;
        const double moment =
            std::abs(cosine_sine_[b].y()) * (f[2] + f[5]) + std::abs(cosine_sine_[b].x()) * (f[3] + f[4]);
        sum += f[0] * f[0] + f[1] * f[1] + moment * moment;
    }
    return std::sqrt(sum);
}

Mat3 RigidTurns::reduced(const Mat6& stiffness, int b) const {
    Mat63 motion = Mat63::Zero();
    motion(0, 0) = motion(1, 1) = 1.0;
    const Vec2& turn = cosine_sine_[b];
    motion.col(2).tail<4>() << -turn.y(), turn.x(), -turn.x(), -turn.y();
    return motion.transpose() * (stiffness * motion);
}

void RigidTurns::curvatures(const BlockSystem& system, const Eigen::VectorXd& forces,
                            std::vector<double>& result) const {
    result.resize(cosine_sine_.size());
    for (int b = 0; b < n_blocks(); ++b) {
        const double* const f = forces.data() + n_block_unknowns * b;
        const double cosine = cosine_sine_[b].x();
        const double sine = cosine_sine_[b].y();
        result[b] = -(cosine * (f[2] + f[5]) + sine * (f[3] - f[4])) / system.blocks[b].size;
    }
}

} // namespace kluft

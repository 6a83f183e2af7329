#include "kluft/equilibrium/coordinates.hpp"

#include <algorithm>
#include <cmath>

namespace kluft {

namespace {

constexpr double relative_roundoff = 1e-13;

} // namespace

void Coordinates::move(const Eigen::VectorXd& q, const Eigen::VectorXd& increment, double s,
                       Eigen::VectorXd& moved) const {
    if (!are_rigid()) {
        moved = q + s * increment;
        return;
    }
    moved = q;
    move_rigid(*system_, increment, s, moved);
}

/// Of a rigid block dD = dw R W, and |R W| is the square root of 2.
double Coordinates::distortion(const Eigen::VectorXd& increment, int b) const {
    if (are_rigid()) return std::sqrt(2.0) * std::abs(increment[n_rigid_unknowns * b + 2]);
    return increment.segment<n_block_unknowns>(n_block_unknowns * b).tail<4>().norm();
}

double Coordinates::motion(const Eigen::VectorXd& increment, int b) const {
    return std::max(increment.segment<2>(per_block() * b).norm(), distortion(increment, b));
}

double Coordinates::squared_norm(const Eigen::VectorXd& v, int b) const {
    if (are_rigid()) return v.segment<n_rigid_unknowns>(n_rigid_unknowns * b).squaredNorm();
    return v.segment<n_block_unknowns>(n_block_unknowns * b).squaredNorm();
}

/// The gradient of a rigid block, h (R - I), has the round-off of its size.
double Coordinates::roundoff(const Eigen::VectorXd& q) const {
    const double of_size = are_rigid() ? relative_roundoff * system_->spacing : 0.0;
    return of_size + relative_roundoff * q.lpNorm<Eigen::Infinity>();
}

void Coordinates::turn_to(const Eigen::VectorXd& q) {
    if (are_rigid()) turns_.set(*system_, q);
}

void Coordinates::reduce(const Eigen::VectorXd& forces, Eigen::VectorXd& reduced) const {
    if (are_rigid()) return turns_.reduce(forces, reduced);
    reduced = forces;
}

double Coordinates::norm_of_magnitudes(const Eigen::VectorXd& magnitudes) const {
    return are_rigid() ? turns_.norm_of_magnitudes(magnitudes) : magnitudes.norm();
}

} // namespace kluft

#include "kluft/equilibrium/equilibrium_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kluft/kinematics/affine.hpp"
#include "tangent_terms.hpp"

namespace kluft {

namespace {

/// Smallest pieces of a net have 1/20 of a hexagon. What is smaller was given so, and with the mass of a hexagon it would
/// not settle on its contacts.
constexpr double largest_mass_growth = 20.0;

} // namespace

EquilibriumEvaluator::EquilibriumEvaluator(const EquilibriumProblem& problem, const BlockPattern& pattern)
    : problem_(problem), pattern_(pattern), coordinates_(*problem.body.system, problem.body.kinematics) {
    area_ = area_of(*problem.body.system);
}

namespace {

double mass_growth(const Block& block, double least_area) {
    return std::clamp(least_area / block.area, 1.0, largest_mass_growth);
}

} // namespace

Mat6 mass_matrix(const Block& block, double least_area) { return area_matrix(block, mass_growth(block, least_area)); }

Vec6 mass_product(const Block& block, double least_area, const Vec6& of) {
    return area_product(block, mass_growth(block, least_area), of);
}

Mat2 symmetric_tangent(const PointTraction& traction) {
    Mat2 tangent = Mat2::Zero();
    tangent(0, 0) = std::max(0.0, traction.tangent(0, 0));
    tangent(1, 1) = traction.state == ContactState::locked ? std::max(0.0, traction.tangent(1, 1)) : 0.0;
    return tangent;
}

// ---- the residual ------------------------------------------------------------------------------------------------------

void EquilibriumEvaluator::residual(const Eigen::VectorXd& q, Residual& result) {
    sum_forces(q, result);
    result.forces.swap(body_forces_.forces);
}

void EquilibriumEvaluator::reduced_residual(const Eigen::VectorXd& q, Residual& result) {
    sum_forces(q, result);
    coordinates_.reduce(body_forces_.forces, result.forces);
}

/// Sums (25) into body_forces_, on the six numbers of each block, and finds the rest of the result.
void EquilibriumEvaluator::sum_forces(const Eigen::VectorXd& q, Residual& result) {
    body_forces(problem_.body, q, body_forces_);
    if (!problem_.eta.empty()) add_mass_forces(q, body_forces_.forces);
    coordinates_.turn_to(q);
    if (coordinates_.are_rigid()) {
        turned_to_ = q;
        coordinates_.turns().curvatures(*problem_.body.system, body_forces_.forces, curvatures_);
    }
    result.force_scale = std::max(coordinates_.norm_of_magnitudes(body_forces_.magnitudes),
                                  negligible_force(problem_.body.carried_stress, area_));
    result.roundoff = 64.0 * std::numeric_limits<double>::epsilon() * body_forces_.stiffest *
                      q.lpNorm<Eigen::Infinity>() * std::sqrt(static_cast<double>(q.size()));
}

void EquilibriumEvaluator::add_mass_forces(const Eigen::VectorXd& q, Eigen::VectorXd& forces) const {
    const BlockSystem& system = *problem_.body.system;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem_.start.segment<n_block_unknowns>(n_block_unknowns * b);
        forces.segment<n_block_unknowns>(n_block_unknowns * b) +=
            problem_.eta[b] * mass_product(system.blocks[b], problem_.least_mass_area, moved);
    }
}

ViscousForce viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    ViscousForce result;
    if (problem.eta.empty()) return result;
    double sum_of_squares = 0.0;
    for (int b = 0; b < problem.body.system->n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem.start.segment<n_block_unknowns>(n_block_unknowns * b);
        const Block& block = problem.body.system->blocks[b];
        const Vec6 force = problem.eta[b] * mass_product(block, problem.least_mass_area, moved);
        const double squared = problem.body.kinematics == Kinematics::rigid
                                   ? (rigid_motion(q, b, block.size).transpose() * force).squaredNorm()
                                   : force.squaredNorm();
        sum_of_squares += squared;
        result.sum += std::sqrt(squared);
    }
    result.norm = std::sqrt(sum_of_squares);
    return result;
}

// ---- its derivative ----------------------------------------------------------------------------------------------------

void EquilibriumEvaluator::tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) {
    matrix.pattern = &pattern_;
    if (coordinates_.are_rigid()) return rigid_tangent_at(q, kind, matrix);
    affine_tangent(problem_, q, kind, matrix);
}

/// Turns the blocks to q first, where the last residual was elsewhere.
void EquilibriumEvaluator::rigid_tangent_at(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) {
    if (turned_to_.size() != q.size() || turned_to_ != q) {
        Residual unused;
        sum_forces(q, unused);
    }
    rigid_tangent(problem_, coordinates_.turns(), curvatures_, q, kind, matrix);
}

} // namespace kluft

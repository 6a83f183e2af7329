#include "kluft/equilibrium/equilibrium_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr double touching_gap = 1e-6; ///< of the lattice spacing

/// (1, xi): the weights of u, D's first and D's second column in the displacement of a point.
std::array<double, 3> shape(const Vec2& xi) { return {1.0, xi.x(), xi.y()}; }

void add_outer(const std::array<double, 3>& row, const std::array<double, 3>& column, const Mat2& stiffness,
               Mat6& block) {
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) block.block<2, 2>(2 * i, 2 * j) += (row[i] * column[j]) * stiffness;
    }
}

void add_point_tangent(const ContactPoint& point, const Mat2& tangent, const std::array<int, 4>& slots,
                       BlockMatrix& matrix) {
    Mat2 frame;
    frame << point.normal, point.tangent;
    const Mat2 stiffness = point.weight * frame * tangent * frame.transpose();
    const auto a = shape(point.xi_a);
    const auto b = shape(point.xi_b);
    add_outer(a, a, stiffness, matrix.values[slots[0]]);
    add_outer(a, b, -stiffness, matrix.values[slots[1]]);
    add_outer(b, a, -stiffness, matrix.values[slots[2]]);
    add_outer(b, b, stiffness, matrix.values[slots[3]]);
}

/// Interface forces are internal: R gets +f on b where f is what b's opening stretches.
void add_point_force(const ContactPoint& point, const Vec2& force, Eigen::VectorXd& forces,
                     Eigen::VectorXd& magnitudes) {
    add_force(forces, point.block_b, point.xi_b, force);
    add_force(forces, point.block_a, point.xi_a, -force);
    const Vec2 size = force.cwiseAbs();
    add_force(magnitudes, point.block_b, point.xi_b.cwiseAbs(), size);
    add_force(magnitudes, point.block_a, point.xi_a.cwiseAbs(), size);
}

Mat2 full_stiffness(const InterfaceLaw& law) {
    return Eigen::Vector2d(law.normal_stiffness, law.shear_stiffness).asDiagonal();
}

struct GapAndSlip {
    double gap;
    double slip;
};

GapAndSlip gap_and_slip(const ContactPoint& point, const Eigen::VectorXd& q) {
    const Vec2 relative = relative_position(point, q);
    return {point.normal.dot(relative), point.tangent.dot(relative) - point.slip_start};
}

Vec2 point_force(const ContactPoint& point, const PointTraction& traction) {
    return point.weight * (traction.normal * point.normal + traction.shear * point.tangent);
}

/// M of a block: integral of N^T N, with at least `least_area` of mass.
Mat6 mass(const Block& block, double least_area) {
    const double factor = std::max(1.0, least_area / block.area);
    Mat6 m = Mat6::Zero();
    m.block<2, 2>(0, 0) = factor * block.area * Mat2::Identity();
    const Mat2 second = factor * block.second_moment / (block.size * block.size);
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) m.block<2, 2>(2 + 2 * i, 2 + 2 * j) = second(i, j) * Mat2::Identity();
    }
    return m;
}

} // namespace

Mat2 symmetric_tangent(const PointTraction& traction) {
    Mat2 tangent = Mat2::Zero();
    tangent(0, 0) = std::max(0.0, traction.tangent(0, 0));
    tangent(1, 1) = traction.state == ContactState::locked ? std::max(0.0, traction.tangent(1, 1)) : 0.0;
    return tangent;
}

PointTraction contact_traction(const EquilibriumProblem& problem, int i, const Eigen::VectorXd& q) {
    const ContactPoint& point = problem.contacts[i];
    const auto [gap, slip] = gap_and_slip(point, q);
    return fracture_traction((*problem.laws)[point.law], point.history, gap, slip);
}

PointTraction bond_traction(const EquilibriumProblem& problem, int i, const Eigen::VectorXd& q) {
    const ContactPoint& point = problem.bonds[i];
    const auto [gap, slip] = gap_and_slip(point, q);
    return bond_traction((*problem.laws)[point.law], point.history.shear_trial, gap, slip);
}

EquilibriumEvaluator::EquilibriumEvaluator(const EquilibriumProblem& problem, const BlockPattern& pattern)
    : problem_(problem), pattern_(pattern) {
    const auto slots_of = [&](const ContactPoint& point) -> Slots {
        return {pattern.find(point.block_a, point.block_a), pattern.find(point.block_a, point.block_b),
                pattern.find(point.block_b, point.block_a), pattern.find(point.block_b, point.block_b)};
    };
    bond_slots_.reserve(problem.bonds.size());
    for (const auto& point : problem.bonds) bond_slots_.push_back(slots_of(point));
    contact_slots_.reserve(problem.contacts.size());
    for (const auto& point : problem.contacts) contact_slots_.push_back(slots_of(point));
    for (int b = 0; b < pattern.n_blocks(); ++b) diagonal_.push_back(pattern.find(b, b));

    bonds_and_mass_.reset(pattern);
    for (std::size_t i = 0; i < problem.bonds.size(); ++i) {
        const Mat2 tangent = full_stiffness((*problem.laws)[problem.bonds[i].law]);
        add_point_tangent(problem.bonds[i], tangent, bond_slots_[i], bonds_and_mass_);
    }
    if (!problem.eta.empty()) add_mass_tangent(bonds_and_mass_);
}

void EquilibriumEvaluator::add_mass_tangent(BlockMatrix& matrix) const {
    for (int b = 0; b < pattern_.n_blocks(); ++b) {
        matrix.values[diagonal_[b]] += problem_.eta[b] * mass(problem_.system->blocks[b], problem_.least_mass_area);
    }
}

void EquilibriumEvaluator::residual(const Eigen::VectorXd& q, Residual& result) {
    const BlockSystem& system = *problem_.system;
    result.forces.setZero(q.size());
    magnitudes_.setZero(q.size());
    double stiffest = 0.0;

    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        const ElasticModuli& moduli = (*problem_.moduli)[block.material];
        const Mat2 force = block.size * stress_of_gradient(displacement_gradient(q, b, block.size), moduli);
        const Eigen::Map<const Eigen::Vector4d> columns(force.data());
        result.forces.segment<4>(n_block_unknowns * b + 2) += columns;
        magnitudes_.segment<4>(n_block_unknowns * b + 2) += columns.cwiseAbs();
        stiffest = std::max(stiffest, 2.0 * moduli.mu + moduli.lambda);
        if (!problem_.densities.empty()) {
            const Vec2 weight = problem_.densities[block.material] * block.area * problem_.gravity;
            result.forces.segment<2>(n_block_unknowns * b) -= weight;
            magnitudes_.segment<2>(n_block_unknowns * b) += weight.cwiseAbs();
        }
    }
    for (std::size_t i = 0; i < problem_.bonds.size(); ++i) {
        const ContactPoint& point = problem_.bonds[i];
        const auto traction = bond_traction(problem_, static_cast<int>(i), q);
        add_point_force(point, point_force(point, traction), result.forces, magnitudes_);
        stiffest = std::max(stiffest, point.weight * (*problem_.laws)[point.law].normal_stiffness);
    }
    for (std::size_t i = 0; i < problem_.contacts.size(); ++i) {
        const ContactPoint& point = problem_.contacts[i];
        const auto traction = contact_traction(problem_, static_cast<int>(i), q);
        add_point_force(point, point_force(point, traction), result.forces, magnitudes_);
        stiffest = std::max(stiffest, point.weight * (*problem_.laws)[point.law].normal_stiffness);
    }
    for (const PressureEdge& edge : problem_.pressure_edges) {
        const double pressure = problem_.pressures[edge.boundary];
        if (pressure == 0.0) continue;
        const Vec2 force = pressure_force(edge, pressure, q);
        add_force(result.forces, edge.block, edge.xi_middle, -force);
        add_force(magnitudes_, edge.block, edge.xi_middle.cwiseAbs(), force.cwiseAbs());
    }
    if (!problem_.eta.empty()) {
        for (int b = 0; b < system.n_blocks(); ++b) {
            const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                               problem_.start.segment<n_block_unknowns>(n_block_unknowns * b);
            result.forces.segment<n_block_unknowns>(n_block_unknowns * b) +=
                problem_.eta[b] * (mass(system.blocks[b], problem_.least_mass_area) * moved);
        }
    }
    result.force_scale = magnitudes_.norm();
    result.roundoff = 64.0 * std::numeric_limits<double>::epsilon() * stiffest * q.lpNorm<Eigen::Infinity>() *
                      std::sqrt(static_cast<double>(q.size()));
}

void EquilibriumEvaluator::tangent(const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix) {
    const BlockSystem& system = *problem_.system;
    matrix.pattern = &pattern_;
    matrix.values = bonds_and_mass_.values;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        matrix.values[diagonal_[b]].block<4, 4>(2, 2) += elastic_tangent(
            deformation_gradient(q, b, block.size), (*problem_.moduli)[block.material], kind != TangentKind::exact);
    }
    for (std::size_t i = 0; i < problem_.contacts.size(); ++i) {
        const ContactPoint& point = problem_.contacts[i];
        if (kind == TangentKind::touching) {
            if (gap_and_slip(point, q).gap > touching_gap * system.spacing) continue;
            add_point_tangent(point, full_stiffness((*problem_.laws)[point.law]), contact_slots_[i], matrix);
            continue;
        }
        const auto traction = contact_traction(problem_, static_cast<int>(i), q);
        if (traction.state == ContactState::open) continue;
        const Mat2 tangent = kind == TangentKind::symmetric ? symmetric_tangent(traction) : traction.tangent;
        add_point_tangent(point, tangent, contact_slots_[i], matrix);
    }
    if (kind != TangentKind::exact) return;
    for (const PressureEdge& edge : problem_.pressure_edges) {
        const double pressure = problem_.pressures[edge.boundary];
        if (pressure != 0.0) add_pressure_tangent(edge, pressure, matrix.values[diagonal_[edge.block]]);
    }
}

double viscous_force(const EquilibriumProblem& problem, const Eigen::VectorXd& q) {
    if (problem.eta.empty()) return 0.0;
    double sum = 0.0;
    for (int b = 0; b < problem.system->n_blocks(); ++b) {
        const Vec6 moved = q.segment<n_block_unknowns>(n_block_unknowns * b) -
                           problem.start.segment<n_block_unknowns>(n_block_unknowns * b);
        sum += (problem.eta[b] * mass(problem.system->blocks[b], problem.least_mass_area) * moved).squaredNorm();
    }
    return std::sqrt(sum);
}

std::vector<Mat2> block_stresses(const BlockSystem& system, const std::vector<ElasticModuli>& moduli,
                                 const Eigen::VectorXd& q) {
    std::vector<Mat2> stresses;
    stresses.reserve(system.blocks.size());
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        stresses.push_back(cauchy_stress(deformation_gradient(q, b, block.size), moduli[block.material]));
    }
    return stresses;
}

} // namespace kluft

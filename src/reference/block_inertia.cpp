#include "kluft/reference/block_inertia.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "kluft/contact/bonds.hpp"
#include "kluft/core/dense_decompositions.hpp"

namespace kluft {

namespace {

constexpr double default_density = 1000.0; ///< kg/m3
constexpr double stability_share = 0.8;
/// A block moves with at least this part of its mass, also where hardly anything holds it.
constexpr double least_translation = 0.25;

/// Adds 2 w (k_n n n^T + k_s t t^T) at the point xi of a block.
void add_point(const Vec2& normal, const Vec2& tangent, const Vec2& xi, double weight, const InterfaceLaw& law,
               Mat6& stiffness) {
    const Vec6 across = displacement_row(normal, xi);
    const Vec6 along = displacement_row(tangent, xi);
    stiffness += 2.0 * weight * law.normal_stiffness * across * across.transpose();
    stiffness += 2.0 * weight * law.shear_stiffness * along * along.transpose();
}

double largest_eigenvalue(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
    const Eigen::LLT<Eigen::MatrixXd> factor(mass);
    const auto lower = factor.matrixL();
    const Eigen::MatrixXd half = lower.solve(stiffness);
    const Eigen::MatrixXd reduced = lower.solve(half.transpose());
    return std::max(0.0, symmetric_eigenvalues(reduced).maxCoeff());
}

double density_of(const Model& model, const Block& block) { return model.densities[block.material]; }

double real_mass(const Model& model) {
    double mass = 0.0;
    for (const Block& block : model.system.blocks) mass += density_of(model, block) * block.area;
    if (mass > 0.0) return mass;
    for (const Block& block : model.system.blocks) mass += default_density * block.area;
    return mass;
}

/// Scaled so that the largest frequency of the block alone is 1 rad/s.
Mat6 mass_of_unit_frequency(const Block& block, const Mat6& stiffness) {
    const Mat6 shape = area_matrix(block, 1.0);
    const double deformation = largest_eigenvalue(stiffness.block<4, 4>(2, 2), shape.block<4, 4>(2, 2));
    double translation = largest_eigenvalue(stiffness.block<2, 2>(0, 0), shape.block<2, 2>(0, 0));
    if (translation <= 1e-6 * deformation) translation = deformation; // nothing touches the block
    Mat6 mass = shape;
    mass.block<2, 2>(0, 0) *= translation;
    mass.block<4, 4>(2, 2) *= deformation;
    return largest_eigenvalue(stiffness, mass) * mass;
}

} // namespace

std::vector<Mat6> stiffness_bounds(const LoadedBody& body) {
    const BlockSystem& system = *body.system;
    std::vector<Mat6> bounds(system.blocks.size(), Mat6::Zero());
    for (int b = 0; b < system.n_blocks(); ++b) {
        const ElasticModuli& moduli = (*body.moduli)[system.blocks[b].material];
        bounds[b].block<4, 4>(2, 2) += elastic_tangent(Mat2::Identity(), moduli, true);
    }
    for (const Bond& bond : body.placement->bonds) {
        for (int k = 0; k < n_bond_points; ++k) {
            const InterfaceLaw& law = (*body.laws)[bond.law];
            add_point(bond.normal(), bond.tangent, bond.xi_a[k], bond.weight, law, bounds[bond.block_a]);
            add_point(bond.normal(), bond.tangent, bond.xi_b[k], bond.weight, law, bounds[bond.block_b]);
        }
    }
    for (const ContactPoint& point : body.placement->contacts) {
        const InterfaceLaw& law = (*body.laws)[point.law];
        add_point(point.normal, point.tangent, point.xi_a, point.weight, law, bounds[point.block_a]);
        add_point(point.normal, point.tangent, point.xi_b, point.weight, law, bounds[point.block_b]);
    }
    return bounds;
}

std::vector<Mat6> initial_stiffness_bounds(const Model& model) {
    LoadedBody body;
    body.system = &model.system;
    body.moduli = &model.moduli;
    body.laws = &model.laws;
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(n_block_unknowns * model.system.n_blocks());
    const double shear[n_bond_points] = {};
    Placement placement;
    for (int i = 0; i < model.system.n_interfaces(); ++i)
        placement.bonds.push_back(bond_at(model.system, i, rest, shear));
    body.placement = &placement;
    return stiffness_bounds(body);
}

std::vector<Mat6> block_masses(const Model& model, DensityScaling scaling) {
    std::vector<Mat6> masses;
    if (scaling == DensityScaling::none) {
        for (const Block& block : model.system.blocks)
            masses.push_back(area_matrix(block, 1.0) * density_of(model, block));
        return masses;
    }
    const auto stiffness = initial_stiffness_bounds(model);
    double total = 0.0;
    double area = 0.0;
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        masses.push_back(mass_of_unit_frequency(model.system.blocks[b], stiffness[b]));
        total += masses.back()(0, 0);
        area += model.system.blocks[b].area;
    }
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        const double least = least_translation * model.system.blocks[b].area / area * total;
        for (int i = 0; i < 2; ++i) masses[b](i, i) = std::max(masses[b](i, i), least);
    }
    const double scale = real_mass(model) / total;
    for (Mat6& mass : masses) mass *= scale;
    return masses;
}

double largest_frequency(const std::vector<Mat6>& stiffness, const std::vector<Mat6>& mass) {
    double largest = 0.0;
    for (std::size_t b = 0; b < mass.size(); ++b)
        largest = std::max(largest, largest_eigenvalue(stiffness[b], mass[b]));
    return std::sqrt(largest);
}

double stable_time_step(double frequency, double damping) {
    return stability_share * 2.0 / frequency / std::sqrt(1.0 + damping);
}

double crossing_time(const Model& model, const std::vector<Mat6>& mass) {
    double total = 0.0;
    double area = 0.0;
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        total += mass[b](0, 0);
        area += model.system.blocks[b].area;
    }
    const double length = (model.system.upper - model.system.lower).maxCoeff();
    return length * std::sqrt(total / area / model.effective_modulus);
}

} // namespace kluft

// Bodies of hexagons with their bonds, contacts and motions, for tests below the level of scenes.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "blocks/cut_scenes.hpp"
#include "kluft/contact/bonds.hpp"
#include "kluft/contact/detection.hpp"
#include "kluft/equilibrium/equilibrium_problem.hpp"
#include "kluft/kinematics/affine.hpp"
#include "support/dense_matrix.hpp"

namespace kluft {

/// A rectangle of hexagons with bonds of type `interface_type`; the first centre at `offset`.
inline GeometrySpec hexagon_spec(double width, double height, double spacing, const Vec2& offset = Vec2::Zero(),
                                 int interface_type = 0) {
    GeometrySpec spec = cut_scenes::rectangle(width, height);
    Tessellation tessellation;
    tessellation.hexagons.spacing = spacing;
    tessellation.hexagons.offset = offset;
    tessellation.interface_type = interface_type;
    spec.tessellation = tessellation;
    return spec;
}

inline Eigen::VectorXd at_rest(const BlockSystem& system) {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * system.n_blocks());
}

/// Block b moves as x = centre of its motion + gradient (X - X_c), its centroid by u.
inline void set_motion(const BlockSystem& system, int b, const Vec2& u, const Mat2& gradient, Eigen::VectorXd& q) {
    const Mat2 d = system.blocks[b].size * gradient;
    q.segment<n_block_unknowns>(n_block_unknowns * b) << u, d(0, 0), d(1, 0), d(0, 1), d(1, 1);
}

inline Mat2 rotation_by(double angle) {
    Mat2 rotation;
    rotation << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    return rotation;
}

/// The whole body moves as x = F X + u.
inline Eigen::VectorXd affine_motion(const BlockSystem& system, const Mat2& f, const Vec2& u = Vec2::Zero()) {
    Eigen::VectorXd q = at_rest(system);
    const Mat2 gradient = f - Mat2::Identity();
    for (int b = 0; b < system.n_blocks(); ++b)
        set_motion(system, b, gradient * system.blocks[b].centroid + u, gradient, q);
    return q;
}

/// x = Q x(q): a state of the body turned as a whole about the local origin.
inline Eigen::VectorXd turned(const BlockSystem& system, const Eigen::VectorXd& q, const Mat2& rotation) {
    Eigen::VectorXd result = q;
    for (int b = 0; b < system.n_blocks(); ++b) {
        const Block& block = system.blocks[b];
        const Vec2 centroid = block.centroid + displacement_at(q, b, Vec2::Zero());
        const Mat2 f = rotation * deformation_gradient(q, b, block.size);
        set_motion(system, b, rotation * centroid - block.centroid, f - Mat2::Identity(), result);
    }
    return result;
}

inline Eigen::VectorXd random_motion(const BlockSystem& system, double amplitude, cut_scenes::Uniform& uniform) {
    Eigen::VectorXd q = at_rest(system);
    for (double& value : q) value = uniform(-amplitude, amplitude);
    return q;
}

/// All interfaces whose type is a bond, in the frames of q and free of shear there.
inline std::vector<Bond> bonds_at(const BlockSystem& system, const std::vector<char>& is_bond_type,
                                  const Eigen::VectorXd& q) {
    const double shear[n_bond_points] = {};
    std::vector<Bond> bonds;
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (is_bond_type[system.interfaces[i].interface_type]) bonds.push_back(bond_at(system, i, q, shear));
    }
    return bonds;
}

/// Surfaces on which each interface follows the law of its own type.
inline ContactSurfaces surfaces_of(const BlockSystem& system, const std::vector<char>& is_bond_type,
                                   const std::vector<InterfaceLaw>& laws) {
    ContactSurfaces surfaces;
    for (const Interface& interface : system.interfaces) {
        surfaces.bonded.push_back(is_bond_type[interface.interface_type]);
        surfaces.law.push_back(interface.interface_type);
    }
    surfaces.n_points.assign(system.interfaces.size(), 3);
    for (const InterfaceLaw& law : laws) surfaces.friction.push_back(law.tan_friction);
    return surfaces;
}

/// Every pair that has a point.
inline BlockPattern pattern_of(const EquilibriumProblem& problem) {
    std::vector<std::pair<int, int>> pairs;
    for (const auto& bond : problem.body.placement->bonds) pairs.emplace_back(bond.block_a, bond.block_b);
    for (const auto& point : problem.body.placement->contacts) pairs.emplace_back(point.block_a, point.block_b);
    return {problem.body.system->n_blocks(), pairs, problem.body.kinematics};
}

} // namespace kluft

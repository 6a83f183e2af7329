#include "kluft/contact/bonds.hpp"

#include <array>
#include <cmath>

#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

const std::array<double, n_bond_points> gauss_positions{0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)};

} // namespace

void append_bond_points(const BlockSystem& system, int i, const Eigen::VectorXd& q, const double* shear,
                        std::vector<ContactPoint>& points) {
    const Interface& interface = system.interfaces[i];
    const Block& block_a = system.blocks[interface.block_a];
    const Block& block_b = system.blocks[interface.block_b];
    const Edge& edge = block_a.edges[interface.edge_a];
    const Vec2 start = edge_start(system, edge);
    const Vec2 end = edge_end(system, edge);
    const Vec2 direction_a = current_position(system, q, interface.block_a, edge.end) -
                             current_position(system, q, interface.block_a, edge.start);
    const Vec2 direction_b = current_position(system, q, interface.block_b, edge.end) -
                             current_position(system, q, interface.block_b, edge.start);
    const Vec2 along = (direction_a.normalized() + direction_b.normalized()).normalized();

    for (int k = 0; k < n_bond_points; ++k) {
        const Vec2 x = start + gauss_positions[k] * (end - start);
        ContactPoint point;
        point.block_a = interface.block_a;
        point.block_b = interface.block_b;
        point.xi_a = block_coordinates(block_a, x);
        point.xi_b = block_coordinates(block_b, x);
        point.normal = right_normal(along);
        point.tangent = along;
        point.weight = 0.5 * (end - start).norm();
        point.law = interface.interface_type;
        point.interface = i;
        point.history.shear_trial = shear[k];
        point.slip_start = point.tangent.dot(relative_position(point, q));
        points.push_back(point);
    }
}

double bond_shear_at(const double* shear, double s) {
    const double slope = (shear[1] - shear[0]) / (gauss_positions[1] - gauss_positions[0]);
    return shear[0] + slope * (s - gauss_positions[0]);
}

} // namespace kluft

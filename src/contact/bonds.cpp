#include "kluft/contact/bonds.hpp"

#include <cmath>
namespace kluft {

Bond bond_at(const BlockSystem& system, int i, const Eigen::VectorXd& q, const double* shear) {
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
    Bond bond;
    bond.interface = i;
    bond.law = law_of(interface);
    bond.block_a = interface.block_a;
    bond.block_b = interface.block_b;
    bond.tangent = (direction_a.normalized() + direction_b.normalized()).normalized();
    bond.weight = 0.5 * (end - start).norm();
    for (int k = 0; k < n_bond_points; ++k) {
        const Vec2 x = start + gauss_positions[k] * (end - start);
        bond.xi_a[k] = block_coordinates(block_a, x);
        bond.xi_b[k] = block_coordinates(block_b, x);
        bond.slip_start[k] = bond.tangent.dot(relative_displacement(bond, k, q));
        bond.shear_start[k] = shear[k];
    }
    return bond;
}

double bond_shear_at(const double* shear, double s) {
    const double slope = (shear[1] - shear[0]) / (gauss_positions[1] - gauss_positions[0]);
    return shear[0] + slope * (s - gauss_positions[0]);
}

} // namespace kluft

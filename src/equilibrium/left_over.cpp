#include "kluft/equilibrium/left_over.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "kluft/equilibrium/border.hpp"

namespace kluft {

/// The moment is h times the force on w, h dtheta = dw.
Vec3 rigid_part(const Coordinates& coordinates, const BlockSystem& system, const Eigen::VectorXd& q,
                const Eigen::VectorXd& forces, int b) {
    if (!coordinates.are_rigid()) return affine_rigid_part(system, q, forces, b);
    const Block& block = system.blocks[b];
    Vec3 part = forces.segment<n_rigid_unknowns>(n_rigid_unknowns * b);
    part[2] *= block.size / std::sqrt(block.area);
    return part;
}

BlockBalance block_balance(const LoadedBody& body, const Eigen::VectorXd& q) {
    if (body.kinematics == Kinematics::affine) return affine_block_balance(body, q);
    const EquilibriumProblem problem{body, {}, 0.0, {}};
    Coordinates coordinates(*body.system, body.kinematics);
    coordinates.turn_to(q);
    BodyForces sum;
    body_forces(body, q, sum);
    Eigen::VectorXd forces;
    coordinates.reduce(sum.forces, forces);
    keep_free_part(problem, border_of_platen(problem, coordinates), q, forces);
    std::vector<Vec3> left;
    for (int b = 0; b < body.system->n_blocks(); ++b)
        left.push_back(-rigid_part(coordinates, *body.system, q, forces, b));
    return block_balance(body, q, std::move(left));
}

} // namespace kluft

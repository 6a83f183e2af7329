#include "kluft/contact/contact.hpp"

#include "kluft/kinematics/affine.hpp"

namespace kluft {

Vec2 relative_position(const ContactPoint& point, const Eigen::VectorXd& q) {
    return point.offset + displacement_at(q, point.block_b, point.xi_b) - displacement_at(q, point.block_a, point.xi_a);
}

} // namespace kluft

#include "kluft/kinematics/affine.hpp"

#include <algorithm>

namespace kluft {

double relative_motion(const BlockSystem& system, const Eigen::VectorXd& motion) {
    double largest = 0.0;
    const Eigen::Index per_block = motion.size() / system.n_blocks();
    for (int b = 0; b < system.n_blocks(); ++b) {
        const double size = motion.segment(per_block * b, per_block).norm();
        largest = std::max(largest, size / motion_scale(system, system.blocks[b]));
    }
    return largest;
}

} // namespace kluft

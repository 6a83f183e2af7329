#include "kluft/simulation/whole_body.hpp"

#include "kluft/core/dense_decompositions.hpp"

namespace kluft {

namespace {

constexpr double not_held = 1e-9; ///< of the largest eigenvalue: a motion that no row resists

} // namespace

WholeBody::WholeBody(const BlockSystem& system)
    : middle(0.5 * (system.lower + system.upper)), extent((system.upper - system.lower).maxCoeff()) {}

Vec3 WholeBody::row(const Vec2& x, const Vec2& direction) const {
    return {direction.x(), direction.y(), cross(x - middle, direction) / extent};
}

Vec3 WholeBody::row(const BlockSystem& system, const PrescribedDisplacement& held) const {
    const Block& block = system.blocks[held.block];
    return row(block.centroid + block.size * held.xi, held.direction);
}

Mat3 resistance(const BlockSystem& system, const Constraints& constraints) {
    const WholeBody body(system);
    Mat3 sum = Mat3::Zero();
    for (const PrescribedDisplacement& held : constraints.rows()) {
        if (held.rate != 0.0) continue; // the platen travels
        const Vec3 row = body.row(system, held);
        sum += row * row.transpose();
    }
    return sum;
}

std::vector<Vec3> free_motions(const Mat3& resistance) {
    const SymmetricEigen eigen = symmetric_eigen(resistance);
    std::vector<Vec3> motions;
    for (int i = 0; i < 3; ++i) {
        if (eigen.values[i] <= not_held * eigen.values.maxCoeff()) motions.emplace_back(eigen.vectors.col(i));
    }
    return motions;
}

} // namespace kluft

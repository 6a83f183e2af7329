// What the tangents of affine and of rigid blocks have in common: where the stiffness of a pair goes, and what it is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "kluft/equilibrium/equilibrium_problem.hpp"

namespace kluft {

/// The tangent of affine blocks, dR/dq; the matrix has its pattern.
void affine_tangent(const EquilibriumProblem& problem, const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);

/// The tangent of rigid blocks. `turns`, `curvatures`: of the blocks and of the forces on them at q.
void rigid_tangent(const EquilibriumProblem& problem, const RigidTurns& turns, const std::vector<double>& curvatures,
                   const Eigen::VectorXd& q, TangentKind kind, BlockMatrix& matrix);

/// Sets the rows of a matrix to zero shortly before they are used: what is then added finds them in the cache.
template <class Block> class RowClearing {
public:
    RowClearing(std::vector<Block>& values, const BlockPattern& pattern) : values_(values), pattern_(pattern) {
        values.resize(static_cast<std::size_t>(pattern.n_entries()));
    }
    /// All rows below `row_end`, as far as they are not zero yet.
    void advance(int row_end) {
        if (row_end <= n_cleared_) return;
        std::fill(values_.begin() + pattern_.row_start(n_cleared_), values_.begin() + pattern_.row_start(row_end),
                  Block::Zero());
        n_cleared_ = row_end;
    }

private:
    std::vector<Block>& values_;
    const BlockPattern& pattern_;
    int n_cleared_ = 0;
};

/// The four blocks of the matrix that a pair of blocks has.
template <class Block> struct PairBlocks {
    PairBlocks(std::vector<Block>& values, const BlockPattern& pattern, int a, int b)
        : aa(values[pattern.diagonal(a)]), ab(values[pattern.find(a, b)]), ba(values[pattern.find(b, a)]),
          bb(values[pattern.diagonal(b)]) {}
    Block &aa, &ab, &ba, &bb;
};

/// The stiffness of a point (N/m2) from the derivative of its traction with respect to (gap, slip), in the frame of
/// `normal` (Pa/m); `weight` is the length that the point stands for.
[[nodiscard]] inline Mat2 point_stiffness(const Vec2& normal, double weight, const Mat2& tangent) {
    Mat2 frame;
    frame << normal, Vec2(-normal.y(), normal.x());
    return weight * frame * tangent * frame.transpose();
}

[[nodiscard]] inline Mat2 full_stiffness(const InterfaceLaw& law) {
    return Eigen::Vector2d(law.normal_stiffness, law.shear_stiffness).asDiagonal();
}

/// The derivatives of a contact point's traction (normal, shear) in a tangent of some kind (Pa/m).
struct PointTangent {
    Mat2 by_motion = Mat2::Zero(); ///< with respect to (gap, slip)
    Vec2 by_tilt = Vec2::Zero();   ///< with respect to the tilt of its overlap; in the exact tangent only
};
[[nodiscard]] PointTangent point_tangent(const EquilibriumProblem& problem, const ContactPoint& point,
                                         const Eigen::VectorXd& q, TangentKind kind);

/// The part of a point's tangent that the tilt of its overlap makes: forces on the numbers of the two blocks times a row over
/// them, as affine blocks have them; of rank one.
struct TiltTangent {
    TiltTangent(const ContactPoint& point, const Vec2& by_tilt);
    Vec6 force_a, force_b; ///< N/m per m of tilt
    Vec6 row_a, row_b;     ///< tilt per unknown
};

} // namespace kluft

// The small vector and matrix types of the whole library.
#pragma once

#include <Eigen/Core>

namespace kluft {

using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;

/// The z component of the cross product of two plane vectors.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// `v` turned by -90 degrees: the outward normal of a counter-clockwise polygon's edge of direction v.
inline Vec2 right_normal(const Vec2& v) { return {v.y(), -v.x()}; }

} // namespace kluft

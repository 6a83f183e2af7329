// The motions of a body, or a part of it, as one rigid piece, and those that supports leave free.
#pragma once

#include <vector>

#include "kluft/loading/boundary_loads.hpp"

namespace kluft {

/// A motion as one piece is (u_x, u_y, w) about the middle of the body's box, w a turn times the box's larger side (m).
struct WholeBody {
    explicit WholeBody(const BlockSystem& system);
    /// direction . displacement of the place x (reference, m) for each of the three motions.
    [[nodiscard]] Vec3 row(const Vec2& x, const Vec2& direction) const;
    /// The row of a prescribed displacement.
    [[nodiscard]] Vec3 row(const BlockSystem& system, const PrescribedDisplacement& held) const;

    Vec2 middle;
    double extent; ///< m
};

/// Of the rows of prescribed displacements and fixed blocks, each row row^T added, against motions of the whole body;
/// without those of a platen that travels.
[[nodiscard]] Mat3 resistance(const BlockSystem& system, const Constraints& constraints);

/// The motions (unit vectors, orthogonal) that none of the rows summed up in `resistance` (row row^T, each added) resists.
[[nodiscard]] std::vector<Vec3> free_motions(const Mat3& resistance);

} // namespace kluft

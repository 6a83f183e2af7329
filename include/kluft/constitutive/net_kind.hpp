// What is known of the kinds of nets: the stiffness that suits them, and whether their loose cells lock.
#pragma once

#include <numbers>

#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

enum class NetKind {
    hexagons, ///< regular, or with jitter
    voronoi,
    triangles
};

[[nodiscard]] NetKind net_kind(const Tessellation& tessellation);

/// The plural that messages name a net by.
[[nodiscard]] const char* cells_of(NetKind kind);

/// Of k_n d/E.
struct RatioRange {
    double least = 0.0; ///< below, the interfaces carry most of the deformation
    double most = 0.0;  ///< above, affine blocks are too stiff in bending (docs/theory.md, lattice), and a body without
                        ///< strength noise fails everywhere at once
};

/// k_n d/E where nothing is given: 10 of hexagons and Voronoi cells; 30 of triangles, whose stresses scatter less the stiffer
/// the interfaces are and whose bending does not depend on it (docs/theory.md, lattice).
[[nodiscard]] double default_stiffness_ratio(NetKind kind);

/// Where a net with affine blocks does what it should (docs/theory.md, lattice).
[[nodiscard]] RatioRange good_stiffness_ratio(NetKind kind);

/// Whether cells interlock, so that loose ones carry load as masonry does, without bound where friction is high
/// (docs/theory.md, blocks).
[[nodiscard]] bool interlocks(NetKind kind);

/// Friction angle of the joints from which on loose cells that interlock can lock (radians). Measured (docs/theory.md,
/// blocks): bodies did not lock at 25 degrees, those of Voronoi cells did at 32.
inline constexpr double locking_friction_angle = 28.0 * std::numbers::pi / 180.0;

} // namespace kluft

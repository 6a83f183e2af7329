// Signs that decide topology, evaluated exactly for the doubles given.
#pragma once

#include "kluft/core/vector.hpp"

namespace kluft {

/// +1 if c lies to the left of the line from a to b, -1 to the right, 0 on it. Exact unless products of the
/// coordinates overflow or underflow: a floating-point filter (Shewchuk 1997), then an error-free expansion.
[[nodiscard]] int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

/// Whether the closed segments ab and cd have a point in common. Exact as `orientation`.
[[nodiscard]] bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// Whether p lies on the closed segment ab. Exact as `orientation`.
[[nodiscard]] bool on_segment(const Vec2& p, const Vec2& a, const Vec2& b);

/// The point of the closed segment ab that is nearest to p.
[[nodiscard]] Vec2 nearest_point(const Vec2& p, const Vec2& a, const Vec2& b);

/// Distance of p from the closed segment ab (m).
[[nodiscard]] double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b);

} // namespace kluft

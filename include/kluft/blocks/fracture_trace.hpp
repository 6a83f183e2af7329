// Ends of mapped traces that nearly meet something else.
#pragma once

#include <vector>

#include "kluft/blocks/arrangement.hpp"
#include "kluft/geometry/polygon.hpp"

namespace kluft {

/// A trace as a polyline, and the source that its segments carry.
struct SourceTrace {
    std::vector<Vec2> points;
    int source = 0;
};

/// Where a trace abuts on another, the map has rounded its end, which then misses the other by the last digits, or it
/// was drawn a little short. For each end of a trace within `reach` (m) of another segment that the trace does not meet
/// there anyway this returns a segment of the trace's source from the end to the nearest point of the other; past it by at most the
/// distance that was missing, so that the two do cross (the rest separates nothing and is pruned). A trace that ends beside that end
/// holds it no more than it is held itself: traces that end together are joined with each other and with what goes on there.
/// A trace that touches a line with a bend is joined with it too, where only rounding separates them.
/// `segments` holds the segments of all traces and of what else they may abut on. A trace may also abut on a part of
/// its own that is further along it than 4 reach.
[[nodiscard]] std::vector<SourceSegment> bridge_ends(const std::vector<SourceTrace>& traces,
                                                     const std::vector<SourceSegment>& segments, double reach);

/// Where one of the segments passes by a notch of the body within `reach` (m), this returns a segment from the notch to it, of its source,
/// which parts what hangs together on so little. `outlines`: polygons with the body to their left.
[[nodiscard]] std::vector<SourceSegment> bridge_notches(const std::vector<std::vector<Vec2>>& outlines,
                                                        const std::vector<SourceSegment>& segments, double reach);

/// A polyline without the points that it passes within `tolerance` (m) anyway (Douglas and Peucker 1973).
[[nodiscard]] std::vector<Vec2> simplified(const std::vector<Vec2>& points, double tolerance);

/// The parts of a polyline whose segments come near a box. Segments that reach farther beyond it than its diagonal are
/// cut off there, in extended precision, so that what lies in the box moves by less than rounding; others keep every bit.
[[nodiscard]] std::vector<std::vector<Vec2>> parts_near(const Box& box, const std::vector<Vec2>& points);

} // namespace kluft

// A net of triangles that follows what bounds and cuts the body.
#pragma once

#include <vector>

#include "kluft/blocks/arrangement.hpp"
#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/blocks/planar_map.hpp"
#include "kluft/geometry/segment_grid.hpp"

namespace kluft {

/// The smallest angle of a triangle, but for those that two lines of the body enclose (radians): the refinement's bound
/// on the ratio of circumradius to shortest edge is sqrt(2), which is arcsin(1/(2 sqrt(2))).
constexpr double smallest_triangle_angle = 0.36136712390670783;

constexpr int most_triangle_relaxation = 20;

/// Area of an equilateral triangle of side a: sqrt(3)/4 a^2 (m2).
[[nodiscard]] double triangle_area(double side);

/// The side a of the net as a function of place: the spacing, less near what the grading names.
class TriangleSize {
public:
    /// Lengths and places local, as the map's (m). Throws InputError for a spacing, a side or a growth that is not
    /// positive and finite, and for passes outside 0 to most_triangle_relaxation.
    TriangleSize(const TriangleNet& net, std::vector<SegmentGrid::Segment> fractures,
                 std::vector<SegmentGrid::Segment> openings, const Polygon& region);

    [[nodiscard]] double at(const Vec2& place) const;
    /// The side rounded to the spacing times a power of 2^(1/4).
    [[nodiscard]] double level_at(const Vec2& place) const;
    [[nodiscard]] bool is_graded() const { return !features_.empty(); }
    [[nodiscard]] double largest() const { return spacing_; }
    /// By how much the side changes per metre at most.
    [[nodiscard]] double growth() const { return growth_; }

private:
    struct Feature {
        SegmentGrid segments;
        Polygon polygon; ///< inside which the side is the smallest; empty for lines
        double side = 0.0;
    };
    double spacing_ = 0.0;
    double growth_ = 0.0;
    std::vector<Feature> features_;
};

/// What the net is laid into: a subdivision of the body along its outline, fractures and construction lines.
struct TriangleFrame {
    const PlanarMap* map = nullptr;
    std::vector<SourceSegment> free_pieces; ///< of lines that end inside a face, which separate nothing
    Polygon region;             ///< whose sides are lines of the map: the net is in the faces inside; empty: in all
    int tessellation = 0;       ///< source of the net's edges
    Vec2 origin = Vec2::Zero(); ///< of the map's coordinates, for messages (m)
    GeometryPlaces places{};    ///< of the net, for messages
};

/// All edges of the body with the net in it: those of the map and the free pieces, cut where the net meets them, each
/// with its source, and the net's own. No two of them cross; ends that meet have the same bits.
///
/// Lines are cut into equal pieces about as long as the side there. As many random points as the mean area asks for are
/// thrown into the filled faces, none nearer to another than a distance that falls from 0.8 sides until all have found
/// their place (McCool and Fiume 1992), none in the circle over a piece of a line. CGAL's constrained Delaunay
/// triangulation joins them; its refinement (Ruppert 1995, Shewchuk 2002) adds points until no triangle has an angle below
/// smallest_triangle_angle, and Lloyd's passes (1982) move the free points to the centroids of their Voronoi cells, more
/// regular with each of `net.relaxation`. All is a function of the seed and of the bits of the lines: predicates are
/// exact, random numbers the same on every machine.
[[nodiscard]] std::vector<SourceSegment> triangle_edges(const TriangleNet& net, const TriangleSize& size,
                                                        const TriangleFrame& frame);

} // namespace kluft

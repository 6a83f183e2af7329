// Cuts the domain into blocks along fracture traces and tessellation edges, with exact arithmetic.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// A fracture with a part in the domain of which no interface is left, or with triangles not all of it.
struct LostFracture {
    enum class Cause {
        too_short,         ///< than what is resolved
        coincides,         ///< with an earlier fracture or the outline
        cuts_off_little,   ///< a piece below the minimum area
        cuts_off_a_hair,   ///< a strip that is too narrow for a block, or a crumb where no spacing is given
        too_near,          ///< to another line, of a net of triangles
        separates_nothing, ///< it ends inside blocks
        in_part            ///< pieces of it are too near to another line
    };
    int fracture = 0;
    Cause cause = Cause::separates_nothing;
    int other = -1;      ///< the fracture that it coincides with; -1 for the outline and other causes
    double area = 0.0;   ///< of the largest piece that it cuts off, where that is too little or a hair (m2)
    double length = 0.0; ///< of what is missing of a part, where no fracture is within two resolutions (m)
};

/// A side of the outline or of a hole, or a whole hole, that is smaller than what a net of triangles resolves.
struct FineDetail {
    int hole = -1; ///< -1: of the outline
    bool is_whole_hole = false;
    Vec2 at = Vec2::Zero(); ///< its middle, scene coordinates (m)
    double size = 0.0;      ///< length of the side, or the largest extent of the hole (m)
};

/// A piece of a fracture that separates nothing.
struct LoosePiece {
    int fracture = 0;
    double length = 0.0; ///< m
};

/// A part of a given block's side that a boundary of all blocks leaves out, since another block is straight before it.
struct InnerSide {
    int boundary = 0;
    int block = 0;
    int other = 0; ///< the block before it
    double gap =
        0.0; ///< the largest distance from that block (m); 0: they touch, and what is left out are strips beside it
    double length = 0.0;    ///< left out (m)
    Vec2 at = Vec2::Zero(); ///< its middle, scene coordinates (m)
};

/// What the cut had to mend and what came out.
struct CutReport {
    struct Merged {
        Vec2 at = Vec2::Zero(); ///< centroid of the piece, scene coordinates (m)
        double area = 0.0;      ///< m2
        int fracture = -1;      ///< that lost the longest piece with it; -1 without one
        double length = 0.0;    ///< of that piece (m)
        bool daylights = false; ///< that piece ends at the outline
        double width = 0.0;     ///< of what was taken off, twice its area over its perimeter (m)
    };
    std::vector<Merged> merged;    ///< pieces below the minimum area that went into a neighbour
    std::vector<Merged> taken_off; ///< pieces below it that were taken off a free surface; `length` is the outline's
    int collapsed_edges = 0;       ///< short edges collapsed to a point
    int joined_ends = 0;           ///< ends of traces that were carried on to what they nearly met
    std::vector<LoosePiece>
        pruned; ///< pieces of traces that separate nothing (dangling ends, isolated traces), the longest first
    std::vector<LostFracture> lost;
    std::vector<FineDetail> fine_details; ///< of a body with triangles
    std::vector<InnerSide> inner_sides;   ///< of given blocks
    double resolution = 0.0;              ///< the smallest length that the cut resolves (m)
    double minimum_area = 0.0;            ///< the smallest piece that is a block of its own (m2)
    double minimum_width = 0.0;           ///< smallest width of a block, twice its area over its perimeter (m)
    double smallest_area = 0.0;           ///< m2
    double smallest_edge = 0.0;           ///< m
    double smallest_angle = 0.0;          ///< radians, between successive edges of a block
};

struct CutBody {
    BlockSystem system;
    CutReport report;
};

/// The outline, the fractures and the hexagons (whole ones with their centre in the tessellation's region, where there
/// is one) are subdivided exactly, in coordinates local to the lower left corner of the domain's box; what lies beyond
/// the outline is left out. Where sources coincide, the outline comes first, then the fracture with the lowest index.
///
/// What is smaller than 0.02 d, d no more than the smaller side of the domain's box, is not resolved: ends of traces
/// within that of another trace or of the outline are carried on to it, without a net a trace that passes by a notch of the outline within
/// that parts the body there, and edges shorter than that are collapsed to a point wherever the blocks around stay simple (a
/// corner of the domain never moves, and its outline keeps its shape). Where no spacing is given, 1e-9 of the domain's
/// diagonal takes the place of 0.02 d, and 1e-12 of the domain's area that of the minimum area. Blocks below the
/// minimum area (with triangles, whose resolution is 0.05 of their smallest side, also pieces narrower than that) are
/// merged across their longest tessellation edge, otherwise their longest interior edge, smallest
/// first, until none is left. Each edge of a block is a side of one interface or lies on one side of the domain.
/// A fracture that ends inside a block does not cut it. Where material regions overlap, the last one holds.
///
/// The order of the blocks is that of their centroids, in rows upwards and to the right in a row; that of the
/// interfaces follows their lower block. Both are the same on every run.
/// Where the specification gives the blocks themselves, they are put together instead (given_blocks.hpp). The sets are
/// those of the specification.
/// Throws InputError for a domain that is empty, not simple or has NaN coordinates, and for what else in the
/// specification is out of range.
[[nodiscard]] CutBody cut_blocks(const GeometrySpec& spec);

/// The same body, in every bit, with all hexagons in the exact subdivision. cut_blocks puts there only those that come
/// within a spacing of the outline, a hole or a trace, and those along the rim of the net; all others it makes from the
/// lattice's vertices as they are. The tests compare the two.
[[nodiscard]] CutBody cut_blocks_exactly(const GeometrySpec& spec);

} // namespace kluft

// Cuts the domain into blocks along fracture traces and tessellation edges, with exact arithmetic.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// What the cut had to mend and what came out.
struct CutReport {
    struct Merged {
        Vec2 at = Vec2::Zero(); ///< centroid of the piece, scene coordinates (m)
        double area = 0.0;      ///< m2
    };
    std::vector<Merged> merged;  ///< pieces below the minimum area that went into a neighbour
    int collapsed_edges = 0;     ///< short edges collapsed to a point
    int pruned_ends = 0;         ///< trace segments that separate nothing (dangling ends, isolated traces)
    double smallest_area = 0.0;  ///< m2
    double smallest_edge = 0.0;  ///< m
    double smallest_angle = 0.0; ///< radians, between successive edges of a block
};

struct CutBody {
    BlockSystem system;
    CutReport report;
};

/// Throws InputError for a domain that is empty, not simple or has NaN coordinates.
[[nodiscard]] CutBody cut_blocks(const GeometrySpec& spec);

} // namespace kluft

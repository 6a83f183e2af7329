// The body cut into blocks: immutable after the cut.
#pragma once

#include <string>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

enum class EdgeOrigin {
    boundary,     ///< on the domain's outline or a hole of it
    fracture,     ///< on a mapped fracture (also where a tessellation edge coincides)
    tessellation, ///< on an edge of the hexagon net
    given         ///< where two given blocks meet
};

/// A directed edge of a block's outline; the block lies to its left.
struct Edge {
    int start = 0;      ///< vertex index
    int end = 0;        ///< vertex index
    int interface = -1; ///< index of the interface that the edge is a side of; -1 on the domain's outline
    int boundary = -1;  ///< index of the boundary that the edge lies on; -1 inside the body or on an unnamed side
};

/// A polygonal block. `edges` holds its loops one after the other: the outline counter-clockwise, then its holes
/// clockwise; loop i starts at edges[loop_starts[i]].
struct Block {
    std::vector<Edge> edges;
    std::vector<int> loop_starts;
    Vec2 centroid = Vec2::Zero();      ///< local coordinates (m)
    double area = 0.0;                 ///< m2
    double size = 0.0;                 ///< h = sqrt(area), m
    Mat2 second_moment = Mat2::Zero(); ///< integral of (X - X_c)(X - X_c)^T over the block, m4
    int material = 0;
    bool fixed = false; ///< does not move or deform in any stage
};

/// An edge with a block on each side. `start` and `end` follow block a's edge, so that the normal to the right of
/// the direction start -> end points from a to b.
struct Interface {
    int block_a = 0;
    int edge_a = 0; ///< index into blocks[block_a].edges
    int block_b = 0;
    int edge_b = 0;
    EdgeOrigin origin = EdgeOrigin::tessellation;
    int fracture = -1;      ///< index of the mapped fracture it lies on; -1 for any other edge
    int interface_type = 0; ///< index into the scene's interface types
    double spacing = 0.0;   ///< d of a graded net at this edge (m); 0: that of the body
    int law = -1;           ///< index into a model's laws; -1: that of its interface type
};

/// What the interface follows while it is bonded, or as the fracture that it is: index into a model's laws.
[[nodiscard]] inline int law_of(const Interface& interface) {
    return interface.law >= 0 ? interface.law : interface.interface_type;
}

struct BoundaryEdge {
    int block = 0;
    int edge = 0;
};

struct Boundary {
    std::string name;
    std::vector<BoundaryEdge> edges;
};

/// Some of the blocks, by name.
struct BlockSet {
    std::string name;
    std::vector<int> blocks; ///< ascending
};

struct BlockSystem {
    Vec2 origin = Vec2::Zero(); ///< scene coordinates of the local origin (m)
    std::vector<Vec2> vertices; ///< local coordinates = scene coordinates - origin (m)
    std::vector<Block> blocks;
    std::vector<Interface> interfaces;
    std::vector<Boundary> boundaries; ///< in the order of GeometrySpec::boundaries
    double spacing = 0.0;  ///< d: the tessellation's spacing or the reference spacing; else the mean block size, of a
                           ///< body of given blocks without the fixed ones (m)
    int outline_type = -1; ///< interface type of two surfaces of the outline that meet; -1: the first fracture's
    std::vector<std::string> block_names; ///< one per block of a body of given blocks; empty for a body that was cut
    std::vector<BlockSet> sets;
    Vec2 lower = Vec2::Zero(); ///< lower left corner of the body's box, local coordinates
    Vec2 upper = Vec2::Zero();

    [[nodiscard]] int n_blocks() const { return static_cast<int>(blocks.size()); }
    [[nodiscard]] int n_interfaces() const { return static_cast<int>(interfaces.size()); }
};

/// Reference position of the start and the end of an edge, local coordinates (m).
[[nodiscard]] inline const Vec2& edge_start(const BlockSystem& system, const Edge& edge) {
    return system.vertices[edge.start];
}
[[nodiscard]] inline const Vec2& edge_end(const BlockSystem& system, const Edge& edge) {
    return system.vertices[edge.end];
}

/// The spacing of hexagons as large as the block (m).
[[nodiscard]] double spacing_of(const Block& block);

/// Whether it is no larger than two cells of the net, of a body with one. Larger blocks are rock around a region with a net.
[[nodiscard]] bool is_cell_of_net(const BlockSystem& system, const Block& block);

/// The spacing that motions of a block are measured by: the net's, of blocks much smaller than its cells four times their
/// own (m).
[[nodiscard]] double motion_scale(const BlockSystem& system, const Block& block);

/// Of all blocks (m2).
[[nodiscard]] double area_of(const BlockSystem& system);

/// Length of the net's edges between triangles per area of triangles, in units of 1/d with the d of each edge: 2 sqrt(3) of
/// equilateral ones without end.
[[nodiscard]] double edges_per_triangle_area(const BlockSystem& system);

/// Area, centroid, size and second moment of a block from its edges (Green's theorem over the loops).
void compute_block_moments(const std::vector<Vec2>& vertices, Block& block);

} // namespace kluft

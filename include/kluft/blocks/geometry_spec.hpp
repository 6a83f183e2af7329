// What the block cutter is given: a domain, fracture traces and a tessellation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// A simple polygon, counter-clockwise or clockwise, first vertex not repeated. Metres.
using Polygon = std::vector<Vec2>;

/// A mapped fracture: a polyline in scene coordinates (m).
struct FractureTrace {
    std::vector<Vec2> points;
    int interface_type = 0; ///< index into the scene's interface types
    std::string name;
    std::string place{}; ///< where the scene gives it, as messages begin; empty: its index is told
};

/// Cells of a net at most: with more the memory of a run, some 8 kB per block and the factor, is beyond that of a large
/// computer, and most often a spacing has a wrong unit.
constexpr double most_cells = 2e6;

/// A net of regular hexagons. `spacing` is the distance of centres, which is also the distance across flats (m).
/// With rotation 0 the flats are vertical: centres at offset + spacing (i + j/2, j sqrt(3)/2).
struct HexagonLattice {
    double spacing = 0.0;
    double rotation = 0.0;      ///< radians, counter-clockwise, about the lattice's own origin
    Vec2 offset = Vec2::Zero(); ///< of one hexagon's centre from the lower left corner of the domain's box (m)
    double jitter = 0.0;        ///< largest displacement of a vertex as a fraction of the spacing, 0 <= jitter < 0.25
    std::uint64_t seed = 1;     ///< of the jitter
};

/// Voronoi cells of random points, one for each square of sqrt(3)/2 spacing^2, which is also the mean area of a cell: as
/// many cells as hexagons of that spacing. The net covers the plane; the body is a window on it.
struct VoronoiCells {
    double spacing = 0.0;       ///< distance of centres of hexagons of the same area (m)
    Vec2 offset = Vec2::Zero(); ///< of the net from the lower left corner of the domain's box (m)
    int relaxation = 0;         ///< Lloyd's passes: each moves every point to the centroid of its cell
    std::uint64_t seed = 1;     ///< of the points
};

/// Where a net of triangles is finer: the side of triangles there (m; 0 = as elsewhere), which grows by `growth` per
/// metre away from it until it is the net's spacing.
struct TriangleGrading {
    double fractures = 0.0;      ///< at mapped fractures
    double openings = 0.0;       ///< at holes of the domain
    Polygon region;              ///< scene coordinates; empty: none
    double region_spacing = 0.0; ///< inside the region
    double growth = 0.3;
};

/// Triangles that follow the outline, the fractures and the construction lines. `spacing` is the side of the equilateral
/// triangle of mean area (m).
struct TriangleNet {
    double spacing = 0.0;
    int relaxation = 0;     ///< Lloyd's passes: each moves every free point to the centroid of its Voronoi cell
    std::uint64_t seed = 1; ///< of the points
    TriangleGrading grading;
};

/// The smallest side that the net is asked for (m).
[[nodiscard]] double smallest_side(const TriangleNet& net);

/// Hexagons, or the Voronoi cells or triangles where they are given, inside `region` (everywhere without one); their
/// edges get `interface_type`.
struct Tessellation {
    HexagonLattice hexagons;
    int interface_type = 0;
    std::optional<Polygon> region;
    std::optional<VoronoiCells> voronoi{};
    std::optional<TriangleNet> triangles{};
};

/// A part of the domain made of another material: blocks with their centroid inside get `material`.
struct MaterialRegion {
    Polygon polygon;
    int material = 0;
};

/// A block given by its outline, for a body that is put together instead of cut.
struct GivenBlock {
    std::string name;
    Polygon polygon; ///< simple and counter-clockwise
    int material = 0;
    bool fixed = false; ///< does not move or deform
};

/// A named part of the body: the blocks with their centroid in `polygon`, or some of the given blocks.
struct BlockSetSpec {
    std::string name;
    Polygon polygon;         ///< empty: `blocks` tells
    std::vector<int> blocks; ///< indices of given blocks
    bool fixed = false;      ///< they do not move or deform
};

/// A named part of the body's outline: the indices of the domain polygon's sides (side i from vertex i to i + 1) and, counted
/// on from these, of its holes' sides, hole after hole; or of the given blocks' sides, counted through block after block, of
/// which only the parts that no other block shares belong to it.
struct BoundarySides {
    std::string name;
    std::vector<int> sides;
    std::string block{};       ///< the given block whose sides they are; empty: of the whole body
    bool by_direction = false; ///< those that face one way, wherever they lie
    bool carries =
        true; ///< has a support, a pressure or a platen in some stage; nothing depends on the sides of others
};

/// Where the scene gives its parts: file, line and key, as messages begin, or the keys alone.
struct GeometryPlaces {
    std::string domain = "geometry.domain";
    std::string blocks = "geometry.blocks";
    std::string tessellation = "geometry.tessellation";
    std::string region = "geometry.tessellation.region";
    std::string net = "geometry.tessellation.triangles";
    std::string spacing = "geometry.tessellation.triangles.spacing";
    std::string grading = "geometry.tessellation.triangles.grading";
    std::string reference_spacing = "geometry.reference_spacing";
};

struct GeometrySpec {
    Polygon domain;                        ///< outline, scene coordinates (m)
    std::vector<Polygon> holes;            ///< of the domain
    std::vector<BoundarySides> boundaries; ///< sides in none of them are free and have no name
    std::vector<FractureTrace> fractures;
    std::optional<Tessellation> tessellation;
    std::vector<std::vector<Vec2>> construction_lines; ///< polylines that a net of triangles follows; no fractures
    int material = 0;
    std::vector<MaterialRegion> regions;
    std::optional<double> minimum_area; ///< of the smallest block, see minimum_area_share
    double reference_spacing = 0.0;     ///< d where there is no tessellation (m); 0 = none given
    std::vector<GivenBlock> blocks;     ///< instead of domain, holes, fractures, tessellation and regions
    int blocks_interface = 0;           ///< index into the scene's interface types: of the interfaces between them
    std::vector<BlockSetSpec> sets;
    std::string crs{}; ///< coordinate system of the scene's coordinates, "EPSG:25832"; empty where it is not known
    GeometryPlaces places{};
};

/// Smallest block as a fraction of mean_cell_area, or of the domain where a cell is larger: `minimum_area`, else 0.05 of the cells
/// of a net, and 0.002 where traces alone make the blocks.
[[nodiscard]] double minimum_area_share(const GeometrySpec& spec);

/// Mean area of a cell of the net, or of a hexagon of lattice_spacing where there is none (m2).
[[nodiscard]] double mean_cell_area(const GeometrySpec& spec);

/// d of the scene: the tessellation's spacing, else the reference spacing (m), else 0.
[[nodiscard]] double lattice_spacing(const GeometrySpec& spec);

} // namespace kluft

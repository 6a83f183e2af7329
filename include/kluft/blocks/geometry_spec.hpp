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
};

/// A net of regular hexagons. `spacing` is the distance of centres, which is also the distance across flats (m).
/// With rotation 0 the flats are vertical: centres at offset + spacing (i + j/2, j sqrt(3)/2).
struct HexagonLattice {
    double spacing = 0.0;
    double rotation = 0.0;      ///< radians, counter-clockwise, about the lattice's own origin
    Vec2 offset = Vec2::Zero(); ///< of one hexagon's centre from the lower left corner of the domain's box (m)
    double jitter = 0.0;        ///< largest displacement of a vertex as a fraction of the spacing, 0 <= jitter < 0.25
    std::uint64_t seed = 1;     ///< of the jitter
};

/// Hexagons inside `region` (everywhere without one); their edges get `interface_type`.
struct Tessellation {
    HexagonLattice hexagons;
    int interface_type = 0;
    std::optional<Polygon> region;
};

/// A part of the domain made of another material: blocks with their centroid inside get `material`.
struct MaterialRegion {
    Polygon polygon;
    int material = 0;
};

/// A named part of the domain's outline: the indices of the domain polygon's sides (side i from vertex i to i + 1).
struct BoundarySides {
    std::string name;
    std::vector<int> sides;
};

struct GeometrySpec {
    Polygon domain;                        ///< outline, scene coordinates (m)
    std::vector<Polygon> holes;            ///< of the domain
    std::vector<BoundarySides> boundaries; ///< sides in none of them are free and have no name
    std::vector<FractureTrace> fractures;
    std::optional<Tessellation> tessellation;
    int material = 0;
    std::vector<MaterialRegion> regions;
    double minimum_area =
        0.05; ///< smallest block as a fraction of a hexagon; without a tessellation of reference_spacing's
    double reference_spacing = 0.0; ///< d where there is no tessellation (m); 0 = none given
};

/// d of the scene: the tessellation's spacing, else the reference spacing (m), else 0.
[[nodiscard]] double lattice_spacing(const GeometrySpec& spec);

} // namespace kluft

// A layer of a map: features with places and attributes, as geographic information systems have them.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "kluft/core/vector.hpp"

namespace kluft {

/// Of an attribute; nothing where a feature has none.
using MapValue = std::variant<std::monostate, long long, double, std::string>;

struct MapFeature {
    long long id = 0;                                     ///< in its file
    std::string type;                                     ///< of its geometry: "LineString"; empty without one
    std::vector<std::vector<Vec2>> lines;                 ///< of a LineString or a MultiLineString
    std::vector<std::vector<std::vector<Vec2>>> polygons; ///< of each its rings, outline and holes, closed
    std::vector<MapValue> values;                         ///< one per field of the layer
};

struct MapLayer {
    std::string name;
    std::string crs; ///< coordinate system: "EPSG:25832", or WKT; empty where it is not known
    std::vector<std::string> fields;
    std::vector<MapFeature> features;
};

/// "joint", "3", "0.5"; "" for nothing.
[[nodiscard]] std::string map_value_text(const MapValue& value);

} // namespace kluft

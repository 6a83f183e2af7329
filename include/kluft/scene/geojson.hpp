// Domains and fracture traces from GeoJSON files (RFC 7946), as mapping programs write them.
#pragma once

#include <filesystem>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// An area with its holes, in the file's own coordinates, taken as metres.
struct MappedArea {
    Polygon outline;
    std::vector<Polygon> holes;
};

/// Reads the one polygon of a file: a Polygon, a MultiPolygon of one part, a Feature or a FeatureCollection with one
/// such feature. Coordinates keep all digits of their doubles, heights are left out, the repeated last point of a ring
/// and points equal to the one before are dropped. Features without geometry are passed over.
/// Throws InputError, naming the file and the feature (counted from 0), for a file that cannot be read or parsed, for
/// other geometries, and for none or several polygons.
[[nodiscard]] MappedArea read_geojson_area(const std::filesystem::path& file);

/// Reads all traces of a file: LineStrings and the parts of MultiLineStrings, in the order of the file. Otherwise as
/// `read_geojson_area`.
[[nodiscard]] std::vector<std::vector<Vec2>> read_geojson_traces(const std::filesystem::path& file);

} // namespace kluft

// Domains and fracture traces from maps: GeoJSON, GeoPackage, shapefile.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"

namespace kluft {

/// What is read of a map, and what its coordinates become.
struct MapRequest {
    std::filesystem::path file;
    std::string layer{};     ///< of a file with several; empty: its only one
    std::string attribute{}; ///< whose values come with the traces; empty: none
    std::string file_crs{};  ///< instead of what the file says of its coordinate system; "local": metres of the scene
    std::string scene_crs{}; ///< to which coordinates are projected; empty: that of the file
};

/// An area with its holes (m).
struct MappedArea {
    Polygon outline;
    std::vector<Polygon> holes;
    std::string crs{};    ///< of the coordinates; empty where it is not known
    std::string remark{}; ///< what the user should know of how the file was taken; mostly empty
};

struct MappedTrace {
    std::vector<Vec2> points; ///< m
    std::optional<std::string>
        attribute{}; ///< value of the attribute that was asked for; none where the feature has none
};

struct MappedTraces {
    std::vector<MappedTrace> traces; ///< in the order of the file
    std::string crs{};
    std::string remark{};
};

/// Reads the one polygon of a map: a Polygon or a MultiPolygon of one part. The repeated last point of a ring and points
/// equal to the one before are dropped; features without geometry are passed over.
/// Coordinates in degrees are projected to `scene_crs`, or refused without it; they are never taken for metres. A file that
/// does not say its coordinate system is taken to be in metres where a coordinate is beyond the range of degrees; within it
/// GeoJSON is in degrees (RFC 7946) where there is a `scene_crs`, otherwise small numbers about the origin are metres, with
/// a remark, and a small area far from it is refused.
/// Throws InputError, naming the file and the feature, for a file that cannot be read, for other geometries, for none or
/// several polygons, and for coordinates that are not to be had in metres.
[[nodiscard]] MappedArea read_map_area(const MapRequest& request);

/// Reads all traces of a map: LineStrings and the parts of MultiLineStrings, in the order of the file. Otherwise as
/// `read_map_area`. An error of the attribute that is asked for has the path "attribute".
[[nodiscard]] MappedTraces read_map_traces(const MapRequest& request);

} // namespace kluft

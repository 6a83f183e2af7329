// Coordinate systems of maps, through GDAL and PROJ.
#pragma once

#include <string>

#include "kluft/maps/map_layer.hpp"

namespace kluft {

struct CoordinateSystem {
    std::string name;           ///< "ETRS89 / UTM zone 32N (EPSG:25832)"
    bool is_geographic = false; ///< longitude and latitude in degrees
    double unit = 1.0;          ///< of one that is not geographic (m)
};

/// One name for each way to write an authority's code: "EPSG:25832" for "urn:ogc:def:crs:EPSG::25832" and "epsg:25832",
/// "OGC:CRS84"; any other text as it is. Needs no GDAL.
[[nodiscard]] std::string canonical_crs(const std::string& text);

/// What a coordinate system is: "EPSG:25832", "urn:ogc:def:crs:EPSG::25832" or WKT. Names of files and addresses are not
/// followed. Throws InputError for what is not known, without the data of PROJ, and without GDAL.
[[nodiscard]] CoordinateSystem describe_crs(const std::string& text);

/// Changes the places of all features from their system to another one; x is east, or the longitude, in all systems.
/// Places do not change at all where both are the same. Heights are not looked at. Throws InputError as `describe_crs`, and
/// for a place that cannot be projected, with its feature.
void project(MapLayer& layer, const std::string& from, const std::string& to);

} // namespace kluft

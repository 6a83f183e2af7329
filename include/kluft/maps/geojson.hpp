// GeoJSON files (RFC 7946), as mapping programs write them; without any other library.
#pragma once

#include <filesystem>

#include "kluft/maps/map_layer.hpp"

namespace kluft {

/// Reads lines and polygons. Coordinates keep all digits of their doubles; heights are left out. The coordinate system is
/// that of the member `crs` of earlier GeoJSON; without one it is empty, though RFC 7946 means degrees of WGS 84 by that.
/// Features are counted from 0; a bare geometry has -1. Attributes that are lists or objects are left out.
/// Throws InputError, naming the file and the feature, for a file that cannot be read or parsed and for coordinates that
/// are none, or farther away than 1e9.
[[nodiscard]] MapLayer read_geojson(const std::filesystem::path& file);

} // namespace kluft

// Files of maps, through GDAL: GeoPackage, shapefile; GeoJSON only to be written.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kluft/maps/map_layer.hpp"

namespace kluft {

inline constexpr double farthest_position = 1e9; ///< m from the origin, as of lengths in a scene

/// Whether the name is that of a GeoPackage or of a shapefile.
[[nodiscard]] bool is_map_file(const std::filesystem::path& file);

/// The files that belong to a map file besides itself, which need not exist: tables and index of a shapefile, the log of a
/// GeoPackage that another program has open.
[[nodiscard]] std::vector<std::filesystem::path> companions(const std::filesystem::path& file);

/// Reads a layer of a GeoPackage or a shapefile; `name` may be empty where there is only one. Heights are left out, arcs
/// become lines of chords that span four degrees. Throws InputError, naming the file, for what is missing, damaged or too
/// large, for an unknown layer (with those there are), and without GDAL.
[[nodiscard]] MapLayer read_map_layer(const std::filesystem::path& file, const std::string& name);

enum class MapFormat { geopackage, geojson };

/// The bytes of a map file. A GeoPackage has a layer for each; GeoJSON, which knows no layers, has the features of all one
/// after the other, with the name of the layer as attribute `layer`. All layers have one coordinate system, which is
/// written. Throws InputError without GDAL, ResourceError where there is not enough memory.
[[nodiscard]] std::string map_file_content(MapFormat format, const std::vector<MapLayer>& layers);

/// What the description of each layer of such a GeoPackage says.
inline constexpr std::string_view geopackage_mark = "Made by Kluft from a state of a run";

/// Whether map_file_content has made the GeoPackage, whatever others have done to it since.
[[nodiscard]] bool is_own_geopackage(std::string_view content);

/// Whether map_file_content has made the GeoJSON: GDAL writes the name of the layer into its head.
[[nodiscard]] bool is_own_geojson(std::string_view content);

} // namespace kluft

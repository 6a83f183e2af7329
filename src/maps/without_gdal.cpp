// What stands in for GDAL in a build without it.
#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/maps/coordinate_system.hpp"
#include "kluft/maps/gdal.hpp"
#include "kluft/maps/map_file.hpp"

namespace kluft {

std::string gdal_version() { return {}; }

std::string gdal_problem() {
    return "this build is without GDAL, which reads and writes maps and knows coordinate systems (Debian: libgdal-dev, "
           "then build again)";
}

void require_gdal(const std::string& what) {
    throw InputError(what.empty() ? gdal_problem() : fmt::format("{}: {}", what, gdal_problem()));
}

CoordinateSystem describe_crs(const std::string& text) {
    throw InputError(fmt::format("coordinate system {}: {}", text, gdal_problem()));
}

void project(MapLayer& /*layer*/, const std::string& from, const std::string& to) {
    throw InputError(fmt::format("from coordinate system {} to {}: {}", from, to, gdal_problem()));
}

MapLayer read_map_layer(const std::filesystem::path& file, const std::string& /*name*/) {
    throw InputError(fmt::format("{}: {}", file.string(), gdal_problem()));
}

std::string map_file_content(MapFormat /*format*/, const std::vector<MapLayer>& /*layers*/) {
    throw InputError(gdal_problem());
}

} // namespace kluft

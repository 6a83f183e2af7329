#include <algorithm>
#include <array>
#include <cctype>

#include "kluft/maps/map_file.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

std::string small_extension(const fs::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// The file beside a shapefile, in the capitals of its own extension.
fs::path beside(const fs::path& file, std::string extension) {
    const std::string own = file.extension().string();
    if (std::ranges::none_of(own, [](unsigned char c) { return std::islower(c) != 0; }))
        std::ranges::transform(extension, extension.begin(),
                               [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return fs::path(file).replace_extension(extension);
}

} // namespace

bool is_map_file(const fs::path& file) {
    const std::string extension = small_extension(file);
    return extension == ".gpkg" || extension == ".shp";
}

std::vector<fs::path> companions(const fs::path& file) {
    const std::string extension = small_extension(file);
    if (extension == ".gpkg") return {fs::path(file.string() + "-wal")};
    if (extension != ".shp") return {};
    std::vector<fs::path> files;
    for (const char* const each : {".shx", ".dbf", ".prj", ".cpg"}) files.push_back(beside(file, each));
    return files;
}

bool is_own_geojson(std::string_view content) {
    constexpr std::size_t head = 200;
    return content.substr(0, head).find(R"("name": "kluft")") != std::string_view::npos;
}

bool is_own_geopackage(std::string_view content) {
    return content.starts_with("SQLite format 3") && content.find(geopackage_mark) != std::string_view::npos;
}

} // namespace kluft

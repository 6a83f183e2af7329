// kluft export DIR -o FILE.gpkg|FILE.geojson
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "commands.hpp"
#include "failure.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/maps/gdal.hpp"
#include "kluft/maps/map_file.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/field_reader.hpp"
#include "kluft/output/result_map.hpp"
#include "kluft/report/run_of_results.hpp"
#include "kluft/scene/scene_as_run.hpp"
#include "results_run.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace {

namespace fs = std::filesystem;

MapFormat map_format(const fs::path& file) {
    if (file.extension() == ".gpkg") return MapFormat::geopackage;
    if (file.extension() == ".geojson") return MapFormat::geojson;
    throw InputError(fmt::format("-o: expected a file that ends in .gpkg or .geojson, found {}", file.string()));
}

/// The map that is written where no name was given: one of an earlier export gives way to it.
fs::path default_map(const fs::path& directory) {
    fs::path file = run_name(directory) + ".gpkg";
    std::error_code error;
    if (fs::is_regular_file(file, error) && !is_own_geopackage(read_file(file)))
        throw InputError(
            fmt::format("{}: expected a map that kluft export made or none, found another file, which would "
                        "be lost; choose a name with -o",
                        file.string()));
    return file;
}

FieldNames names_in(const Scene& scene) {
    FieldNames names;
    for (const Material& each : scene.materials) names.materials.push_back(each.name);
    for (const auto& each : scene.interface_types) names.interface_types.push_back(each.name);
    for (const FractureTrace& each : scene.geometry.fractures) names.fractures.push_back(each.name);
    return names;
}

} // namespace

ExitCode export_map(const ExportArguments& arguments) {
    const fs::path directory = arguments.directory;
    if (!fs::is_directory(directory))
        throw InputError(directory.string() + ": expected a directory of results, found none");
    const fs::path file = arguments.output.empty() ? default_map(directory) : fs::path(arguments.output);
    const MapFormat format = map_format(file);
    require_directory_of(file.string());
    require_possible_output(file.string());
    require_gdal();
    const int step = step_asked_for(arguments.step, directory);
    const RunOfResults run = run_of_results(directory);
    for (const std::string& map : geometry_files(run.scene)) {
        std::error_code gone;
        if (fs::equivalent(file, map, gone))
            throw InputError(
                fmt::format("{}: expected another file for the map, found one that the scene reads; choose it with -o",
                            file.string()));
    }
    require_own_file(file.string(), "a map", [&](std::string_view content) {
        return format == MapFormat::geopackage ? is_own_geopackage(content) : is_own_geojson(content);
    });
    const BlockSystem& system = run.built.model.system;
    const std::string& crs = run.scene.geometry.crs;
    if (crs.empty()) tell("no coordinate system is written: neither the maps of the scene nor geometry.crs name one\n");
    write_file(file, map_file_content(format, result_layers(system, read_fields(directory, step, system),
                                                            names_in(run.scene), crs)));
    say("{}\n", file.string());
    return ExitCode::done;
}

} // namespace kluft

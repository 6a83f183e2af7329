#include "kluft/maps/map_file.hpp"

#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "gdal_library.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/maps/gdal.hpp"
#include "shapefile_records.hpp"
#include "spatial_reference.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_points = 10'000'000; ///< of a layer
constexpr int most_parts_in_parts = 8;          ///< collections in collections

using OpenMap = std::unique_ptr<void, decltype(&::GDALClose)>;
using ReadFeature = std::unique_ptr<void, decltype(&::OGR_F_Destroy)>;
using OwnGeometry = std::unique_ptr<void, decltype(&::OGR_G_DestroyGeometry)>;

/// GDAL's headers declare what registers a format for C++ only, with all its classes.
void register_formats() {
    for (const char* const name : {"RegisterOGRShape", "RegisterOGRGeoPackage", "RegisterOGRGeoJSON"})
        gdal_function<void (*)()>(name)();
}

// ---- reading -------------------------------------------------------------------------------------------------------

bool is_shapefile(const fs::path& file) { return companions(file).size() > 1; }

void require_files(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    const char* found = nullptr;
    if (!fs::exists(status)) found = "no such file";
    if (fs::is_directory(status)) found = "a directory";
    if (found == nullptr && !fs::is_regular_file(status)) found = "no regular file";
    if (found != nullptr) throw InputError(fmt::format("{}: expected a map, found {}", file.string(), found));
    if (!is_shapefile(file)) return;
    const auto beside = companions(file);
    for (const fs::path& each : {beside[0], beside[1]}) // index and attributes
        if (!fs::is_regular_file(each, error))
            throw InputError(fmt::format("{}: expected {} beside it, which is a part of the shapefile, found none",
                                         file.string(), each.filename().string()));
}

/// Of a shapefile that GDAL can read: it leaves out shapes that have no record in the index or in the table, without a word.
void require_whole(const fs::path& file) {
    if (!is_shapefile(file)) return;
    const auto beside = companions(file);
    require_equal_records(file, beside[0], beside[1]);
}

OpenMap open_map(const fs::path& file, const GdalMessages& messages) {
    register_formats();
    const char* const format = is_shapefile(file) ? "ESRI Shapefile" : "GPKG";
    const char* const formats[] = {format, nullptr}; // NOLINT: as GDAL takes it
    OpenMap map(KLUFT_GDAL(GDALOpenEx)(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, formats, nullptr, nullptr),
                KLUFT_GDAL(GDALClose));
    messages.require_memory();
    if (!map)
        throw InputError(fmt::format("{}: expected a {}, found a damaged file or another one{}", file.string(),
                                     is_shapefile(file) ? "shapefile" : "GeoPackage",
                                     messages.text().empty() ? "" : ": " + messages.text()));
    return map;
}

std::string name_of_layer(OGRLayerH layer) {
    const char* const name = KLUFT_GDAL(OGR_L_GetName)(layer);
    return name == nullptr ? "" : name;
}

/// The layers that have geometry.
std::vector<OGRLayerH> layers_of(const OpenMap& map) {
    std::vector<OGRLayerH> layers;
    for (int i = 0; i < KLUFT_GDAL(GDALDatasetGetLayerCount)(map.get()); ++i) {
        OGRLayerH const layer = KLUFT_GDAL(GDALDatasetGetLayer)(map.get(), i);
        if (layer != nullptr && KLUFT_GDAL(OGR_L_GetGeomType)(layer) != wkbNone) layers.push_back(layer);
    }
    return layers;
}

OGRLayerH chosen_layer(const OpenMap& map, const fs::path& file, const std::string& name) {
    const std::vector<OGRLayerH> layers = layers_of(map);
    std::vector<std::string> names;
    for (OGRLayerH const layer : layers) names.push_back(name_of_layer(layer));
    if (layers.empty()) throw InputError(fmt::format("{}: expected a layer with geometry, found none", file.string()));
    if (name.empty() && layers.size() > 1)
        throw InputError(fmt::format("{}: expected `layer` beside `file`, one of {}, found none", file.string(),
                                     fmt::join(names, ", ")));
    for (std::size_t i = 0; i < layers.size(); ++i)
        if (name.empty() || names[i] == name) return layers[i];
    throw InputError(fmt::format("{}: expected a layer of it ({}), found '{}'{}", file.string(), fmt::join(names, ", "),
                                 name, suggestion(name, names)));
}

std::vector<std::string> fields_of(OGRLayerH layer) {
    OGRFeatureDefnH const definition = KLUFT_GDAL(OGR_L_GetLayerDefn)(layer);
    std::vector<std::string> names;
    for (int i = 0; i < KLUFT_GDAL(OGR_FD_GetFieldCount)(definition); ++i)
        names.emplace_back(KLUFT_GDAL(OGR_Fld_GetNameRef)(KLUFT_GDAL(OGR_FD_GetFieldDefn)(definition, i)));
    return names;
}

MapValue value_of(OGRFeatureH feature, int field) {
    if (KLUFT_GDAL(OGR_F_IsFieldSetAndNotNull)(feature, field) == 0) return {};
    OGRFieldDefnH const definition = KLUFT_GDAL(OGR_F_GetFieldDefnRef)(feature, field);
    switch (KLUFT_GDAL(OGR_Fld_GetType)(definition)) {
    case OFTInteger:
    case OFTInteger64:
        return static_cast<long long>(KLUFT_GDAL(OGR_F_GetFieldAsInteger64)(feature, field));
    case OFTReal:
        return KLUFT_GDAL(OGR_F_GetFieldAsDouble)(feature, field);
    default:
        return std::string(KLUFT_GDAL(OGR_F_GetFieldAsString)(feature, field));
    }
}

std::vector<Vec2> path_of(OGRGeometryH geometry) {
    const int n = KLUFT_GDAL(OGR_G_GetPointCount)(geometry);
    std::vector<double> x(static_cast<std::size_t>(n)), y(static_cast<std::size_t>(n));
    if (n > 0)
        (void)KLUFT_GDAL(OGR_G_GetPoints)(geometry, x.data(), sizeof(double), y.data(), sizeof(double), nullptr, 0);
    std::vector<Vec2> path;
    path.reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        path.emplace_back(x[i], y[i]);
        if (!(path.back().lpNorm<Eigen::Infinity>() <= farthest_position))
            throw InputError(fmt::format("expected a position within {:g} m or degrees, found [{:g}, {:g}]",
                                         farthest_position, x[i], y[i]));
    }
    return path;
}

std::string type_name(OGRwkbGeometryType type) {
    switch (type) {
    case wkbLineString:
        return "LineString";
    case wkbMultiLineString:
        return "MultiLineString";
    case wkbPolygon:
        return "Polygon";
    case wkbMultiPolygon:
        return "MultiPolygon";
    default:
        return KLUFT_GDAL(OGRGeometryTypeToName)(type);
    }
}

/// Adds lines and polygons; what is neither adds nothing.
void add_parts(OGRGeometryH geometry, MapFeature& feature, int depth) {
    const OGRwkbGeometryType type = KLUFT_GDAL(OGR_GT_Flatten)(KLUFT_GDAL(OGR_G_GetGeometryType)(geometry));
    const int n_parts = KLUFT_GDAL(OGR_G_GetGeometryCount)(geometry);
    if (type == wkbLineString) {
        feature.lines.push_back(path_of(geometry));
    } else if (type == wkbPolygon) {
        auto& rings = feature.polygons.emplace_back();
        for (int i = 0; i < n_parts; ++i) rings.push_back(path_of(KLUFT_GDAL(OGR_G_GetGeometryRef)(geometry, i)));
    } else if (depth < most_parts_in_parts && (type == wkbMultiLineString || type == wkbMultiPolygon)) {
        for (int i = 0; i < n_parts; ++i) add_parts(KLUFT_GDAL(OGR_G_GetGeometryRef)(geometry, i), feature, depth + 1);
    }
}

/// Throws InputError with the feature's number.
void add_parts_of(OGRGeometryH geometry, MapFeature& feature) {
    try {
        add_parts(geometry, feature, 0);
    } catch (const InputError& error) {
        throw InputError(fmt::format("feature {}: {}", feature.id, error.what()));
    }
}

MapFeature feature_of(OGRFeatureH read, int n_fields) {
    MapFeature feature;
    feature.id = KLUFT_GDAL(OGR_F_GetFID)(read);
    for (int i = 0; i < n_fields; ++i) feature.values.push_back(value_of(read, i));
    OGRGeometryH const geometry = KLUFT_GDAL(OGR_F_GetGeometryRef)(read);
    if (geometry == nullptr || KLUFT_GDAL(OGR_G_IsEmpty)(geometry) != 0) return feature;
    const OwnGeometry straight(KLUFT_GDAL(OGR_G_GetLinearGeometry)(geometry, 0.0, nullptr),
                               KLUFT_GDAL(OGR_G_DestroyGeometry));
    if (!straight) return feature;
    feature.type = type_name(KLUFT_GDAL(OGR_GT_Flatten)(KLUFT_GDAL(OGR_G_GetGeometryType)(straight.get())));
    add_parts_of(straight.get(), feature);
    return feature;
}

std::size_t n_points_of(const MapFeature& feature) {
    std::size_t n = 1;
    for (const auto& line : feature.lines) n += line.size();
    for (const auto& polygon : feature.polygons)
        for (const auto& ring : polygon) n += ring.size();
    return n;
}

// ---- writing -------------------------------------------------------------------------------------------------------

/// A file in memory, gone at the end.
class FileInMemory {
public:
    explicit FileInMemory(const char* name) : name_(name) {}
    FileInMemory(const FileInMemory&) = delete;
    FileInMemory& operator=(const FileInMemory&) = delete;
    ~FileInMemory() { (void)KLUFT_GDAL(VSIUnlink)(name_); }

    [[nodiscard]] const char* name() const { return name_; }
    [[nodiscard]] std::string content() const {
        vsi_l_offset size = 0;
        const auto* const bytes = KLUFT_GDAL(VSIGetMemFileBuffer)(name_, &size, FALSE);
        return bytes == nullptr ? std::string{} : std::string(reinterpret_cast<const char*>(bytes), size); // NOLINT
    }

private:
    const char* name_;
};

[[noreturn]] void refuse_to_write(const GdalMessages& messages) {
    throw ResourceError("the map cannot be written: " + messages.text());
}

OGRFieldType type_of_field(const MapLayer& layer, std::size_t field) {
    for (const MapFeature& feature : layer.features) {
        const MapValue& value = feature.values[field];
        if (std::holds_alternative<long long>(value)) return OFTInteger64;
        if (std::holds_alternative<double>(value)) return OFTReal;
        if (std::holds_alternative<std::string>(value)) return OFTString;
    }
    return OFTString;
}

bool has_field(OGRLayerH written, const std::string& name) {
    return KLUFT_GDAL(OGR_FD_GetFieldIndex)(KLUFT_GDAL(OGR_L_GetLayerDefn)(written), name.c_str()) >= 0;
}

void create_field(OGRLayerH written, const std::string& name, OGRFieldType type, const GdalMessages& messages) {
    if (has_field(written, name)) return;
    const std::unique_ptr<void, decltype(&::OGR_Fld_Destroy)> field(KLUFT_GDAL(OGR_Fld_Create)(name.c_str(), type),
                                                                    KLUFT_GDAL(OGR_Fld_Destroy));
    if (KLUFT_GDAL(OGR_L_CreateField)(written, field.get(), FALSE) != OGRERR_NONE) refuse_to_write(messages);
}

void create_fields(OGRLayerH written, const MapLayer& layer, const GdalMessages& messages) {
    for (std::size_t i = 0; i < layer.fields.size(); ++i)
        create_field(written, layer.fields[i], type_of_field(layer, i), messages);
}

void set_value(OGRFeatureH feature, const std::string& field, const MapValue& value) {
    const int index = KLUFT_GDAL(OGR_F_GetFieldIndex)(feature, field.c_str());
    if (const auto* const whole = std::get_if<long long>(&value))
        KLUFT_GDAL(OGR_F_SetFieldInteger64)(feature, index, *whole);
    else if (const auto* const number = std::get_if<double>(&value))
        KLUFT_GDAL(OGR_F_SetFieldDouble)(feature, index, *number);
    else if (const auto* const text = std::get_if<std::string>(&value))
        KLUFT_GDAL(OGR_F_SetFieldString)(feature, index, text->c_str());
}

OGRGeometryH geometry_of_path(OGRwkbGeometryType type, const std::vector<Vec2>& path) {
    OGRGeometryH const geometry = KLUFT_GDAL(OGR_G_CreateGeometry)(type);
    for (const Vec2& point : path) KLUFT_GDAL(OGR_G_AddPoint_2D)(geometry, point.x(), point.y());
    return geometry;
}

/// Of a feature with one line or one polygon.
OGRGeometryH geometry_of_feature(const MapFeature& feature) {
    if (!feature.lines.empty()) return geometry_of_path(wkbLineString, feature.lines.front());
    OGRGeometryH const polygon = KLUFT_GDAL(OGR_G_CreateGeometry)(wkbPolygon);
    for (const auto& ring : feature.polygons.front())
        (void)KLUFT_GDAL(OGR_G_AddGeometryDirectly)(polygon, geometry_of_path(wkbLinearRing, ring));
    return polygon;
}

void add_features(OGRLayerH written, const MapLayer& layer, bool names_layer, const GdalMessages& messages) {
    OGRFeatureDefnH const definition = KLUFT_GDAL(OGR_L_GetLayerDefn)(written);
    for (const MapFeature& feature : layer.features) {
        const ReadFeature made(KLUFT_GDAL(OGR_F_Create)(definition), KLUFT_GDAL(OGR_F_Destroy));
        if (names_layer) set_value(made.get(), "layer", layer.name);
        for (std::size_t i = 0; i < layer.fields.size(); ++i) set_value(made.get(), layer.fields[i], feature.values[i]);
        (void)KLUFT_GDAL(OGR_F_SetGeometryDirectly)(made.get(), geometry_of_feature(feature));
        if (KLUFT_GDAL(OGR_L_CreateFeature)(written, made.get()) != OGRERR_NONE) refuse_to_write(messages);
    }
}

SpatialReference reference_of(const std::string& crs) {
    if (crs.empty()) return {nullptr, KLUFT_GDAL(OSRDestroySpatialReference)};
    SpatialReference reference = new_spatial_reference();
    if (KLUFT_GDAL(OSRSetFromUserInput)(reference.get(), crs.c_str()) != OGRERR_NONE) reference.reset();
    if (reference) KLUFT_GDAL(OSRSetAxisMappingStrategy)(reference.get(), OAMS_TRADITIONAL_GIS_ORDER);
    return reference;
}

/// A GeoPackage without a coordinate system would say that its coordinates are degrees; by this name it says that they are lengths.
SpatialReference lengths_of_no_system() {
    SpatialReference reference = new_spatial_reference();
    if (KLUFT_GDAL(OSRSetLocalCS)(reference.get(), "Undefined Cartesian SRS") != OGRERR_NONE) reference.reset();
    return reference;
}

OGRLayerH create_layer(const OpenMap& map, const std::string& name, OGRwkbGeometryType type,
                       const SpatialReference& reference, const GdalMessages& messages, std::string option = {}) {
    std::array<char*, 2> options{option.empty() ? nullptr : option.data(), nullptr};
    OGRLayerH const layer =
        KLUFT_GDAL(GDALDatasetCreateLayer)(map.get(), name.c_str(), reference.get(), type, options.data());
    if (layer == nullptr) refuse_to_write(messages);
    return layer;
}

void write_geopackage(const OpenMap& map, const std::vector<MapLayer>& layers, const GdalMessages& messages) {
    for (const MapLayer& layer : layers) {
        const bool has_lines = !layer.features.empty() && !layer.features.front().lines.empty();
        OGRLayerH const written = create_layer(map, layer.name, has_lines ? wkbLineString : wkbPolygon,
                                               layer.crs.empty() ? lengths_of_no_system() : reference_of(layer.crs),
                                               messages, fmt::format("DESCRIPTION={}", geopackage_mark));
        create_fields(written, layer, messages);
        (void)KLUFT_GDAL(GDALDatasetStartTransaction)(map.get(), FALSE);
        add_features(written, layer, false, messages);
        if (KLUFT_GDAL(GDALDatasetCommitTransaction)(map.get()) != OGRERR_NONE) refuse_to_write(messages);
    }
}

void write_geojson(const OpenMap& map, const std::vector<MapLayer>& layers, const GdalMessages& messages) {
    const std::string crs = layers.empty() ? "" : layers.front().crs;
    OGRLayerH const written = create_layer(map, "kluft", wkbUnknown, reference_of(crs), messages);
    create_field(written, "layer", OFTString, messages);
    for (const MapLayer& layer : layers) create_fields(written, layer, messages);
    for (const MapLayer& layer : layers) add_features(written, layer, true, messages);
}

} // namespace

MapLayer read_map_layer(const fs::path& file, const std::string& name) {
    require_files(file);
    require_gdal(file.string());
    const GdalMessages messages;
    const OpenMap map = open_map(file, messages);
    OGRLayerH const layer = chosen_layer(map, file, name);
    MapLayer read{name_of_layer(layer), crs_text(KLUFT_GDAL(OGR_L_GetSpatialRef)(layer)), fields_of(layer), {}};
    const int n_fields = static_cast<int>(read.fields.size());
    std::size_t n_points = 0;
    KLUFT_GDAL(OGR_L_ResetReading)(layer);
    while (const ReadFeature next{KLUFT_GDAL(OGR_L_GetNextFeature)(layer), KLUFT_GDAL(OGR_F_Destroy)}) {
        read.features.push_back(feature_of(next.get(), n_fields));
        n_points += n_points_of(read.features.back());
        if (n_points > most_points)
            throw InputError(fmt::format("{}: expected at most {} points, found more", file.string(), most_points));
    }
    messages.require_memory();
    if (messages.has_failure())
        throw InputError(fmt::format("{}: expected a sound layer '{}', found damage: {}", file.string(), read.name,
                                     messages.text()));
    require_whole(file);
    return read;
}

std::string map_file_content(MapFormat format, const std::vector<MapLayer>& layers) {
    const GdalMessages messages;
    register_formats();
    const bool is_geopackage = format == MapFormat::geopackage;
    const FileInMemory file(is_geopackage ? "/vsimem/kluft.gpkg" : "/vsimem/kluft.geojson");
    GDALDriverH const driver = KLUFT_GDAL(GDALGetDriverByName)(is_geopackage ? "GPKG" : "GeoJSON");
    if (driver == nullptr) refuse_to_write(messages);
    OpenMap map(KLUFT_GDAL(GDALCreate)(driver, file.name(), 0, 0, 0, GDT_Unknown, nullptr), KLUFT_GDAL(GDALClose));
    if (!map) refuse_to_write(messages);
    if (is_geopackage)
        write_geopackage(map, layers, messages);
    else
        write_geojson(map, layers, messages);
    map.reset(); // what is buffered gets into the file
    if (messages.has_failure()) refuse_to_write(messages);
    return file.content();
}

} // namespace kluft

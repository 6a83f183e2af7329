#include "kluft/maps/geojson.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/input_file.hpp"
#include "kluft/core/shell_line.hpp"
#include "kluft/maps/map_file.hpp"

namespace kluft {

namespace {

using nlohmann::json;

constexpr std::size_t largest_file = 100'000'000; ///< bytes: some million points

/// Where in a file something is said, as the errors name it.
struct Place {
    std::string file;
    int feature = -1; ///< -1 for a bare geometry

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(feature < 0 ? fmt::format("{}: {}", file, what)
                                     : fmt::format("{}: feature {}: {}", file, feature, what));
    }
};

struct PlacedGeometry {
    const json* geometry = nullptr;
    const json* feature = nullptr; ///< null for a bare geometry
    Place place;
};

std::string quoted(const std::string& text) { return "'" + text + "'"; }

bool names_geojson(const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    return extension.empty() || extension == ".json" || extension == ".geojson";
}

/// A map in a format that is not read, with the command that makes one of it that is.
[[noreturn]] void refuse_format(const std::filesystem::path& file) {
    const std::string converted = std::filesystem::path(file).replace_extension(".gpkg").string();
    throw InputError(fmt::format("{}: expected a map in GeoJSON (.geojson, .json), a GeoPackage (.gpkg) or a shapefile "
                                 "(.shp), found a file of another format; `{}` makes a GeoPackage of what GDAL reads",
                                 file.string(), shell_line({"ogr2ogr", converted, file.string()})));
}

/// What a parser says without the name of its exception, "[json.exception.parse_error.101] ".
std::string without_its_name(const std::string& message) {
    const std::size_t end = message.find("] ");
    return message.starts_with('[') && end != std::string::npos ? message.substr(end + 2) : message;
}

/// JSON of objects that have each key once: of two values the parser would keep the last one.
json parse_with_single_keys(const std::string& text, const std::filesystem::path& file) {
    std::vector<std::set<std::string>> keys; // of the objects that are open
    return json::parse(text, [&](int /*depth*/, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
            throw InputError(fmt::format("{}: expected each key of an object once, found {} twice", file.string(),
                                         quoted(parsed.get<std::string>())));
        return true;
    });
}

json parse_file(const std::filesystem::path& file) {
    const std::string text = read_input_file(file, "a GeoJSON file", largest_file);
    try {
        return parse_with_single_keys(text, file);
    } catch (const json::exception& error) {
        if (!names_geojson(file)) refuse_format(file);
        throw InputError(
            fmt::format("{}: expected GeoJSON (or a GeoPackage, .gpkg, or a shapefile, .shp), found no valid "
                        "JSON: {}",
                        file.string(), without_its_name(error.what())));
    }
}

std::string type_of(const json& object, const Place& place) {
    if (!object.is_object()) place.fail("expected a GeoJSON object");
    const auto type = object.find("type");
    if (type == object.end() || !type->is_string()) place.fail("expected a GeoJSON object with a \"type\"");
    return type->get<std::string>();
}

void add_feature(std::vector<PlacedGeometry>& geometries, const json& feature, const Place& place) {
    if (type_of(feature, place) != "Feature") place.fail("expected \"type\": \"Feature\"");
    const auto geometry = feature.find("geometry");
    if (geometry == feature.end()) place.fail("expected a \"geometry\"");
    if (!geometry->is_null()) geometries.push_back({&*geometry, &feature, place});
}

std::vector<PlacedGeometry> geometries_of(const json& root, const std::string& file) {
    std::vector<PlacedGeometry> geometries;
    const Place place{file};
    const std::string type = type_of(root, place);
    if (type == "FeatureCollection") {
        const auto features = root.find("features");
        if (features == root.end() || !features->is_array()) place.fail("expected a list of \"features\"");
        int index = 0;
        for (const json& feature : *features) add_feature(geometries, feature, {file, index++});
    } else if (type == "Feature") {
        add_feature(geometries, root, {file, 0});
    } else {
        geometries.push_back({&root, nullptr, place});
    }
    return geometries;
}

/// A value for a message. Only a short list of values is written out: lists may hold lists to any depth.
std::string text_of(const json& value) {
    if (value.is_object()) return "an object";
    if (!value.is_array()) return quoted(value.dump());
    constexpr std::size_t most_written = 3;
    const bool is_plain = std::ranges::none_of(value, [](const json& item) { return item.is_structured(); });
    if (is_plain && value.size() <= most_written) return quoted(value.dump());
    return fmt::format("a list of {}", value.size());
}

const json& coordinates_of(const json& geometry, const Place& place) {
    const auto coordinates = geometry.find("coordinates");
    if (coordinates == geometry.end() || !coordinates->is_array()) place.fail("expected a list of \"coordinates\"");
    return *coordinates;
}

Vec2 point_of(const json& position, const Place& place) {
    const bool sound =
        position.is_array() && position.size() >= 2 && position[0].is_number() && position[1].is_number();
    if (!sound) place.fail(fmt::format("expected a position [x, y], found {}", text_of(position)));
    const Vec2 point(position[0].get<double>(), position[1].get<double>());
    if (!(point.lpNorm<Eigen::Infinity>() <= farthest_position))
        place.fail(fmt::format("expected a position within {:g} m, found {}", farthest_position, text_of(position)));
    return point;
}

std::vector<Vec2> points_of(const json& list, const Place& place) {
    if (!list.is_array()) place.fail("expected a list of positions");
    std::vector<Vec2> points;
    points.reserve(list.size());
    for (const json& position : list) points.push_back(point_of(position, place));
    return points;
}

std::vector<std::vector<Vec2>> paths_of(const json& list, const Place& place) {
    if (!list.is_array()) place.fail("expected a list of lists of positions");
    std::vector<std::vector<Vec2>> paths;
    for (const json& each : list) paths.push_back(points_of(each, place));
    return paths;
}

void read_geometry_of(const json& geometry, const Place& place, MapFeature& feature) {
    feature.type = type_of(geometry, place);
    if (feature.type == "LineString") {
        feature.lines.push_back(points_of(coordinates_of(geometry, place), place));
    } else if (feature.type == "MultiLineString") {
        feature.lines = paths_of(coordinates_of(geometry, place), place);
    } else if (feature.type == "Polygon") {
        feature.polygons.push_back(paths_of(coordinates_of(geometry, place), place));
    } else if (feature.type == "MultiPolygon") {
        for (const json& part : coordinates_of(geometry, place)) feature.polygons.push_back(paths_of(part, place));
    }
}

MapValue attribute_value(const json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean()) return std::string(value.get<bool>() ? "true" : "false");
    if (value.is_number_integer()) return value.get<long long>();
    if (value.is_number()) return value.get<double>();
    return {};
}

/// Gives each feature the values of its properties; each property of any of them is a field.
void read_attributes(const std::vector<PlacedGeometry>& geometries, MapLayer& layer) {
    std::map<std::string, std::size_t> fields;
    for (std::size_t i = 0; i < geometries.size(); ++i) {
        const json* const feature = geometries[i].feature;
        const auto properties = feature == nullptr ? json::const_iterator{} : feature->find("properties");
        if (feature == nullptr || properties == feature->end() || !properties->is_object()) continue;
        for (const auto& [name, value] : properties->items()) {
            const auto field = fields.try_emplace(name, fields.size()).first->second;
            auto& values = layer.features[i].values;
            values.resize(std::max(values.size(), field + 1));
            values[field] = attribute_value(value);
        }
    }
    layer.fields.resize(fields.size());
    for (const auto& [name, index] : fields) layer.fields[index] = name;
    for (MapFeature& feature : layer.features) feature.values.resize(fields.size());
}

/// Of {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}.
std::string crs_of(const json& root) {
    const auto crs = root.find("crs");
    if (crs == root.end() || !crs->is_object()) return {};
    const auto properties = crs->find("properties");
    if (properties == crs->end() || !properties->is_object()) return {};
    const auto name = properties->find("name");
    return name != properties->end() && name->is_string() ? name->get<std::string>() : std::string{};
}

} // namespace

MapLayer read_geojson(const std::filesystem::path& file) {
    const json root = parse_file(file);
    const std::vector<PlacedGeometry> geometries = geometries_of(root, file.string());
    MapLayer layer;
    layer.name = file.stem().string();
    layer.crs = crs_of(root);
    for (const auto& [geometry, feature, place] : geometries) {
        MapFeature& read = layer.features.emplace_back();
        read.id = place.feature;
        read_geometry_of(*geometry, place, read);
    }
    read_attributes(geometries, layer);
    return layer;
}

} // namespace kluft

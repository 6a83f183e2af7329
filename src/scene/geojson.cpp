#include "kluft/scene/geojson.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/input_file.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

namespace {

using nlohmann::json;

constexpr double farthest = 1e9;                  ///< m from the origin, as of lengths in a scene
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
    Place place;
};

json parse_file(const std::filesystem::path& file) {
    const std::string text = read_input_file(file, "a GeoJSON file", largest_file);
    try {
        return json::parse(text);
    } catch (const json::exception& error) {
        throw InputError(fmt::format("{}: not valid JSON: {}", file.string(), error.what()));
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
    if (!geometry->is_null()) geometries.push_back({&*geometry, place});
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
        geometries.push_back({&root, place});
    }
    return geometries;
}

/// A value for a message. Only a short list of values is written out: lists may hold lists to any depth.
std::string text_of(const json& value) {
    if (value.is_object()) return "an object";
    if (!value.is_array()) return in_quotes(value.dump());
    constexpr std::size_t most_written = 3;
    const bool is_plain = std::ranges::none_of(value, [](const json& item) { return item.is_structured(); });
    if (is_plain && value.size() <= most_written) return in_quotes(value.dump());
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
    if (!sound) place.fail(fmt::format("expected a position [x, y], got {}", text_of(position)));
    const Vec2 point(position[0].get<double>(), position[1].get<double>());
    if (!(point.lpNorm<Eigen::Infinity>() <= farthest))
        place.fail(fmt::format("expected a position within {:g} m, got {}", farthest, text_of(position)));
    return point;
}

/// The points without those equal to the one before.
std::vector<Vec2> points_of(const json& list, const Place& place) {
    if (!list.is_array()) place.fail("expected a list of positions");
    std::vector<Vec2> points;
    for (const json& position : list) {
        const Vec2 point = point_of(position, place);
        if (points.empty() || point != points.back()) points.push_back(point);
    }
    return points;
}

Polygon ring_of(const json& list, const Place& place) {
    Polygon ring = points_of(list, place);
    if (ring.size() < 4)
        place.fail("expected a ring of at least three different points, the first repeated at the end");
    if (ring.front() != ring.back()) place.fail("a ring does not end at its first point");
    ring.pop_back();
    return ring;
}

MappedArea area_of(const json& rings, const Place& place) {
    if (!rings.is_array() || rings.empty()) place.fail("expected a polygon with at least one ring");
    MappedArea area;
    area.outline = ring_of(rings[0], place);
    for (std::size_t i = 1; i < rings.size(); ++i) area.holes.push_back(ring_of(rings[i], place));
    return area;
}

std::vector<Vec2> trace_of(const json& list, const Place& place) {
    std::vector<Vec2> trace = points_of(list, place);
    if (trace.size() < 2) place.fail("expected a trace of at least two different points");
    return trace;
}

} // namespace

MappedArea read_geojson_area(const std::filesystem::path& file) {
    const json root = parse_file(file);
    std::vector<MappedArea> areas;
    for (const auto& [geometry, place] : geometries_of(root, file.string())) {
        const std::string type = type_of(*geometry, place);
        if (type == "Polygon") {
            areas.push_back(area_of(coordinates_of(*geometry, place), place));
        } else if (type == "MultiPolygon") {
            for (const json& part : coordinates_of(*geometry, place)) areas.push_back(area_of(part, place));
        } else {
            place.fail(fmt::format("expected a Polygon, got {}", in_quotes(type)));
        }
    }
    if (areas.size() != 1) {
        throw InputError(fmt::format("{}: expected one polygon, the domain, got {}", file.string(), areas.size()));
    }
    return std::move(areas.front());
}

std::vector<std::vector<Vec2>> read_geojson_traces(const std::filesystem::path& file) {
    const json root = parse_file(file);
    std::vector<std::vector<Vec2>> traces;
    for (const auto& [geometry, place] : geometries_of(root, file.string())) {
        const std::string type = type_of(*geometry, place);
        if (type == "LineString") {
            traces.push_back(trace_of(coordinates_of(*geometry, place), place));
        } else if (type == "MultiLineString") {
            for (const json& part : coordinates_of(*geometry, place)) traces.push_back(trace_of(part, place));
        } else {
            place.fail(fmt::format("expected a LineString or a MultiLineString, got {}", in_quotes(type)));
        }
    }
    if (traces.empty()) throw InputError(fmt::format("{}: no traces", file.string()));
    return traces;
}

} // namespace kluft

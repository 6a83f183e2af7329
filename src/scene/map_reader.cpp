#include "kluft/scene/map_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/core/nearest_name.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/maps/coordinate_system.hpp"
#include "kluft/maps/gdal.hpp"
#include "kluft/maps/geojson.hpp"
#include "kluft/maps/map_file.hpp"
#include "kluft/scene/scene_tree.hpp"

namespace kluft {

namespace {

constexpr std::string_view degrees_of_rfc_7946 = "OGC:CRS84";
constexpr std::string_view local_metres = "local";

/// Where in a map something is said, as the errors name it.
struct MapPlace {
    std::string file;
    long long feature = -1; ///< -1 for a bare geometry

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(feature < 0 ? fmt::format("{}: {}", file, what)
                                     : fmt::format("{}: feature {}: {}", file, feature, what));
    }
};

// ---- shapes --------------------------------------------------------------------------------------------------------

/// The points without those equal to the one before.
std::vector<Vec2> different_points(std::vector<Vec2> points) {
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

Polygon ring_of_map(const std::vector<Vec2>& points, const MapPlace& place) {
    Polygon ring = different_points(points);
    if (ring.size() < 4)
        place.fail("expected a ring of at least three different points, the first repeated at the end");
    if (ring.front() != ring.back()) place.fail("a ring does not end at its first point");
    ring.pop_back();
    return ring;
}

MappedArea area_of_rings(const std::vector<std::vector<Vec2>>& rings, const MapPlace& place) {
    if (rings.empty()) place.fail("expected a polygon with at least one ring");
    MappedArea area;
    area.outline = ring_of_map(rings[0], place);
    for (std::size_t i = 1; i < rings.size(); ++i) area.holes.push_back(ring_of_map(rings[i], place));
    return area;
}

std::vector<Vec2> trace_of_map(const std::vector<Vec2>& points, const MapPlace& place) {
    std::vector<Vec2> trace = different_points(points);
    if (trace.size() < 2) place.fail("expected a trace of at least two different points");
    return trace;
}

// ---- coordinates ---------------------------------------------------------------------------------------------------

template <class Visit> void each_place_of(const MapLayer& layer, Visit visit) {
    for (const MapFeature& feature : layer.features) {
        for (const auto& line : feature.lines)
            for (const Vec2& point : line) visit(point);
        for (const auto& polygon : feature.polygons)
            for (const auto& ring : polygon)
                for (const Vec2& point : ring) visit(point);
    }
}

/// The box of all places; nothing without any.
std::optional<Box> box_of(const MapLayer& layer) {
    std::optional<Box> box;
    each_place_of(layer, [&](const Vec2& point) {
        if (!box) box = Box{point, point};
        box->lower = box->lower.cwiseMin(point);
        box->upper = box->upper.cwiseMax(point);
    });
    return box;
}

bool may_be_degrees(const Box& box) {
    return box.lower.x() >= -180.0 && box.upper.x() <= 180.0 && box.lower.y() >= -90.0 && box.upper.y() <= 90.0;
}

/// Numbers in the range of degrees that would make no sense as metres about an origin of one's own: a site of a few hundred
/// metres measures thousandths of a degree, and lies tens of degrees from the origin.
bool are_surely_degrees(const Box& box) {
    constexpr double largest_extent = 1.0; // degrees: 110 km
    constexpr double least_share = 20.0;
    const double extent = (box.upper - box.lower).lpNorm<Eigen::Infinity>();
    const double distance = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs()).lpNorm<Eigen::Infinity>();
    return may_be_degrees(box) && extent < largest_extent && distance > least_share * extent;
}

std::string box_in_words(const Box& box) {
    return fmt::format("from {} to {}", place_text(box.lower), place_text(box.upper));
}

/// The zone of UTM in which a place lies: "EPSG:32632".
std::string utm_zone_at(const Vec2& degrees) {
    const int zone = std::clamp(static_cast<int>(std::floor((degrees.x() + 180.0) / 6.0)) + 1, 1, 60);
    return fmt::format("EPSG:{}", (degrees.y() < 0.0 ? 32700 : 32600) + zone);
}

[[noreturn]] void refuse_degrees(const MapRequest& request, const Box& box, const std::string& why) {
    const Vec2 middle = 0.5 * (box.lower + box.upper);
    throw InputError(
        fmt::format("{}: expected metres, found degrees ({}; {}); geometry.crs names the system in metres to "
                    "project them to, as in geometry.crs: {}",
                    request.file.string(), why, box_in_words(box), utm_zone_at(middle)));
}

/// How the coordinates of a file are taken.
struct TakenCoordinates {
    std::string project_from; ///< empty: they stay
    std::string crs;          ///< then
    std::string remark;
};

/// A file that does not say its coordinate system.
TakenCoordinates take_unknown(const MapRequest& request, const Box& box, bool is_geojson) {
    if (!may_be_degrees(box)) return {{}, request.scene_crs, {}};
    if (!request.scene_crs.empty()) {
        if (is_geojson) return {std::string(degrees_of_rfc_7946), request.scene_crs, {}};
        throw InputError(
            fmt::format("{}: expected `file_crs` beside `file`, since the file names no coordinate system and "
                        "its coordinates ({}) may be degrees, found none; `file_crs: local` takes them for metres",
                        request.file.string(), box_in_words(box)));
    }
    if (are_surely_degrees(box))
        refuse_degrees(request, box,
                       "by their values; the file names no coordinate system, and `file_crs: local` takes "
                       "them for metres");
    return {{},
            {},
            fmt::format("{}: taken for metres: the file names no coordinate system, and its coordinates ({}) may be "
                        "degrees; `file_crs: local` says that they are not",
                        request.file.string(), box_in_words(box))};
}

/// Known without GDAL.
bool is_well_known_geographic(const std::string& crs) {
    constexpr std::array known{"OGC:CRS84", "OGC:CRS83", "EPSG:4326", "EPSG:4258", "EPSG:4269", "EPSG:4979"};
    return std::ranges::find(known, crs) != known.end();
}

/// A file that says its coordinate system, where GDAL cannot tell what it is.
TakenCoordinates take_named_without_gdal(const MapRequest& request, const std::string& crs, const Box& box) {
    if (request.scene_crs.empty() && is_well_known_geographic(crs)) refuse_degrees(request, box, crs);
    if (may_be_degrees(box) || !(request.scene_crs.empty() || request.scene_crs == crs))
        throw InputError(fmt::format("{}: expected coordinates that need no projection, found {}: {}",
                                     request.file.string(), crs, gdal_problem()));
    return {{}, crs, {}};
}

TakenCoordinates take_named(const MapRequest& request, const std::string& crs, const Box& box) {
    if (!gdal_problem().empty()) return take_named_without_gdal(request, crs, box);
    const CoordinateSystem system = describe_crs(crs);
    if (!request.scene_crs.empty()) return {crs, request.scene_crs, {}};
    if (system.is_geographic) refuse_degrees(request, box, system.name);
    if (system.unit != 1.0)
        throw InputError(
            fmt::format("{}: expected metres, found {}, whose unit has {:g} m; geometry.crs names a system in "
                        "metres to project them to",
                        request.file.string(), system.name, system.unit));
    return {{}, crs, {}};
}

TakenCoordinates take_coordinates(const MapRequest& request, const MapLayer& layer, bool is_geojson) {
    const auto box = box_of(layer);
    if (!box || request.file_crs == local_metres) return {{}, request.scene_crs, {}};
    const std::string crs = canonical_crs(request.file_crs.empty() ? layer.crs : request.file_crs);
    return crs.empty() ? take_unknown(request, *box, is_geojson) : take_named(request, crs, *box);
}

struct TakenMap {
    MapLayer layer;
    TakenCoordinates coordinates;
};

TakenMap take_map(const MapRequest& request) {
    const bool is_geojson = !is_map_file(request.file);
    if (is_geojson && !request.layer.empty())
        throw InputError(fmt::format("{}: expected no `layer` beside GeoJSON, which has none, found {}",
                                     request.file.string(), in_quotes(request.layer)));
    TakenMap map;
    map.layer = is_geojson ? read_geojson(request.file) : read_map_layer(request.file, request.layer);
    map.coordinates = take_coordinates(request, map.layer, is_geojson);
    if (!map.coordinates.project_from.empty()) {
        try {
            project(map.layer, map.coordinates.project_from, map.coordinates.crs);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: {}", request.file.string(), error.what()));
        }
    }
    return map;
}

/// Index of the attribute in the fields of the layer; nothing where none is asked for.
std::optional<std::size_t> field_of(const MapRequest& request, const MapLayer& layer) {
    if (request.attribute.empty()) return std::nullopt;
    const auto found = std::ranges::find(layer.fields, request.attribute);
    if (found == layer.fields.end()) {
        InputProblem problem;
        problem.path = "attribute";
        problem.message = fmt::format("{}: expected an attribute of its features ({}), found {}{}",
                                      request.file.string(), listed(layer.fields), in_quotes(request.attribute),
                                      suggestion(request.attribute, layer.fields));
        throw InputError(std::vector{problem});
    }
    return static_cast<std::size_t>(found - layer.fields.begin());
}

} // namespace

MappedArea read_map_area(const MapRequest& request) {
    const auto [layer, coordinates] = take_map(request);
    std::vector<MappedArea> areas;
    for (const MapFeature& feature : layer.features) {
        const MapPlace place{request.file.string(), feature.id};
        if (feature.type.empty()) continue;
        if (feature.type != "Polygon" && feature.type != "MultiPolygon")
            place.fail(fmt::format("expected a Polygon, found {}", in_quotes(feature.type)));
        for (const auto& rings : feature.polygons) areas.push_back(area_of_rings(rings, place));
    }
    if (areas.size() != 1)
        throw InputError(
            fmt::format("{}: expected one polygon, the domain, found {}", request.file.string(), areas.size()));
    areas.front().crs = coordinates.crs;
    areas.front().remark = coordinates.remark;
    return std::move(areas.front());
}

MappedTraces read_map_traces(const MapRequest& request) {
    const auto [layer, coordinates] = take_map(request);
    const auto field = field_of(request, layer);
    MappedTraces read{{}, coordinates.crs, coordinates.remark};
    for (const MapFeature& feature : layer.features) {
        const MapPlace place{request.file.string(), feature.id};
        if (feature.type.empty()) continue;
        if (feature.type != "LineString" && feature.type != "MultiLineString")
            place.fail(fmt::format("expected a LineString or a MultiLineString, found {}", in_quotes(feature.type)));
        std::optional<std::string> value;
        if (field && !std::holds_alternative<std::monostate>(feature.values[*field]))
            value = map_value_text(feature.values[*field]);
        for (const auto& line : feature.lines) read.traces.push_back({trace_of_map(line, place), value});
    }
    if (read.traces.empty()) throw InputError(fmt::format("{}: no traces", request.file.string()));
    return read;
}

} // namespace kluft

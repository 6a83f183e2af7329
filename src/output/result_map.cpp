#include "kluft/output/result_map.hpp"

#include <cmath>
#include <utility>

#include "kluft/core/units.hpp"
#include "kluft/output/block_outline.hpp"

namespace kluft {

namespace {

std::vector<Vec2> ring_of_block(const BlockSystem& system, const Block& block, std::pair<int, int> loop) {
    std::vector<Vec2> ring;
    for (int edge = loop.first; edge < loop.second; ++edge)
        ring.emplace_back(system.origin + edge_start(system, block.edges[edge]));
    ring.push_back(ring.front());
    return ring;
}

/// Mean displacement over a block: exact for one that is linear in the place. The triangles between the block's first
/// corner and its edges, which count negative where they lie outside, make up the block.
Vec2 mean_displacement(const BlockSystem& system, const Block& block, const Vec2* displacement) {
    const Vec2 apex = edge_start(system, block.edges[0]);
    Vec2 sum = Vec2::Zero();
    double area = 0.0;
    for (int edge = 0; edge < static_cast<int>(block.edges.size()); ++edge) {
        const Vec2 a = edge_start(system, block.edges[edge]) - apex;
        const Vec2 b = edge_end(system, block.edges[edge]) - apex;
        const double triangle = 0.5 * cross(a, b);
        sum += triangle / 3.0 * (displacement[0] + displacement[edge] + displacement[next_edge(block, edge)]);
        area += triangle;
    }
    return sum / area;
}

/// Clockwise from y, the map's north, to the direction of the largest compression: 0 to 180 degrees.
double azimuth_of_sigma_1(const Mat2& stress) {
    const Mat2 compression = -0.5 * (stress + stress.transpose());
    const double from_x = 0.5 * std::atan2(2.0 * compression(0, 1), compression(0, 0) - compression(1, 1));
    const double azimuth = 90.0 - from_x * degrees;
    return azimuth >= 180.0 ? azimuth - 180.0 : azimuth;
}

std::string text_of_name(const std::vector<std::string>& names, int index) {
    return index >= 0 && index < static_cast<int>(names.size()) ? names[static_cast<std::size_t>(index)] : "";
}

/// Of each block, how many of its bonds have failed.
std::vector<long long> failed_bonds(const BlockSystem& system, const FieldRecord& fields) {
    std::vector<long long> failed(system.blocks.size(), 0);
    for (std::size_t i = 0; i < system.interfaces.size(); ++i) {
        if (!fields.interfaces[i].broken) continue;
        ++failed[static_cast<std::size_t>(system.interfaces[i].block_a)];
        ++failed[static_cast<std::size_t>(system.interfaces[i].block_b)];
    }
    return failed;
}

MapLayer block_layer(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names) {
    MapLayer layer;
    layer.name = "blocks";
    layer.fields = {"block",     "material",        "displacement", "displacement_x", "displacement_y",
                    "sigma_1",   "sigma_3",         "stress_xx",    "stress_yy",      "stress_xy",
                    "stress_zz", "sigma_1_azimuth", "failed_bonds"};
    const auto first = first_vertices(system);
    const auto failed = failed_bonds(system, fields);
    for (std::size_t b = 0; b < system.blocks.size(); ++b) {
        const Block& block = system.blocks[b];
        MapFeature& feature = layer.features.emplace_back();
        auto& rings = feature.polygons.emplace_back();
        for (const auto& loop : loop_ranges(block)) rings.push_back(ring_of_block(system, block, loop));
        const Vec2 moved = mean_displacement(system, block, &fields.displacement[first[b]]);
        const Mat2& stress = fields.stress[b];
        const auto [sigma_1, sigma_3] = principal_compression(stress);
        feature.values = {static_cast<long long>(b),
                          text_of_name(names.materials, block.material),
                          moved.norm(),
                          moved.x(),
                          moved.y(),
                          sigma_1,
                          sigma_3,
                          0.0 - stress(0, 0),
                          0.0 - stress(1, 1),
                          -0.5 * (stress(0, 1) + stress(1, 0)),
                          0.0 - fields.stress_zz[b],
                          azimuth_of_sigma_1(stress),
                          failed[b]};
    }
    return layer;
}

const char* origin_text(EdgeOrigin origin) {
    switch (origin) {
    case EdgeOrigin::boundary:
        return "boundary";
    case EdgeOrigin::fracture:
        return "fracture";
    case EdgeOrigin::tessellation:
        return "net";
    case EdgeOrigin::given:
        return "given";
    }
    return "";
}

const char* state_text(ContactState state) {
    switch (state) {
    case ContactState::open:
        return "open";
    case ContactState::sliding:
        return "sliding";
    case ContactState::locked:
        return "locked";
    }
    return "";
}

MapValue failure_text(const FieldRecord::InterfaceFields& fields) {
    if (!fields.broken) return {};
    return std::string(fields.mode == CrackMode::tension ? "tension" : "shear");
}

MapLayer interface_layer(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names) {
    MapLayer layer;
    layer.name = "interfaces";
    layer.fields = {"interface", "block_a",         "block_b",       "kind",  "type",
                    "fracture",  "bonded",          "failure",       "state", "slip",
                    "opening",   "normal_traction", "shear_traction"};
    for (std::size_t i = 0; i < system.interfaces.size(); ++i) {
        const Interface& interface = system.interfaces[i];
        const auto& each = fields.interfaces[i];
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        MapFeature& feature = layer.features.emplace_back();
        feature.lines = {{system.origin + edge_start(system, edge), system.origin + edge_end(system, edge)}};
        const std::string fracture = text_of_name(names.fractures, interface.fracture);
        feature.values = {static_cast<long long>(i),
                          static_cast<long long>(interface.block_a),
                          static_cast<long long>(interface.block_b),
                          std::string(origin_text(interface.origin)),
                          text_of_name(names.interface_types, interface.interface_type),
                          fracture.empty() ? MapValue{} : MapValue{fracture},
                          static_cast<long long>(each.bonded),
                          failure_text(each),
                          std::string(state_text(each.state)),
                          each.slip,
                          each.gap,
                          0.0 - each.normal_traction,
                          each.shear_traction};
    }
    return layer;
}

} // namespace

std::vector<MapLayer> result_layers(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names,
                                    const std::string& crs) {
    std::vector<MapLayer> layers{block_layer(system, fields, names), interface_layer(system, fields, names)};
    for (MapLayer& layer : layers) layer.crs = crs;
    return layers;
}

} // namespace kluft

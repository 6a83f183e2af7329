#include "kluft/output/vtu.hpp"

#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/output/block_outline.hpp"
#include "vtu_document.hpp"

namespace kluft {

namespace {

constexpr std::uint8_t vtk_line = 3;
constexpr std::uint8_t vtk_polygon = 7;

/// Number `code` of `kind` is called so.
void add_name(VtuDocument& document, std::string_view kind, std::string_view name, std::size_t code) {
    document.add_field(fmt::format("{}: {}", kind, name), static_cast<std::int32_t>(code));
}

void add_names(VtuDocument& document, std::string_view kind, const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i) add_name(document, kind, names[i], i);
}

void add_units(VtuDocument& document, const std::vector<std::string>& units) {
    for (const std::string& each : units) document.add_field("unit of " + each, 1);
}

void add_stamp(VtuDocument& document, const StepRecord& record) {
    document.add_field("step", static_cast<std::int32_t>(record.step));
    document.add_field("stage", static_cast<std::int32_t>(record.stage));
    document.add_field("load_factor", record.load_factor);
    document.add_field("axial_strain", record.axial_strain);
}

void add_types(VtuDocument& document, std::size_t n_cells, std::uint8_t type) {
    auto types = document.types();
    for (std::size_t i = 0; i < n_cells; ++i) types.put(type);
}

void add_block_shapes(VtuDocument& document, const BlockSystem& system, const FieldRecord& fields) {
    {
        auto points = document.points();
        for (const Block& block : system.blocks) {
            for (const Edge& edge : block.edges) points.put(Vec2(system.origin + edge_start(system, edge)));
        }
    }
    std::vector<std::int64_t> ends;
    ends.reserve(system.blocks.size());
    {
        auto connectivity = document.connectivity();
        std::int64_t first = 0;
        std::int64_t end = 0;
        for (const Block& block : system.blocks) {
            for (const int edge : keyhole_polygon(system, block)) {
                connectivity.put(first + edge);
                ++end;
            }
            ends.push_back(end);
            first += static_cast<std::int64_t>(block.edges.size());
        }
    }
    {
        auto array = document.ends();
        for (const std::int64_t end : ends) array.put(end);
    }
    add_types(document, system.blocks.size(), vtk_polygon);
    auto displacement = document.point_vectors("displacement");
    for (const Vec2& u : fields.displacement) displacement.put(u);
}

void add_block_fields(VtuDocument& document, const BlockSystem& system, const FieldRecord& fields) {
    const auto& stress = fields.stress;
    {
        auto tensors = document.cell_tensors("stress");
        for (std::size_t b = 0; b < stress.size(); ++b)
            tensors.put(Mat2(-0.5 * (stress[b] + stress[b].transpose())), 0.0 - fields.stress_zz[b]);
    }
    document.add_cell_field("sigma_1", [&](std::size_t b) { return principal_compression(stress[b]).first; });
    document.add_cell_field("sigma_3", [&](std::size_t b) { return principal_compression(stress[b]).second; });
    document.add_cell_field("material", [&](std::size_t b) { return std::int32_t{system.blocks[b].material}; });
    document.add_cell_field("block", [](std::size_t b) { return static_cast<std::int32_t>(b); });
}

void add_interface_shapes(VtuDocument& document, const BlockSystem& system, const FieldRecord& fields) {
    const std::size_t n = system.interfaces.size();
    {
        auto points = document.points();
        for (const Interface& interface : system.interfaces) {
            const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
            points.put(Vec2(system.origin + edge_start(system, edge)));
            points.put(Vec2(system.origin + edge_end(system, edge)));
        }
    }
    {
        auto connectivity = document.connectivity();
        for (std::size_t i = 0; i < 2 * n; ++i) connectivity.put(static_cast<std::int64_t>(i));
    }
    {
        auto ends = document.ends();
        for (std::size_t i = 0; i < n; ++i) ends.put(static_cast<std::int64_t>(2 * i + 2));
    }
    add_types(document, n, vtk_line);
    auto displacement = document.point_vectors("displacement");
    const auto first = first_vertices(system);
    for (const Interface& interface : system.interfaces) {
        const InterfaceMotion motion = interface_motion(system, first, fields.displacement, interface);
        displacement.put(Vec2(0.5 * (motion.start_a + motion.start_b)));
        displacement.put(Vec2(0.5 * (motion.end_a + motion.end_b)));
    }
}

std::int32_t mode_code(const FieldRecord::InterfaceFields& fields) {
    if (!fields.broken) return 0;
    return fields.mode == CrackMode::tension ? 1 : 2;
}

std::int32_t state_code(ContactState state) {
    switch (state) {
    case ContactState::open:
        return 0;
    case ContactState::sliding:
        return 1;
    case ContactState::locked:
        return 2;
    }
    return 2;
}

void add_interface_fields(VtuDocument& document, const BlockSystem& system, const FieldRecord& fields) {
    const auto& each = fields.interfaces;
    document.add_cell_field("state", [&](std::size_t i) { return state_code(each[i].state); });
    document.add_cell_field("bonded", [&](std::size_t i) { return std::int32_t{each[i].bonded}; });
    document.add_cell_field("crack_mode", [&](std::size_t i) { return mode_code(each[i]); });
    document.add_cell_field("normal_traction", [&](std::size_t i) { return 0.0 - each[i].normal_traction; });
    document.add_cell_field("shear_traction", [&](std::size_t i) { return each[i].shear_traction; });
    document.add_cell_field("gap", [&](std::size_t i) { return each[i].gap; });
    document.add_cell_field("slip", [&](std::size_t i) { return each[i].slip; });
    document.add_cell_field("block_a", [&](std::size_t i) { return std::int32_t{system.interfaces[i].block_a}; });
    document.add_cell_field("block_b", [&](std::size_t i) { return std::int32_t{system.interfaces[i].block_b}; });
    {
        auto vectors = document.cell_vectors("relative_displacement");
        for (const auto& interface : each) vectors.put(interface.relative);
    }
    {
        auto vectors = document.cell_vectors("contact_force");
        for (const auto& interface : each) vectors.put(interface.force);
    }
    document.add_cell_field("interface_type", [&](std::size_t i) { return system.interfaces[i].interface_type; });
    document.add_cell_field("mapped_fracture", [&](std::size_t i) { return system.interfaces[i].fracture; });
    document.add_cell_field("interface", [](std::size_t i) { return static_cast<std::int32_t>(i); });
}

} // namespace

std::pair<double, double> principal_compression(const Mat2& stress) {
    const double mean = 0.5 * (stress(0, 0) + stress(1, 1));
    const double shear = 0.5 * (stress(0, 1) + stress(1, 0));
    const double radius = std::hypot(0.5 * (stress(0, 0) - stress(1, 1)), shear);
    return {radius - mean, -radius - mean};
}

std::string blocks_vtu(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names,
                       const StepRecord& record) {
    VtuDocument document(first_vertices(system).back(), system.blocks.size());
    add_stamp(document, record);
    add_names(document, "material", names.materials);
    add_units(document, {"displacement: m", "stress: Pa, positive in compression",
                         "sigma_1: Pa, positive in compression", "sigma_3: Pa, positive in compression"});
    add_block_shapes(document, system, fields);
    add_block_fields(document, system, fields);
    return document.content();
}

std::string interfaces_vtu(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names,
                           const StepRecord& record) {
    VtuDocument document(2 * system.interfaces.size(), system.interfaces.size());
    add_stamp(document, record);
    add_names(document, "state", {"open", "sliding", "locked"});
    add_names(document, "crack_mode", {"none", "tension", "shear"});
    add_names(document, "interface_type", names.interface_types);
    add_names(document, "mapped_fracture", names.fractures);
    add_units(document, {"displacement: m", "normal_traction: Pa, positive in compression", "shear_traction: Pa",
                         "gap: m, positive when open", "slip: m", "relative_displacement: m, of side b against side a",
                         "contact_force: N per metre of thickness, on side a"});
    add_interface_shapes(document, system, fields);
    add_interface_fields(document, system, fields);
    return document.content();
}

} // namespace kluft

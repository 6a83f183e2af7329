#include "kluft/output/vtu.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "file_descriptor.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/block_outline.hpp"
#include "vtu_document.hpp"

namespace kluft {

namespace fs = std::filesystem;

namespace {

constexpr std::uint8_t vtk_line = 3;
constexpr std::uint8_t vtk_polygon = 7;

void add_stamp(VtuDocument& document, const StepRecord& record, std::string_view about) {
    document.add_field("about", std::vector<std::string>{std::string(about)});
    document.add_field("step", static_cast<std::int32_t>(record.step));
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
        for (const Mat2& each : stress) tensors.put(Mat2(-0.5 * (each + each.transpose())));
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
    document.add_cell_field("mapped_fracture", [&](std::size_t i) { return system.interfaces[i].fracture; });
    document.add_cell_field("interface", [](std::size_t i) { return static_cast<std::int32_t>(i); });
}

std::string file_name(std::string_view part, int step) { return fmt::format("{}_{:06}.vtu", part, step); }

/// The load step in the name of a field file of the given part.
std::optional<int> step_of(const std::string& name, std::string_view part) {
    const std::string prefix = std::string(part) + '_';
    if (!name.starts_with(prefix)) return std::nullopt;
    int step = 0;
    const char* const end = name.data() + name.size();
    const auto result = std::from_chars(name.data() + prefix.size(), end, step);
    if (result.ec != std::errc()) return std::nullopt;
    const std::string_view rest(result.ptr, end);
    return rest == ".vtu" || rest == ".vtu.part" ? std::optional(step) : std::nullopt;
}

/// The files of a series in `directory`/fields with their load steps.
std::vector<std::pair<fs::path, int>> field_files(const fs::path& directory) {
    std::vector<std::pair<fs::path, int>> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(directory / "fields", none)) {
        const std::string name = entry.path().filename();
        for (const std::string_view part : {"blocks", "interfaces"})
            if (const auto step = step_of(name, part)) files.emplace_back(entry.path(), *step);
    }
    return files;
}

} // namespace

std::pair<double, double> principal_compression(const Mat2& stress) {
    const double mean = 0.5 * (stress(0, 0) + stress(1, 1));
    const double shear = 0.5 * (stress(0, 1) + stress(1, 0));
    const double radius = std::hypot(0.5 * (stress(0, 0) - stress(1, 1)), shear);
    return {radius - mean, -radius - mean};
}

std::string blocks_vtu(const BlockSystem& system, const FieldRecord& fields,
                       const std::vector<std::string>& material_names, const StepRecord& record) {
    VtuDocument document(first_vertices(system).back(), system.blocks.size());
    add_stamp(document, record,
              "SI units. Stresses are positive in compression; sigma_1, sigma_3: principal stresses in the plane. "
              "Points: before loading; warp by displacement to see the blocks deformed.");
    document.add_field("material_names", material_names);
    add_block_shapes(document, system, fields);
    add_block_fields(document, system, fields);
    return document.content();
}

std::string interfaces_vtu(const BlockSystem& system, const FieldRecord& fields, const StepRecord& record) {
    VtuDocument document(2 * system.interfaces.size(), system.interfaces.size());
    add_stamp(document, record,
              "SI units. state: 0 open, 1 sliding, 2 locked; crack_mode: 0 none, 1 tension, 2 shear; normal_traction: "
              "positive in compression; gap: positive when open. Points: before loading.");
    add_interface_shapes(document, system, fields);
    add_interface_fields(document, system, fields);
    return document.content();
}

FieldSeries::FieldSeries(fs::path directory) : directory_(std::move(directory)) {}

FieldSeries FieldSeries::create(const fs::path& directory) {
    remove(directory);
    make_directory(directory / "fields");
    FieldSeries series(directory);
    series.write_series();
    return series;
}

FieldSeries FieldSeries::resume(const fs::path& directory, int last_step) {
    make_directory(directory / "fields");
    FieldSeries series(directory);
    for (const auto& [file, step] : field_files(directory)) {
        const bool whole = file.extension() == ".vtu";
        if (step > last_step || !whole)
            remove_file(file);
        else if (file.filename().string().starts_with("interfaces")) // the later of the two
            series.steps_.push_back(step);
    }
    std::sort(series.steps_.begin(), series.steps_.end());
    series.write_series();
    return series;
}

void FieldSeries::remove(const fs::path& directory) {
    remove_file(directory / "fields.pvd");
    for (const auto& [file, step] : field_files(directory)) remove_file(file);
    std::error_code ignored;
    const fs::path folder = directory / "fields";                      // a link to where there is more room stays
    if (!fs::is_symlink(folder, ignored)) fs::remove(folder, ignored); // only when nothing else is in it
}

void FieldSeries::add(const BlockSystem& system, const FieldRecord& fields,
                      const std::vector<std::string>& material_names, const StepRecord& record) {
    const fs::path folder = directory_ / "fields";
    write_file(folder / file_name("blocks", record.step), blocks_vtu(system, fields, material_names, record));
    write_file(folder / file_name("interfaces", record.step), interfaces_vtu(system, fields, record));
    if (steps_.empty() || steps_.back() != record.step) steps_.push_back(record.step);
    write_series();
}

void FieldSeries::write_series() const {
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    for (const int step : steps_) {
        int part = 0;
        for (const std::string_view name : {"blocks", "interfaces"})
            text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"fields/{}\"/>\n", step, part++,
                                file_name(name, step));
    }
    write_file(directory_ / "fields.pvd", text + "</Collection>\n</VTKFile>\n");
}

} // namespace kluft

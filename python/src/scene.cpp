// Scenes: what their texts say, what is wrong with them, what they amount to.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/block_outline.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/scene/scene_account.hpp"
#include "kluft/scene/scene_check.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/scene/scene_text.hpp"
#include "kluft/studies/scene_run.hpp"
#include "module.hpp"

namespace py = pybind11;

namespace kluft {

namespace {

py::object value_of(const SceneNode& node);

py::object scalar_value(const SceneNode& node) {
    if (node.quoted) return py::str(node.text);
    if (const auto integer = read_integer(node.text)) return py::int_(*integer);
    if (const auto number = read_number(node.text)) return py::float_(*number);
    if (node.text == "true" || node.text == "false") return py::bool_(node.text == "true");
    return py::str(node.text);
}

py::object value_of(const SceneNode& node) {
    switch (node.kind) {
    case SceneNode::Kind::nothing:
        return py::none();
    case SceneNode::Kind::scalar:
        return scalar_value(node);
    case SceneNode::Kind::list: {
        py::list list;
        for (const SceneNode& item : node.items) list.append(value_of(item));
        return list;
    }
    case SceneNode::Kind::mapping: {
        py::dict mapping;
        for (std::size_t i = 0; i < node.keys.size(); ++i)
            mapping[py::str(node.keys[i].text)] = value_of(node.items[i]);
        return mapping;
    }
    }
    return py::none();
}

/// Everything that the scene says, settings and extended scenes in it.
py::object scene_value(const SceneText& scene) {
    SceneSources sources;
    SceneErrors errors(sources);
    const SceneNode root = build_scene_tree(scene.text, scene.file, scene.settings, sources, errors);
    errors.throw_if_any();
    return value_of(root);
}

/// Throws InputError for keys and values that the schema does not take, one by one; nothing of how they go together.
void check_keys(const SceneText& scene) {
    SceneSources sources;
    SceneErrors errors(sources);
    const SceneNode root = build_scene_tree(scene.text, scene.file, scene.settings, sources, errors);
    check_against_schema(root, errors);
    errors.throw_if_any();
}

/// The scene as YAML, settings and extended scenes in it, names of files absolute.
std::string scene_yaml(const SceneText& scene) { return read_scene_text(scene.text, scene.settings, scene.file).text; }

py::dict account(const SceneText& text) {
    const auto found = [&] {
        const py::gil_scoped_release others;
        const Scene scene = read_scene_text(text.text, text.settings, text.file);
        return account_of(scene, build_for_run(scene));
    }();
    py::list lines;
    for (const auto& [name, line] : found.lines) lines.append(py::make_tuple(name, line));
    py::dict result;
    result["blocks"] = found.blocks;
    result["interfaces"] = found.interfaces;
    result["unknowns"] = found.unknowns;
    result["smallest_area"] = found.smallest_area;
    result["smallest_edge"] = found.smallest_edge;
    result["smallest_angle"] = found.smallest_angle;
    result["merged"] = found.merged;
    result["memory_bytes"] = found.memory_bytes;
    result["lines"] = lines;
    result["warnings"] = found.warnings;
    result["text"] = text_of(found);
    return result;
}

/// The arrays of a body before any load.
struct BodyArrays {
    std::vector<double> corners; ///< of all blocks one after the other, (n, 2), scene coordinates (m)
    std::vector<std::int64_t> ends;
    std::vector<std::int32_t> material;
    std::vector<double> lines; ///< of interfaces, (n, 2, 2)
    std::vector<std::int32_t> mapped_fracture, block_a, block_b;
};

void put(std::vector<double>& numbers, const Vec2& point) { numbers.insert(numbers.end(), {point.x(), point.y()}); }

BodyArrays arrays_of(const BlockSystem& system) {
    BodyArrays arrays;
    for (const Block& block : system.blocks) {
        for (const int edge : keyhole_polygon(system, block))
            put(arrays.corners, system.origin + edge_start(system, block.edges[edge]));
        arrays.ends.push_back(static_cast<std::int64_t>(arrays.corners.size() / 2));
        arrays.material.push_back(block.material);
    }
    for (const Interface& interface : system.interfaces) {
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        put(arrays.lines, system.origin + edge_start(system, edge));
        put(arrays.lines, system.origin + edge_end(system, edge));
        arrays.mapped_fracture.push_back(interface.fracture);
        arrays.block_a.push_back(interface.block_a);
        arrays.block_b.push_back(interface.block_b);
    }
    return arrays;
}

template <class Number>
py::array array_of(const std::shared_ptr<BodyArrays>& arrays, const std::vector<Number>& numbers,
                   std::vector<py::ssize_t> shape) {
    return array_over(arrays, numbers.data(), std::move(shape));
}

py::dict body(const SceneText& text) {
    const auto arrays = [&] {
        const py::gil_scoped_release others;
        const Scene scene = read_scene_text(text.text, text.settings, text.file);
        return std::make_shared<BodyArrays>(arrays_of(build_scene_model(scene).model.system));
    }();
    const auto n_corners = static_cast<py::ssize_t>(arrays->corners.size() / 2);
    const auto n_blocks = static_cast<py::ssize_t>(arrays->ends.size());
    const auto n_lines = static_cast<py::ssize_t>(arrays->block_a.size());
    py::dict result;
    result["corners"] = array_of(arrays, arrays->corners, {n_corners, 2});
    result["ends"] = array_of(arrays, arrays->ends, {n_blocks});
    result["material"] = array_of(arrays, arrays->material, {n_blocks});
    result["lines"] = array_of(arrays, arrays->lines, {n_lines, 2, 2});
    result["mapped_fracture"] = array_of(arrays, arrays->mapped_fracture, {n_lines});
    result["block_a"] = array_of(arrays, arrays->block_a, {n_lines});
    result["block_b"] = array_of(arrays, arrays->block_b, {n_lines});
    return result;
}

} // namespace

void bind_scene(py::module_& module) {
    py::class_<SceneText>(module, "SceneText")
        .def(py::init([](std::string text, std::vector<std::string> settings, std::string file) {
            return SceneText{std::move(text), std::move(settings), std::move(file)};
        }));
    module.def("scene_bytes", [](const std::string& file) { return py::bytes(read_scene_bytes(file)); });
    module.def("scene_value", scene_value);
    module.def("check_keys", check_keys);
    module.def("scene_yaml", scene_yaml);
    module.def("account", account);
    module.def("body", body);
}

} // namespace kluft

#include "kluft/scene/scene_reader.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/memory.hpp"
#include "kluft/scene/geometry_reader.hpp"
#include "kluft/scene/load_reader.hpp"
#include "kluft/scene/net_check.hpp"
#include "kluft/scene/plausibility.hpp"
#include "kluft/scene/property_reader.hpp"
#include "kluft/scene/quantity.hpp"
#include "kluft/scene/reading_context.hpp"
#include "kluft/scene/scene_check.hpp"
#include "kluft/scene/scene_section.hpp"
#include "kluft/scene/scene_text.hpp"
#include "kluft/scene/scene_writer.hpp"

namespace kluft {

namespace {

void read_analysis(const SceneSection& root, Scene& scene) {
    const auto analysis = root.section("analysis");
    scene.plane = static_cast<Plane>(analysis.choice("plane"));
    scene.kinematics = static_cast<Kinematics>(analysis.choice("kinematics"));
    const Vec2 gravity = analysis.given_gravity("gravity").value_or(Vec2::Zero());
    scene.gravity_x = gravity.x();
    scene.gravity_y = gravity.y();
}

constexpr std::array explicit_keys{"damping", "density_scaling", "loading_rate", "crack_check_interval"};

void read_integrator(const SceneSection& root, Scene& scene, ReadingContext& context) {
    const auto analysis = root.section("analysis");
    scene.integrator = static_cast<Integrator>(analysis.choice("integrator"));
    if (scene.integrator == Integrator::implicit) {
        for (const auto* key : explicit_keys)
            if (analysis.has(key))
                context.fail(analysis, key, "expected integrator: explicit beside it, found integrator: implicit");
        return;
    }
    if (scene.kinematics == Kinematics::rigid)
        context.fail(analysis, "kinematics", "expected affine beside integrator: explicit, found rigid");
    ExplicitOptions& options = scene.explicit_options;
    options.damping = analysis.number("damping");
    options.density_scaling = static_cast<DensityScaling>(analysis.choice("density_scaling"));
    options.loading_rate = analysis.given_number("loading_rate").value_or(0.0);
    options.crack_check_interval = analysis.count("crack_check_interval");
    if (options.density_scaling != DensityScaling::none) return;
    for (const auto& section : root.sections("materials"))
        if (!(section.given_number("density").value_or(0.0) > 0.0))
            context.fail(section, "density",
                         "expected a number > 0 in kg/m3 because of density_scaling: none, found none");
}

/// A factor of safety is sought between equilibria.
void refuse_explicit_reduction(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    if (scene.integrator == Integrator::implicit) return;
    for (const auto& stage : root.sections("stages"))
        if (stage.has("strength_reduction"))
            context.fail(stage, "strength_reduction",
                         "expected integrator: implicit beside it, found integrator: explicit");
}

/// Load steps of an explicit run are what its loading rate says; those from an accuracy have no number to count by.
void check_accuracy(const SceneSection& solver, const Scene& scene, ReadingContext& context) {
    if (scene.integrator != Integrator::implicit) {
        constexpr auto message = "expected integrator: implicit beside it, found integrator: explicit";
        if (solver.has("accuracy")) context.fail(solver, "accuracy", message);
        if (solver.count("detection_every") > 1) context.fail(solver, "detection_every", message);
    } else if (solver.has("accuracy") && scene.cracks.every > 1) {
        context.fail(solver, "accuracy",
                     fmt::format("expected cracks.every: 1 beside it, found cracks.every: {}", scene.cracks.every));
    }
}

CrackOptions read_crack_options(const SceneSection& section) {
    CrackOptions options;
    options.criterion = static_cast<CrackCriterion>(section.choice("criterion"));
    options.update = static_cast<CrackUpdate>(section.choice("update"));
    options.every = section.count("every");
    options.event_tolerance = section.number("event_tolerance");
    options.strength_noise = {.deviation = section.number("strength_noise"),
                              .seed = static_cast<std::uint64_t>(section.integer("strength_seed"))};
    return options;
}

SolverOptions read_solver_options(const SceneSection& section) {
    SolverOptions options;
    options.tolerance = section.number("tolerance");
    options.balance = section.number("balance");
    options.accuracy = section.given_number("accuracy").value_or(0.0);
    options.detection_every = section.count("detection_every");
    options.viscosity = section.number("viscosity");
    options.max_iterations = section.count("max_iterations");
    options.max_unbalanced_steps = section.count("max_unbalanced_steps");
    options.max_step_solves = section.count("max_step_solves");
    options.tangent = static_cast<Tangent>(section.choice("tangent"));
    options.reuse = section.boolean("reuse");
    options.repeatable = section.boolean("repeatable");
    return options;
}

OutputOptions read_output_options(const SceneSection& section) {
    OutputOptions options;
    options.fields = section.boolean("fields");
    options.fields_every = section.count("fields_every");
    options.fields_at_cracks = section.count("fields_at_cracks");
    options.pictures = section.boolean("pictures");
    options.report = section.boolean("report");
    options.checkpoint_every = section.count("checkpoint_every");
    options.checkpoint_seconds = section.number("checkpoint_seconds");
    return options;
}

/// The fractures that a history names: those of the traces with that name.
std::vector<int> fractures_called(const SceneSection& section, const GeometrySpec& geometry, ReadingContext& context) {
    const auto names = names_of(geometry.fractures);
    const std::string name = section.given_text("fracture").value_or("");
    if (!context.index_of(section, "fracture", name, names, "a mapped fracture")) return {};
    std::vector<int> found;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) found.push_back(static_cast<int>(i));
    return found;
}

HistoryRequest read_history_request(const SceneSection& section, const GeometrySpec& geometry,
                                    ReadingContext& context) {
    HistoryRequest request;
    request.name = section.name();
    if (!section.node()->is_mapping()) return request;
    const auto known_block = [&](std::string_view key, const std::string& name) {
        (void)context.index_of(section, key, name, block_names(geometry), "a block or a set of one");
        return name;
    };
    const bool of_block = section.has("block") || section.has("point");
    if (static_cast<int>(of_block) + static_cast<int>(section.has("fracture")) +
            static_cast<int>(section.has("interface")) !=
        1) {
        context.fail(section, {}, "expected either block and point (or one of them), or fracture, or interface");
        return request;
    }
    if (section.has("fracture")) request.fractures = fractures_called(section, geometry, context);
    if (section.has("interface")) {
        const auto names = section.texts("interface");
        if (names.size() != 2)
            context.fail(section, "interface", "expected the names of two blocks");
        else if (names[0] == names[1])
            context.fail(section, "interface",
                         "expected two different blocks, found " + in_quotes(names[0]) + " twice");
        else
            request.pair = {known_block("interface", names[0]), known_block("interface", names[1])};
    }
    if (const auto block = section.given_text("block")) request.block = known_block("block", *block);
    request.point = section.given_point("point");
    return request;
}

bool has_gravity(const Scene& scene) { return scene.gravity_x != 0.0 || scene.gravity_y != 0.0; }

void require_densities(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const bool in_a_stage = std::any_of(scene.loads.stages.begin(), scene.loads.stages.end(),
                                        [](const Stage& s) { return s.gravity && *s.gravity != Vec2::Zero(); });
    if (!has_gravity(scene) && !in_a_stage) return;
    for (const auto& section : root.sections("materials"))
        if (!section.has("density"))
            context.fail(section, "density", "expected a number > 0 in kg/m3 because there is gravity, found nothing");
}

/// Interfaces on fractures and hexagons and between given blocks, and what those fail to.
std::set<int> used_interface_types(const Scene& scene) {
    std::set<int> used;
    for (const auto& fracture : scene.geometry.fractures) used.insert(fracture.interface_type);
    if (scene.geometry.tessellation) used.insert(scene.geometry.tessellation->interface_type);
    if (!scene.geometry.blocks.empty() && !scene.interface_types.empty()) used.insert(scene.geometry.blocks_interface);
    used.erase(-1);
    std::set<int> successors;
    for (const int type : used) successors.insert(scene.interface_types[static_cast<std::size_t>(type)].fails_to);
    successors.erase(-1);
    used.merge(successors);
    return used;
}

/// Potential cracks take their strength from somewhere.
void require_strength(const SceneSection& section, const InterfaceType& type, const Scene& scene,
                      ReadingContext& context) {
    if (type.kind != InterfaceKind::potential_crack || type.strength) return;
    for (const int index : materials_of_body(scene)) {
        const Material& material = scene.materials[static_cast<std::size_t>(index)];
        if (!material.strength)
            context.fail(section, {},
                         fmt::format("expected cohesion, friction_angle and tensile_strength here or in the material "
                                     "{}, found neither",
                                     material.name));
    }
}

/// Stiffnesses that are not in Pa/m need a spacing.
void require_spacing(const SceneSection& section, const InterfaceType& type, const Scene& scene,
                     ReadingContext& context) {
    if (scene.geometry.tessellation || scene.geometry.reference_spacing > 0.0) return;
    if (section.has("normal_stiffness") || section.has("shear_stiffness")) return;
    context.fail(section, {},
                 fmt::format("expected normal_stiffness and shear_stiffness in Pa/m, or a geometry.tessellation or a "
                             "geometry.reference_spacing that gives the spacing, found none of them for {}",
                             type.name));
}

/// Which boundaries anything acts on. A platen may have another one against it, wherever that lies.
void mark_what_carries(const LoadProgram& loads, std::vector<BoundarySides>& boundaries) {
    const bool has_platen =
        std::ranges::any_of(loads.stages, [](const Stage& stage) { return stage.motion.has_value(); });
    for (std::size_t i = 0; i < boundaries.size(); ++i) {
        const bool is_held = i < loads.supports.size() && loads.supports[i] != Support::none;
        const bool is_pressed = std::ranges::any_of(
            loads.stages, [&](const Stage& stage) { return stage.pressure.contains(static_cast<int>(i)); });
        boundaries[i].carries = has_platen || is_held || is_pressed;
    }
}

Scene convert(const SceneSection& root, ReadingContext& context) {
    Scene scene;
    scene.title = root.given_text("title").value_or("");
    read_analysis(root, scene);
    read_integrator(root, scene, context);
    scene.materials = read_materials(root, context);
    scene.interface_types = read_interface_types(root, context);
    scene.geometry = read_geometry(root, names_of(scene.materials), names_of(scene.interface_types), context);
    scene.loads = read_loads(root, names_of(scene.geometry.boundaries), block_names(scene.geometry),
                             names_of(scene.interface_types), has_gravity(scene), context);
    mark_what_carries(scene.loads, scene.geometry.boundaries);
    refuse_explicit_reduction(root, scene, context);
    scene.cracks = read_crack_options(root.section("cracks"));
    check_accuracy(root.section("solver"), scene, context);
    scene.solver = read_solver_options(root.section("solver"));
    scene.output = read_output_options(root.section("output"));
    for (const auto& section : root.section("output").sections("histories"))
        scene.output.histories.push_back(read_history_request(section, scene.geometry, context));
    require_densities(root, scene, context);
    const std::set<int> refused = require_stiffness_of_joints(root, scene, context);
    const auto interfaces = root.sections("interfaces");
    for (const int type : used_interface_types(scene)) {
        const auto index = static_cast<std::size_t>(type);
        require_strength(interfaces[index], scene.interface_types[index], scene, context);
        if (!refused.contains(type)) require_spacing(interfaces[index], scene.interface_types[index], scene, context);
    }
    warn_of_net(root, scene, context);
    warn_of_implausible_values(root, scene, context);
    return scene;
}

} // namespace

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    return read_scene_text(read_scene_bytes(file), overrides, file);
}

Scene read_scene_text(std::string_view text, const std::vector<std::string>& overrides,
                      const std::filesystem::path& file) {
    SceneSources sources;
    SceneErrors errors(sources);
    SceneNode root = build_scene_tree(text, file, overrides, sources, errors);
    if (root.kind == SceneNode::Kind::nothing) errors.throw_if_any();
    refuse_decimal_commas(root, errors);
    check_against_schema(root, errors);
    ReadingContext context{errors};
    Scene scene = convert({&root, {}, {}}, context);
    errors.throw_if_any();
    scene.name = file.stem().string();
    scene.warnings = std::move(context.warnings);
    scene.places = key_places(root, sources);
    scene.text = write_scene_tree(root, sources);
    require_memory();
    return scene;
}

} // namespace kluft

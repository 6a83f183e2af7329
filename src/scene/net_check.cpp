#include "kluft/scene/net_check.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/constitutive/net_kind.hpp"
#include "kluft/core/units.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/scene/quantity.hpp"

namespace kluft {

namespace {

bool gives_stiffness(const SceneSection& interface) {
    return interface.has("normal_stiffness") || interface.has("normal_stiffness_times_spacing") ||
           interface.has("stiffness_ratio");
}

void require_stiffness(const SceneSection& interface, const std::string& why, ReadingContext& context) {
    context.fail(interface, "normal_stiffness",
                 fmt::format("expected a number > 0 in Pa/m (or a normal_stiffness_times_spacing or a stiffness_ratio) "
                             "because {}, and the stiffness of a joint does not follow from the net; found nothing",
                             why));
}

const Material& material(const Scene& scene, int index) { return scene.materials[static_cast<std::size_t>(index)]; }

/// k_n d of a net whose stiffness does not follow from a ratio (Pa).
double stiffness_times_spacing(const InterfaceType& type, const GeometrySpec& geometry) {
    if (type.normal_stiffness) return *type.normal_stiffness * lattice_spacing(geometry);
    return type.normal_stiffness_times_spacing.value_or(0.0);
}

/// What is wrong with a ratio; "" if nothing. Rigid blocks do not bend at all: their compliance is in the interfaces.
std::string ratio_problem(double ratio, const RatioRange& range, Kinematics kinematics) {
    if (!(ratio > 0.0)) return {};
    if (ratio < range.least) return "below it the joints carry most of the deformation";
    if (ratio <= range.most || kinematics == Kinematics::rigid) return {};
    return "above it affine blocks are too stiff in bending, and a body without strength noise fails everywhere at "
           "once";
}

void warn_of_ratio(const SceneSection& interface, std::string_view key, double ratio, const std::string& of,
                   const Scene& scene, ReadingContext& context) {
    const NetKind kind = net_kind(*scene.geometry.tessellation);
    const RatioRange range = good_stiffness_ratio(kind);
    const std::string problem = ratio_problem(ratio, range, scene.kinematics);
    if (!problem.empty())
        context.warn(interface, key,
                     fmt::format("k_n d/E is {:.3g}{}, outside the good range of a net of {}, {:g} to {:g}: {}", ratio,
                                 of, cells_of(kind), range.least, range.most, problem));
}

void warn_of_stiffness(const SceneSection& interface, const InterfaceType& type, const Scene& scene,
                       ReadingContext& context) {
    if (stiffness_from_ratio(type)) {
        const bool counts =
            scene.kinematics == Kinematics::affine; // rigid blocks give the rock's moduli with any ratio
        if (counts && type.stiffness_ratio)
            warn_of_ratio(interface, "stiffness_ratio", *type.stiffness_ratio, "", scene, context);
        return;
    }
    const auto* key = type.normal_stiffness ? "normal_stiffness" : "normal_stiffness_times_spacing";
    for (const int m : materials_of_body(scene)) {
        const Material& rock = material(scene, m);
        if (!(rock.youngs_modulus > 0.0)) continue;
        warn_of_ratio(interface, key, stiffness_times_spacing(type, scene.geometry) / rock.youngs_modulus,
                      " with the E of " + rock.name, scene, context);
    }
}

void warn_of_locking(const SceneSection& joint, double friction_angle, const Tessellation& net,
                     ReadingContext& context) {
    const NetKind kind = net_kind(net);
    if (!interlocks(kind) || friction_angle < locking_friction_angle) return;
    context.warn(
        joint, "friction_angle",
        fmt::format("{:.3g} deg lets the net lock: {} interlock, and where all their bonds have failed the loose "
                    "cells carry load as masonry does, from some {:.0f} deg on without bound; "
                    "geometry.tessellation.triangles keeps the strength of the rock",
                    friction_angle * degrees, cells_of(kind), locking_friction_angle * degrees));
}

/// Stresses in rigid blocks follow from the forces on them alone and scatter far more than those of affine ones.
void warn_of_rigid_triangles(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    if (scene.kinematics != Kinematics::rigid || net_kind(*scene.geometry.tessellation) != NetKind::triangles) return;
    context.warn(
        root.section("analysis"), "kinematics",
        "intact rock cut into rigid triangles fails at 72 to 81 % of its strength (docs/theory.md, section 5); take "
        "kinematics: affine for strength");
}

/// The units without which the number is meant in metres and makes cells that fit into the body: "cm or mm"; "" where there is none.
std::string smaller_units(const std::string& number, double spacing, double extent) {
    std::string units;
    for (const auto& [unit, size] : {std::pair("cm", 1e-2), std::pair("mm", 1e-3)})
        if (size * spacing < extent) units += fmt::format("{}'{} {}'", units.empty() ? "" : " or ", number, unit);
    return units;
}

/// Cells that are larger than the body leave it nearly uncut.
void warn_of_wide_cells(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    if (scene.geometry.domain.empty()) return;
    const Box box = bounding_box(scene.geometry.domain);
    const double extent = (box.upper - box.lower).minCoeff();
    const SceneSection net = root.section("geometry").section("tessellation");
    for (const auto* cells : {"triangles", "hexagons", "voronoi"}) {
        const SceneSection section = net.section(cells);
        const auto spacing = section.given_number("spacing");
        if (!spacing || *spacing <= extent) continue;
        const std::string& given = section.value("spacing")->text;
        const std::string units = read_number(given) ? smaller_units(given, *spacing, extent) : "";
        context.warn(
            section, "spacing",
            fmt::format("{:.4g} m is more than the smaller extent of the body, {:.4g} m: hardly an edge of the "
                        "net lies in it{}",
                        *spacing, extent, units.empty() ? "" : "; is its unit missing, as in " + units + "?"));
    }
}

/// A ratio refers to the largest E of the body: beside a stiff part the cells of a soft one do not bend.
std::vector<std::string> softer_materials(const Scene& scene, const BlockSystem& system, const InterfaceType& type) {
    const NetKind kind = net_kind(*scene.geometry.tessellation);
    const RatioRange range = good_stiffness_ratio(kind);
    if (!stiffness_from_ratio(type) || scene.kinematics == Kinematics::rigid) return {};
    const double ratio = type.stiffness_ratio.value_or(default_stiffness_ratio(kind));
    int stiffest = system.blocks.front().material;
    std::set<int> of_cells;
    for (const Block& block : system.blocks) {
        if (material(scene, block.material).youngs_modulus > material(scene, stiffest).youngs_modulus)
            stiffest = block.material;
        if (is_cell_of_net(system, block)) of_cells.insert(block.material);
    }
    std::vector<std::string> warnings;
    for (const int m : of_cells) {
        const Material& rock = material(scene, m);
        const double own = ratio * material(scene, stiffest).youngs_modulus / rock.youngs_modulus;
        if (rock.youngs_modulus == material(scene, stiffest).youngs_modulus || own <= range.most) continue;
        warnings.push_back(fmt::format("interfaces.{}: k_n d/E is {:.3g} with the E of {}, since the stiffness follows "
                                       "from that of {}, outside the "
                                       "good range of a net of {}, {:g} to {:g}: {}",
                                       type.name, own, rock.name, material(scene, stiffest).name, cells_of(kind),
                                       range.least, range.most, ratio_problem(own, range, scene.kinematics)));
    }
    return warnings;
}

/// What lies outside the region of a net is of few blocks, each with one strain or none.
std::vector<std::string> rock_outside_net(const Scene& scene, const BlockSystem& system, const InterfaceType& type) {
    constexpr double much_area = 0.05; // of the body
    if (!scene.geometry.tessellation->region) return {};
    const auto is_cell = [&](const Block& block) { return is_cell_of_net(system, block); };
    if (std::ranges::none_of(system.blocks, is_cell)) return {}; // there is another warning of that
    double outside = 0.0;
    for (const Block& block : system.blocks) outside += is_cell(block) ? 0.0 : block.area;
    if (outside <= much_area * area_of(system)) return {};
    std::string blocks = "which are rigid";
    if (scene.kinematics == Kinematics::affine)
        blocks = stiffness_from_ratio(type)
                     ? "each with one uniform strain and the moduli of the net's cells, some per cent above the rock's"
                     : "each with one uniform strain";
    return {fmt::format(
        "{}: {:.3g} % of the body lie outside the net, in single blocks, {}: they hardly give way to what happens "
        "inside, as to an opening (closures of a tunnel came out too small by 13 % with a net to 5 radii "
        "around it, by 24 % to 3 and by 38 % to 2); {}",
        scene.geometry.places.region, 100.0 * outside / area_of(system), blocks,
        net_kind(*scene.geometry.tessellation) == NetKind::triangles
            ? "geometry.tessellation.triangles.grading makes the net coarser away from what matters in "
              "place of ending it"
            : "a net of triangles may be graded in place of ending")};
}

} // namespace

std::set<int> materials_of_body(const Scene& scene) {
    std::set<int> materials; // `geometry.material` is that of a body that is cut
    if (scene.geometry.blocks.empty()) materials.insert(scene.geometry.material);
    for (const MaterialRegion& region : scene.geometry.regions) materials.insert(region.material);
    for (const GivenBlock& block : scene.geometry.blocks) materials.insert(block.material);
    std::erase_if(materials, [&](int m) { return m < 0 || m >= static_cast<int>(scene.materials.size()); });
    return materials;
}

std::set<int> require_stiffness_of_joints(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const auto interfaces = root.sections("interfaces");
    std::set<int> refused;
    const auto require = [&](int type, const std::string& why) {
        const bool lacks = type >= 0 && !gives_stiffness(interfaces[static_cast<std::size_t>(type)]);
        if (lacks && refused.insert(type).second)
            require_stiffness(interfaces[static_cast<std::size_t>(type)], why, context);
    };
    for (const FractureTrace& fracture : scene.geometry.fractures) {
        if (fracture.interface_type < 0) continue;
        require(fracture.interface_type,
                fmt::format("the mapped fracture {} has this interface", in_quotes(fracture.name)));
        require(scene.interface_types[static_cast<std::size_t>(fracture.interface_type)].fails_to,
                fmt::format("the mapped fracture {} fails to it", in_quotes(fracture.name)));
    }
    return refused;
}

std::vector<std::string> warnings_of_cut_net(const Scene& scene, const BlockSystem& system) {
    if (!scene.geometry.tessellation) return {};
    const InterfaceType& type =
        scene.interface_types[static_cast<std::size_t>(scene.geometry.tessellation->interface_type)];
    std::vector<std::string> warnings = softer_materials(scene, system, type);
    const std::vector<std::string> outside = rock_outside_net(scene, system, type);
    warnings.insert(warnings.end(), outside.begin(), outside.end());
    return warnings;
}

void warn_of_net(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    if (!scene.geometry.tessellation || scene.geometry.tessellation->interface_type < 0) return;
    const Tessellation& net = *scene.geometry.tessellation;
    warn_of_wide_cells(root, scene, context);
    const auto interfaces = root.sections("interfaces");
    const auto index = static_cast<std::size_t>(net.interface_type);
    const InterfaceType& type = scene.interface_types[index];
    warn_of_stiffness(interfaces[index], type, scene, context);
    if (type.kind != InterfaceKind::potential_crack || type.fails_to < 0) return;
    warn_of_rigid_triangles(root, scene, context);
    const auto joint = static_cast<std::size_t>(type.fails_to);
    warn_of_locking(interfaces[joint], scene.interface_types[joint].friction_angle, net, context);
}

} // namespace kluft

#include "kluft/scene/plausibility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/core/units.hpp"

namespace kluft {

namespace {

/// A stress whose unit was forgotten, where the key is given. `unit`: the one that such stresses are given in.
void warn_of_lost_unit(const SceneSection& section, std::string_view key, double stress, ReadingContext& context,
                       std::string_view unit = "MPa") {
    constexpr double next_to_nothing = 100.0; // Pa; a centimetre of water
    const double size = std::abs(stress);
    if (size > 0.0 && size < next_to_nothing && section.has(key))
        context.warn(
            section, key,
            fmt::format("{:.4g} Pa is next to nothing; is its unit missing, as in {:.4g} {}?", stress, stress, unit));
}

/// An angle in radians without its unit.
void warn_of_small_friction(const SceneSection& section, double friction_angle, ReadingContext& context) {
    constexpr double slippery = 2.0; // degrees; wet ice has some 3, wet clay 5
    const double angle = friction_angle * degrees;
    if (angle > 0.0 && angle < slippery && section.has("friction_angle"))
        context.warn(section, "friction_angle",
                     fmt::format("{:.3g} degrees is less friction than that of any rock; is its unit missing, as in "
                                 "'{:.3g} rad'?",
                                 angle, angle));
}

void warn_of_strength(const SceneSection& section, const Strength& strength, ReadingContext& context,
                      std::string_view unit_of_cohesion = "MPa") {
    warn_of_lost_unit(section, "cohesion", strength.cohesion, context, unit_of_cohesion);
    warn_of_lost_unit(section, "tensile_strength", strength.tensile_strength, context);
    warn_of_small_friction(section, strength.friction_angle, context);
}

void warn_of_material(const SceneSection& section, const Material& material, ReadingContext& context) {
    constexpr double softest = 1e6;     // Pa; soft clay has some MPa
    constexpr double diamond = 1.2e12;  // Pa
    constexpr double lightest = 100.0;  // kg/m3; pumice has some hundreds
    constexpr double heaviest = 2.26e4; // kg/m3; osmium
    const double modulus = material.youngs_modulus;
    if (modulus > 0.0 && modulus < softest)
        context.warn(section, "youngs_modulus",
                     fmt::format("{:.4g} Pa is softer than any rock or soil; is its unit missing, as in {:.4g} GPa?",
                                 modulus, modulus));
    if (modulus > diamond)
        context.warn(section, "youngs_modulus", fmt::format("{:.4g} Pa is stiffer than diamond", modulus));
    const double density = material.density;
    if (density > 0.0 && (density < lightest || density > heaviest))
        context.warn(section, "density",
                     fmt::format("{:.4g} kg/m3 is the density of no rock, which is some 1500 to 5000 kg/m3", density));
}

/// Round-off of the bulk stiffness, E/(3 (1 - 2 nu)), against stresses of less than 1 MPa.
void warn_of_incompressible_blocks(const SceneSection& section, const Material& material, ReadingContext& context) {
    constexpr double beyond_round_off = 0.4999999; // at which nothing is lost yet (80 GPa under a metre of rock)
    if (material.poissons_ratio > beyond_round_off)
        context.warn(
            section, "poissons_ratio",
            fmt::format("{:.12g} is so near to 0.5 that round-off of the blocks' stiffness against compression "
                        "is seen in their stresses, and factors of safety may be per cents off; 0.4999 "
                        "stands for the same rock without that",
                        material.poissons_ratio));
}

void warn_of_joint(const SceneSection& section, const InterfaceType& type, ReadingContext& context) {
    constexpr double steel = 2.1e11 / 1e-3; // Pa/m: Young's modulus over a thickness of 1 mm
    constexpr double softest = 1e5;         // Pa/m: a metre of soft clay has 1e6
    for (const auto& [key, stiffness] :
         {std::pair("normal_stiffness", type.normal_stiffness), std::pair("shear_stiffness", type.shear_stiffness)})
        if (stiffness && *stiffness < softest)
            context.warn(section, key,
                         fmt::format("{:.4g} Pa/m is softer than any joint; is its unit missing, as in {:.4g} GPa/m?",
                                     *stiffness, *stiffness));
    const bool slides = type.kind == InterfaceKind::fracture;
    if (slides && !section.has("friction_angle") && !section.has("cohesion"))
        context.warn(section, "kind",
                     "a fracture without friction_angle and cohesion slides without resistance; friction_angle: 0 says "
                     "that this is meant");
    const bool in_kilopascals = slides && type.cohesion >= 1.0; // joints have some kPa, and hardly as many MPa
    warn_of_strength(section,
                     type.strength.value_or(Strength{.cohesion = type.cohesion, .friction_angle = type.friction_angle}),
                     context, in_kilopascals ? "kPa" : "MPa");
    if (type.normal_stiffness.value_or(0.0) > steel)
        context.warn(section, "normal_stiffness",
                     fmt::format("{:.3g} Pa/m is stiffer than a millimetre of steel, {:.2g} Pa/m; stiffer joints take "
                                 "more iterations and change no strength",
                                 *type.normal_stiffness, steel));
}

/// A tensile strength that decides nothing, or all at once. `bonds_fail_by_stress`: by principal stresses.
void warn_of_tensile_strength(const SceneSection& section, const Strength& strength, bool in_net,
                              bool bonds_fail_by_stress, ReadingContext& context) {
    constexpr double little = 1e-3; // of the cohesion
    const double tensile = strength.tensile_strength;
    if (in_net && tensile <= little * strength.cohesion)
        context.warn(
            section, "tensile_strength",
            fmt::format("{:.3g} Pa lets the net's bonds fail as soon as the body is loaded, since the stresses in "
                        "it are not uniform and pull a little somewhere; a hundredth of the cohesion leaves "
                        "that to loads that matter",
                        tensile));
    const double in_shear = uniaxial_tension_in_shear(strength);
    if (bonds_fail_by_stress && tensile > in_shear)
        context.warn(section, "tensile_strength",
                     fmt::format("{:.4g} MPa is never reached where a body is pulled one way: by principal stresses it "
                                 "fails in shear at 2 c cos(phi)/(1 + sin(phi)), {:.4g} MPa, before",
                                 1e-6 * tensile, 1e-6 * in_shear));
}

void warn_of_tensile_strengths(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const auto has_bonds = [](const InterfaceType& type) { return type.kind == InterfaceKind::potential_crack; };
    if (std::ranges::none_of(scene.interface_types, has_bonds)) return;
    const auto& net = scene.geometry.tessellation; // whose interface is -1 where it is none of the scene
    const bool in_net = net && net->interface_type >= 0 && has_bonds(scene.interface_types[net->interface_type]);
    const bool by_stress = scene.cracks.criterion == CrackCriterion::principal_stress;
    const auto materials = root.sections("materials");
    for (std::size_t m = 0; m < std::min(materials.size(), scene.materials.size()); ++m)
        if (scene.materials[m].strength && materials[m].has("tensile_strength"))
            warn_of_tensile_strength(materials[m], *scene.materials[m].strength, in_net, by_stress, context);
}

/// A smooth platen takes the place of a support that holds the boundary along itself.
void warn_of_support_under_platen(const SceneSection& root, const Scene& scene, std::size_t s,
                                  const std::vector<std::string>& names, ReadingContext& context) {
    const Stage& stage = scene.loads.stages[s];
    const auto moved = static_cast<std::size_t>(stage.motion->boundary);
    const bool holds = stage.motion->glued || stage.platen_friction > 0.0;
    if (holds || scene.loads.supports[moved] != Support::fixed) return;
    for (const SceneSection& boundary : root.sections("boundaries"))
        if (boundary.path() == "boundaries." + names[moved])
            context.warn(
                boundary, "support",
                fmt::format("has no effect in stages.{}, where a smooth platen moves '{}'; platens: rough there "
                            "holds it sideways",
                            s, names[moved]));
}

void warn_of_loads(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    constexpr double large_strain = 0.2; // rock breaks at some hundredths
    const std::vector<std::string> names = names_of(scene.geometry.boundaries);
    const auto stages = root.sections("stages");
    for (std::size_t s = 0; s < std::min(stages.size(), scene.loads.stages.size()); ++s) {
        const Stage& stage = scene.loads.stages[s];
        for (const auto& [boundary, pressure] : stage.pressure) {
            const SceneSection section = stages[s].section("pressure");
            const std::string& name = names[static_cast<std::size_t>(boundary)];
            warn_of_lost_unit(section, name, pressure, context);
            if (pressure < 0.0 && section.has(name))
                context.warn(section, name,
                             fmt::format("{:.4g} Pa pulls: pressures are positive where they push", pressure));
        }
        if (!stage.motion) continue;
        warn_of_support_under_platen(root, scene, s, names, context);
        const double value = stage.motion->value;
        if (stage.motion->control == PlatenControl::stress)
            warn_of_lost_unit(stages[s].section("stress"), "value", value, context);
        if (stage.motion->control == PlatenControl::strain && std::abs(value) > large_strain)
            context.warn(stages[s].section("strain"), "value",
                         fmt::format("{:.3g} is {:.3g} % of the body's length; is the % missing, as in '{:.3g} %'?",
                                     value, 100.0 * value, value));
    }
}

/// The side of a rectangle across from one; "" of another name.
std::string_view opposite(std::string_view side) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 4> sides{
        {{"left", "right"}, {"right", "left"}, {"top", "bottom"}, {"bottom", "top"}}};
    const auto* const found = std::ranges::find(sides, side, &std::pair<std::string_view, std::string_view>::first);
    return found == sides.end() ? std::string_view{} : found->second;
}

/// Something that takes forces along itself, and so a push from any side: a fixed boundary or rough or glued platens.
bool is_held_sideways(const Scene& scene) {
    const auto& [supports, forces, stages] = scene.loads;
    return !forces.empty() || std::ranges::find(supports, Support::fixed) != supports.end() ||
           std::ranges::any_of(stages, [](const Stage& stage) {
               return stage.platen_friction > 0.0 || (stage.motion && stage.motion->glued);
           });
}

void warn_of_one_sided_pressure(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    if (!root.section("geometry").section("domain").has("rectangle") || is_held_sideways(scene)) return;
    const std::vector<std::string> names = names_of(scene.geometry.boundaries);
    const auto stages = root.sections("stages");
    std::set<std::string_view> standing; // sides that press or are held
    const auto is_supported = [&](int boundary) {
        return scene.loads.supports[static_cast<std::size_t>(boundary)] != Support::none;
    };
    for (std::size_t b = 0; b < std::min(names.size(), scene.loads.supports.size()); ++b)
        if (scene.loads.supports[b] != Support::none) standing.insert(names[b]);
    for (std::size_t s = 0; s < std::min(stages.size(), scene.loads.stages.size()); ++s) {
        const Stage& stage = scene.loads.stages[s];
        if (stage.motion) standing.insert(names[static_cast<std::size_t>(stage.motion->boundary)]);
        for (const auto& [boundary, pressure] : stage.pressure)
            if (pressure > 0.0) standing.insert(names[static_cast<std::size_t>(boundary)]);
        for (const auto& [boundary, pressure] : stage.pressure) {
            const std::string& name = names[static_cast<std::size_t>(boundary)];
            const std::string_view across = opposite(name);
            if (!(pressure > 0.0) || is_supported(boundary) || across.empty() || standing.contains(across)) continue;
            context.warn(stages[s].section("pressure"), name,
                         fmt::format("nothing stands against it: {} has neither a pressure nor a support, and no "
                                     "boundary is fixed, so the body is pushed away",
                                     across));
        }
    }
}

/// What is not found counts as not there when strengths are reduced.
void warn_of_symmetric_reduction(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const bool reduces = std::ranges::any_of(scene.loads.stages,
                                             [](const Stage& stage) { return stage.strength_reduction.has_value(); });
    if (reduces && scene.solver.tangent == Tangent::symmetric)
        context.warn(
            root.section("solver"), "tangent",
            "with symmetric the search may miss equilibria near the limit, so that the factor of safety is too small; "
            "unsymmetric finds them");
}

/// A body without weight stands by what joints carry of its other loads alone.
void warn_of_missing_weight(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const bool reduces = std::ranges::any_of(scene.loads.stages,
                                             [](const Stage& stage) { return stage.strength_reduction.has_value(); });
    const bool in_a_stage =
        std::ranges::any_of(scene.loads.stages, [](const Stage& stage) { return stage.gravity.has_value(); });
    const SceneSection analysis = root.section("analysis");
    if (!reduces || in_a_stage || analysis.has("gravity")) return;
    const auto materials = root.sections("materials");
    for (const SceneSection& material : materials) {
        if (!material.has("density")) continue;
        context.warn(material, "density",
                     "the body has no weight, for there is no `analysis.gravity`, and a factor of safety is that of "
                     "its other loads alone; gravity: 0 says so");
        return;
    }
}

/// What is left over on a block is missing in what holds it: a block on a plane of 20 degrees stands with a share of 0.02 where its
/// factor of safety is 1 - 0.02/sin(20 deg) = 0.94.
void warn_of_loose_balance(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    constexpr double loose = 0.01;
    const double balance = scene.solver.balance;
    if (balance > loose)
        context.warn(
            root.section("solver"), "balance",
            fmt::format("blocks count as balanced with {:.3g} % of their own load left over, so that blocks that "
                        "fall may count as standing; the default is {}",
                        100.0 * balance, scene_schema().find("solver.balance")->fallback));
}

/// The strength of a material is that of the potential cracks in it that have none of their own. Interfaces that are not in the body
/// count: a file with all variants of a body says what each of them needs.
void warn_of_idle_strengths(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const auto is_crack = [](const InterfaceType& type) { return type.kind == InterfaceKind::potential_crack; };
    const auto takes_from_rock = [&](const InterfaceType& type) { return is_crack(type) && !type.strength; };
    if (std::ranges::any_of(scene.interface_types, takes_from_rock)) return;
    const std::string why =
        std::ranges::any_of(scene.interface_types, is_crack)
            ? "each potential crack has a strength of its own"
            : "no interface is a potential crack, so that the blocks never break and only joints fail; a "
              "`geometry.tessellation` with an interface of kind potential_crack lets rock break";
    const auto materials = root.sections("materials");
    for (std::size_t m = 0; m < std::min(materials.size(), scene.materials.size()); ++m)
        if (scene.materials[m].strength)
            context.warn(materials[m], "cohesion",
                         fmt::format("has no effect, nor have friction_angle and tensile_strength: {}", why));
}

/// A load step is cut where the largest failure index lies between 1 and 1 + event_tolerance.
void warn_of_loose_events(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    constexpr double loose = 0.02;
    const double tolerance = scene.cracks.event_tolerance;
    const bool cuts_by_it = scene.integrator == Integrator::implicit && scene.cracks.update == CrackUpdate::event &&
                            !(scene.solver.accuracy > 0.0);
    if (!cuts_by_it || tolerance <= loose) return;
    context.warn(
        root.section("cracks"), "event_tolerance",
        fmt::format("potential cracks fail at up to {:.3g} times their strength, and with them those that have not "
                    "reached theirs by as much: strengths of the body come out too large by up to twice that; the "
                    "default is {}",
                    1.0 + tolerance, scene_schema().find("cracks.event_tolerance")->fallback));
}

/// What something else in the scene makes meaningless.
void warn_of_keys_without_effect(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const auto warn = [&](const SceneSection& section, std::string_view key, std::string_view why) {
        if (section.has(key)) context.warn(section, key, fmt::format("has no effect: {}", why));
    };
    if (scene.geometry.blocks.empty())
        warn(root.section("geometry"), "blocks_interface",
             "it is that of given blocks; the interfaces of a domain stand in fractures and tessellation");
    const bool has_size = scene.geometry.tessellation || scene.geometry.reference_spacing > 0.0;
    if (!has_size && scene.geometry.blocks.empty())
        warn(root.section("geometry"), "minimum_area",
             "it is a fraction of a cell, and there is neither a tessellation nor a `reference_spacing` (about the "
             "size of "
             "the blocks, in m)");
    if (scene.cracks.strength_noise.deviation == 0.0)
        warn(root.section("cracks"), "strength_seed", "without cracks.strength_noise the strengths do not scatter");
}

} // namespace

void warn_of_implausible_values(const SceneSection& root, const Scene& scene, ReadingContext& context) {
    const auto materials = root.sections("materials");
    for (std::size_t m = 0; m < std::min(materials.size(), scene.materials.size()); ++m) {
        warn_of_material(materials[m], scene.materials[m], context);
        if (scene.plane == Plane::strain && scene.kinematics == Kinematics::affine)
            warn_of_incompressible_blocks(materials[m], scene.materials[m], context);
        warn_of_strength(materials[m], scene.materials[m].strength.value_or(Strength{}), context);
    }
    const auto interfaces = root.sections("interfaces");
    for (std::size_t i = 0; i < std::min(interfaces.size(), scene.interface_types.size()); ++i)
        warn_of_joint(interfaces[i], scene.interface_types[i], context);
    warn_of_tensile_strengths(root, scene, context);
    warn_of_idle_strengths(root, scene, context);
    warn_of_loads(root, scene, context);
    warn_of_one_sided_pressure(root, scene, context);
    warn_of_symmetric_reduction(root, scene, context);
    warn_of_missing_weight(root, scene, context);
    warn_of_loose_balance(root, scene, context);
    warn_of_loose_events(root, scene, context);
    warn_of_keys_without_effect(root, scene, context);
}

} // namespace kluft

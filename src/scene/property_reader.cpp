#include "kluft/scene/property_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "kluft/core/units.hpp"
#include "kluft/scene/scene_check.hpp"

namespace kluft {

namespace {

using KeyPair = std::array<std::string_view, 2>;
constexpr std::array<KeyPair, 3> stiffness_keys{{{"normal_stiffness", "shear_stiffness"},
                                                 {"normal_stiffness_times_spacing", "shear_stiffness_times_spacing"},
                                                 {"stiffness_ratio", "shear_ratio"}}};

/// Cohesion, friction angle and tensile strength: all three or none.
std::optional<Strength> read_strength(const SceneSection& section, ReadingContext& context) {
    constexpr std::array<std::string_view, 3> keys{"cohesion", "friction_angle", "tensile_strength"};
    if (std::none_of(keys.begin(), keys.end(), [&](auto key) { return section.has(key); })) return std::nullopt;
    for (const auto key : keys)
        if (!section.has(key))
            context.fail(
                section, key,
                "expected cohesion, friction_angle and tensile_strength together or none of them, found nothing");
    Strength strength{section.number("cohesion"), section.number("friction_angle"), section.number("tensile_strength")};
    if (strength.friction_angle > 0.0) {
        const double apex = strength.cohesion / std::tan(strength.friction_angle);
        if (strength.tensile_strength > apex)
            context.warn(section, "tensile_strength",
                         fmt::format("{:.6g} Pa is above cohesion cot(friction_angle), taken as {:.6g} Pa",
                                     strength.tensile_strength, apex));
        strength.tensile_strength = std::min(strength.tensile_strength, apex);
    }
    return strength;
}

void check_stiffness_keys(const SceneSection& section, ReadingContext& context) {
    std::optional<std::string_view> first;
    for (const auto& [normal, shear] : stiffness_keys) {
        if (!section.has(normal) && !section.has(shear)) continue;
        const std::string_view given = section.has(normal) ? normal : shear;
        if (first) {
            context.fail(section, given,
                         fmt::format("expected one way to give the stiffness, found {} beside {}", given, *first));
            continue;
        }
        first = given;
        if (normal == "stiffness_ratio") continue;
        for (const auto key : {normal, shear})
            if (!section.has(key))
                context.fail(section, key, fmt::format("expected a value because {} is given, found nothing", given));
    }
}

void read_stiffness(const SceneSection& section, ReadingContext& context, InterfaceType& type) {
    type.normal_stiffness = section.given_number("normal_stiffness");
    type.shear_stiffness = section.given_number("shear_stiffness");
    type.normal_stiffness_times_spacing = section.given_number("normal_stiffness_times_spacing");
    type.shear_stiffness_times_spacing = section.given_number("shear_stiffness_times_spacing");
    type.stiffness_ratio = section.given_number("stiffness_ratio");
    type.shear_ratio = section.given_number("shear_ratio");
    check_stiffness_keys(section, context);
}

void read_fracture(const SceneSection& section, ReadingContext& context, InterfaceType& type) {
    type.friction_angle = section.number("friction_angle");
    type.cohesion = section.number("cohesion");
    if (section.number("tensile_strength") > 0.0)
        context.fail(section, "tensile_strength",
                     fmt::format("expected 0 or nothing for a fracture, which carries no tension, found {}",
                                 found_text(*section.value("tensile_strength"))));
    if (section.has("fails_to"))
        context.fail(section, "fails_to",
                     fmt::format("expected nothing for a fracture, which has failed already, found {}",
                                 found_text(*section.value("fails_to"))));
    if (type.dilation_angle > type.friction_angle)
        context.fail(section, "dilation_angle",
                     fmt::format("expected at most the friction angle ({:.6g} deg), found {}",
                                 type.friction_angle * degrees, found_text(*section.value("dilation_angle"))));
}

void read_potential_crack(const SceneSection& section, ReadingContext& context, InterfaceType& type) {
    type.strength = read_strength(section, context);
    for (const auto* key :
         {"dilation_angle", "cohesion_onset", "contact_rounding", "friction_rounding", "overlap_points"})
        if (section.has(key))
            context.warn(section, key, "no effect on a potential crack; the fracture that it fails to has its own");
}

std::optional<InterfaceKind> kind_of(const SceneSection& section) {
    const auto text = section.given_text("kind");
    if (!text) return std::nullopt;
    return *text == "fracture" ? InterfaceKind::fracture : InterfaceKind::potential_crack;
}

InterfaceType read_interface_type(const SceneSection& section, ReadingContext& context) {
    InterfaceType type;
    type.name = section.name();
    read_stiffness(section, context, type);
    type.dilation_angle = section.number("dilation_angle");
    type.cohesion_onset = section.given_number("cohesion_onset");
    type.contact_rounding = section.given_number("contact_rounding");
    type.friction_rounding = section.number("friction_rounding");
    if (section.has("overlap_points")) type.overlap_points = section.count("overlap_points");
    const auto kind = kind_of(section);
    if (!kind) return type;
    type.kind = *kind;
    if (*kind == InterfaceKind::fracture)
        read_fracture(section, context, type);
    else
        read_potential_crack(section, context, type);
    return type;
}

/// Index of the interface that a potential crack fails to: the named fracture, or the only one.
int successor(const SceneSection& section, const std::vector<SceneSection>& sections, ReadingContext& context) {
    std::vector<std::string> fractures;
    std::vector<int> indices;
    for (std::size_t i = 0; i < sections.size(); ++i) {
        if (kind_of(sections[i]) != InterfaceKind::fracture) continue;
        fractures.push_back(sections[i].name());
        indices.push_back(static_cast<int>(i));
    }
    const auto choice = context.reference(section, "fails_to", fractures, "an interface of kind fracture");
    return choice ? indices[static_cast<std::size_t>(*choice)] : -1;
}

} // namespace

std::vector<Material> read_materials(const SceneSection& root, ReadingContext& context) {
    std::vector<Material> materials;
    for (const auto& section : root.sections("materials")) {
        Material material;
        material.name = section.name();
        material.density = section.number("density");
        material.youngs_modulus = section.number("youngs_modulus");
        material.poissons_ratio = section.number("poissons_ratio");
        material.strength = read_strength(section, context);
        materials.push_back(std::move(material));
    }
    return materials;
}

std::vector<InterfaceType> read_interface_types(const SceneSection& root, ReadingContext& context) {
    const auto sections = root.sections("interfaces");
    std::vector<InterfaceType> types;
    for (const auto& section : sections) {
        types.push_back(read_interface_type(section, context));
        if (kind_of(section) == InterfaceKind::potential_crack)
            types.back().fails_to = successor(section, sections, context);
    }
    return types;
}

} // namespace kluft

#include "kluft/simulation/model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/core/diagnostics.hpp"

namespace kluft {

namespace {

/// Parts of the largest stress on the boundary and of the cohesion that the law is rounded over by default.
constexpr double default_contact_rounding = 1e-3;
constexpr double default_cohesion_onset = 0.01;

double largest_boundary_stress(const BlockSystem& system, const ModelInput& input) {
    double largest = 0.0;
    for (const Stage& stage : input.loads.stages) {
        for (const auto& [boundary, pressure] : stage.pressure) largest = std::max(largest, std::abs(pressure));
        if (stage.motion && stage.motion->control == PlatenControl::stress) {
            largest = std::max(largest, std::abs(stage.motion->value));
        }
    }
    for (const Material& material : input.materials) {
        const Vec2 extent = system.upper - system.lower;
        largest = std::max(largest, material.density * extent.cwiseAbs().dot(input.gravity.cwiseAbs()));
    }
    return largest;
}

InterfaceLaw resolve_law(const InterfaceType& type, const InterfaceStiffness& stiffness, double boundary_stress) {
    InterfaceLaw law;
    law.normal_stiffness = stiffness.normal;
    law.shear_stiffness = stiffness.shear;
    if (type.kind == InterfaceKind::potential_crack && type.fails_to >= 0) return law; // its fracture law is another's
    law.tan_friction = std::tan(type.friction_angle);
    law.cohesion = type.cohesion;
    law.tan_dilation = std::tan(type.dilation_angle);
    law.cohesion_onset = type.cohesion_onset.value_or(default_cohesion_onset * type.cohesion);
    law.contact_rounding = type.contact_rounding.value_or(default_contact_rounding * boundary_stress);
    law.friction_rounding = type.friction_rounding;
    return law;
}

/// FNV-1a (Fowler, Noll and Vo) over the bytes of plain values.
class Digest {
public:
    template <typename... Values> void add(Values... values) { (add_one(values), ...); }
    [[nodiscard]] std::string text() const { return fmt::format("{:016x}", value_); }

private:
    template <typename Value> void add_one(Value value) {
        static_assert(std::is_arithmetic_v<Value>);
        unsigned char bytes[sizeof(Value)];
        std::memcpy(bytes, &value, sizeof(Value));
        for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 1099511628211ULL;
    }
    std::uint64_t value_ = 14695981039346656037ULL;
};

Strength strength_of(const Interface& interface, const BlockSystem& system, const ModelInput& input) {
    const InterfaceType& type = input.interface_types[interface.interface_type];
    if (type.strength) return *type.strength;
    const Material& a = input.materials[system.blocks[interface.block_a].material];
    const Material& b = input.materials[system.blocks[interface.block_b].material];
    for (const Material* material : {&a, &b}) {
        if (!material->strength) {
            throw InputError("materials." + material->name +
                             ": expected cohesion, friction_angle and tensile_strength, because the potential crack '" +
                             type.name + "' has no strength of its own; found none");
        }
    }
    return weaker(*a.strength, *b.strength);
}

} // namespace

Model build_model(BlockSystem system, const ModelInput& input) {
    Model model;
    model.plane = input.plane;
    model.gravity = input.gravity;
    model.loads = input.loads;
    model.loads.supports.resize(system.boundaries.size(), Support::none);

    double stiffest_rock = 0.0;
    for (const Material& material : input.materials) stiffest_rock = std::max(stiffest_rock, material.youngs_modulus);
    const double boundary_stress = largest_boundary_stress(system, input);
    std::vector<InterfaceStiffness> stiffnesses;
    for (int t = 0; t < static_cast<int>(input.interface_types.size()); ++t) {
        const InterfaceType& type = input.interface_types[t];
        stiffnesses.push_back(resolve_stiffness(type, system.spacing, stiffest_rock));
        model.laws.push_back(resolve_law(type, stiffnesses.back(), boundary_stress));
        model.bonds.push_back(type.kind == InterfaceKind::potential_crack ? 1 : 0);
        model.fracture_law.push_back(type.fails_to >= 0 ? type.fails_to : t);
    }

    for (const Material& material : input.materials) {
        model.densities.push_back(material.density);
        auto moduli = plane_moduli(material.youngs_modulus, material.poissons_ratio, input.plane);
        if (input.tessellation_type >= 0) {
            const InterfaceType& type = input.interface_types[input.tessellation_type];
            if (stiffness_from_ratio(type)) {
                moduli = block_moduli(material.youngs_modulus, material.poissons_ratio, input.plane,
                                      type.stiffness_ratio.value_or(default_stiffness_ratio),
                                      type.shear_ratio.value_or(default_shear_ratio));
            }
        }
        const auto effective =
            input.tessellation_type >= 0
                ? lattice_moduli(moduli, stiffnesses[input.tessellation_type], system.spacing, input.plane)
                : engineering_moduli(moduli, input.plane);
        model.effective_modulus = std::max(model.effective_modulus, effective.youngs_modulus);
        model.moduli.push_back(moduli);
    }

    model.strengths.resize(system.interfaces.size());
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (!model.bonds[system.interfaces[i].interface_type]) continue;
        const auto [strength, was_capped] = capped(strength_of(system.interfaces[i], system, input));
        model.strengths[i] = strength;
        if (was_capped && model.warnings.empty()) {
            model.warnings.push_back(
                "the tensile strength of a potential crack is larger than c cot(phi) and was capped");
        }
        model.has_potential_cracks = true;
    }
    model.system = std::move(system);
    return model;
}

std::string fingerprint(const Model& model) {
    Digest digest;
    digest.add(model.gravity.x(), model.gravity.y());
    for (const Vec2& vertex : model.system.vertices) digest.add(vertex.x(), vertex.y());
    for (const Interface& i : model.system.interfaces)
        digest.add(i.block_a, i.edge_a, i.block_b, i.edge_b, i.interface_type);
    for (const ElasticModuli& moduli : model.moduli) digest.add(moduli.lambda, moduli.mu);
    for (const double density : model.densities) digest.add(density);
    for (const InterfaceLaw& law : model.laws) {
        digest.add(law.normal_stiffness, law.shear_stiffness, law.tan_friction, law.cohesion, law.tan_dilation,
                   law.cohesion_onset, law.contact_rounding, law.friction_rounding);
    }
    for (const Strength& strength : model.strengths) {
        digest.add(strength.cohesion, strength.friction_angle, strength.tensile_strength);
    }
    for (const Stage& stage : model.loads.stages) {
        digest.add(stage.steps, static_cast<int>(stage.platens));
        for (const auto& [boundary, pressure] : stage.pressure) digest.add(boundary, pressure);
        if (stage.motion) {
            digest.add(static_cast<int>(stage.motion->control), stage.motion->boundary, stage.motion->value);
        }
        if (stage.strength_reduction) {
            const StrengthReduction& reduction = *stage.strength_reduction;
            digest.add(reduction.from, reduction.to, reduction.tolerance);
            for (const int type : reduction.interface_types) digest.add(type);
        }
    }
    return digest.text();
}

} // namespace kluft

#include "kluft/simulation/model.hpp"

#include <algorithm>
#include <cmath>

#include <set>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/contact/overlap_rule.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/material_point.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

namespace {

/// Parts of the largest stress on the boundary and of the cohesion that the law is rounded over by default.
constexpr double default_contact_rounding = 1e-3;
constexpr double default_cohesion_onset = 0.01;
constexpr double uneven = 0.01; ///< sides of a platen's boundary lie apart, of the body's length

/// Of the rock whose weight contacts feel: of a body that is cut its box, of given blocks, which may be of very different
/// sizes, the smallest block that is free (m).
Vec2 height_of_weights(const BlockSystem& system) {
    const bool given = system.outline_type >= 0;
    if (!given) return system.upper - system.lower;
    double smallest = (system.upper - system.lower).maxCoeff();
    for (const Block& block : system.blocks)
        if (!block.fixed) smallest = std::min(smallest, std::sqrt(block.area));
    return Vec2::Constant(smallest);
}

double largest_boundary_stress(const BlockSystem& system, const ModelInput& input,
                               const std::vector<MaterialPoint>& force_points) {
    double largest = 0.0;
    Vec2 gravity = input.gravity.cwiseAbs();
    for (const Stage& stage : input.loads.stages) {
        if (stage.gravity) gravity = gravity.cwiseMax(stage.gravity->cwiseAbs());
        for (const auto& [i, force] : stage.forces)
            largest = std::max(largest, force.norm() / system.blocks[force_points[i].block].size);
        for (const auto& [boundary, pressure] : stage.pressure) largest = std::max(largest, std::abs(pressure));
        if (stage.motion && stage.motion->control == PlatenControl::stress) {
            largest = std::max(largest, std::abs(stage.motion->value));
        }
    }
    const Vec2 height = height_of_weights(system);
    for (const Material& material : input.materials)
        largest = std::max(largest, material.density * height.dot(gravity));
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

std::vector<MaterialPoint> points_of_forces(const BlockSystem& system, const LoadProgram& loads) {
    std::vector<MaterialPoint> points;
    for (const PointForce& force : loads.forces)
        points.push_back(material_point(system, force.block, force.point, "stages: the force '" + force.name + "'"));
    return points;
}

void refuse_moved_fixed_blocks(const BlockSystem& system, const LoadProgram& loads) {
    for (const Stage& stage : loads.stages) {
        if (!stage.motion) continue;
        const Boundary& boundary = system.boundaries[stage.motion->boundary];
        for (const auto& [b, e] : boundary.edges) {
            if (!system.blocks[b].fixed) continue;
            throw InputError(
                fmt::format("stages: expected a platen on blocks that are not fixed, found block {} on the "
                            "boundary '{}' that {} moves",
                            block_label(system, b), boundary.name, stage.name));
        }
    }
}

/// E and nu of the blocks of a rigid net: one law per interface type holds no more than one pair of them.
const Material& rock_of_rigid_net(const BlockSystem& system, const ModelInput& input) {
    const Material& rock = input.materials[system.blocks.front().material];
    for (const Block& block : system.blocks) {
        const Material& other = input.materials[block.material];
        if (other.youngs_modulus != rock.youngs_modulus || other.poissons_ratio != rock.poissons_ratio)
            throw InputError("materials." + other.name + ": expected youngs_modulus and poissons_ratio of " +
                             rock.name +
                             " with kinematics: rigid, where the interfaces of the tessellation carry the compliance "
                             "of the blocks; found others");
    }
    return rock;
}

/// E and nu of a material are the rock's where the net's stiffness follows from them, and else the blocks'.
ElasticModuli moduli_of_blocks(const Material& material, const ModelInput& input) {
    if (input.tessellation_type >= 0) {
        const InterfaceType& net = input.interface_types[input.tessellation_type];
        if (stiffness_from_ratio(net))
            return block_moduli(material.youngs_modulus, material.poissons_ratio, input.plane,
                                net.stiffness_ratio.value_or(default_stiffness_ratio),
                                net.shear_ratio.value_or(default_shear_ratio));
    }
    return plane_moduli(material.youngs_modulus, material.poissons_ratio, input.plane);
}

/// The stiffness of the net's interfaces with the compliance of the blocks in them.
InterfaceStiffness net_of_rigid_blocks(const InterfaceStiffness& given, const BlockSystem& system,
                                       const ModelInput& input) {
    const Material& rock = rock_of_rigid_net(system, input);
    try {
        if (stiffness_from_ratio(input.interface_types[input.tessellation_type]))
            return rigid_lattice_stiffness(rock.youngs_modulus, rock.poissons_ratio, input.plane, system.spacing);
        return with_compliance_of_blocks(given, plane_moduli(rock.youngs_modulus, rock.poissons_ratio, input.plane),
                                         input.plane, system.spacing);
    } catch (const InputError& error) {
        throw InputError("materials." + rock.name + "." + error.what());
    }
}

bool has_rigid_net(const ModelInput& input) {
    return input.kinematics == Kinematics::rigid && input.tessellation_type >= 0;
}

void add_law(const InterfaceType& type, int type_index, const InterfaceStiffness& given,
             const InterfaceStiffness& stiffness, double boundary_stress, Model& model) {
    model.laws.push_back(resolve_law(type, stiffness, boundary_stress));
    model.law_types.push_back(type_index);
    model.given_stiffness.push_back(given);
}

/// The laws of all interface types, each with the stiffness that the scene gives or, for a rigid net, that of its body.
void add_laws(const BlockSystem& system, const ModelInput& input, double boundary_stress, Model& model) {
    double stiffest_rock = 0.0;
    for (const Material& material : input.materials) stiffest_rock = std::max(stiffest_rock, material.youngs_modulus);
    for (int t = 0; t < static_cast<int>(input.interface_types.size()); ++t) {
        const InterfaceType& type = input.interface_types[t];
        const InterfaceStiffness given = resolve_stiffness(type, system.spacing, stiffest_rock);
        const bool rigid_net = has_rigid_net(input) && t == input.tessellation_type;
        add_law(type, t, given, rigid_net ? net_of_rigid_blocks(given, system, input) : given, boundary_stress, model);
        model.bonds.push_back(type.kind == InterfaceKind::potential_crack ? 1 : 0);
        model.fracture_law.push_back(type.fails_to >= 0 ? type.fails_to : t);
    }
}

/// What a broken edge of a net of rigid blocks follows. Mapped fractures of the same type keep the type's stiffness: they
/// cut hexagons whose edges carry all compliance already.
void add_law_of_broken_net(const BlockSystem& system, const ModelInput& input, double boundary_stress, Model& model) {
    const int broken = model.fracture_law[input.tessellation_type];
    if (broken == input.tessellation_type) return;
    const InterfaceType& type = input.interface_types[broken];
    const InterfaceStiffness given = model.given_stiffness[broken];
    const ElasticModuli blocks = moduli_of_blocks(rock_of_rigid_net(system, input), input);
    try {
        const auto stiffness = with_compliance_of_blocks(given, blocks, input.plane, system.spacing);
        model.fracture_law[input.tessellation_type] = static_cast<int>(model.laws.size());
        add_law(type, broken, given, stiffness, boundary_stress, model);
    } catch (const InputError& error) {
        throw InputError("interfaces." + type.name + ", broken edges of the tessellation: " + error.what());
    }
}

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

LatticeModuli moduli_of_body(const ElasticModuli& blocks, const ModelInput& input, const Model& model, double spacing) {
    if (input.tessellation_type < 0) return engineering_moduli(blocks, input.plane);
    const InterfaceLaw& law = model.laws[input.tessellation_type];
    const InterfaceStiffness net{.normal = law.normal_stiffness, .shear = law.shear_stiffness};
    if (input.kinematics == Kinematics::rigid) return rigid_lattice_moduli(net, spacing, input.plane);
    return lattice_moduli(blocks, net, spacing, input.plane);
}

/// Platens are laid on what they press as it lies, which a gap to some of it may not mean.
void warn_of_uneven_platens(Model& model) {
    std::set<int> seen;
    for (const Stage& stage : model.loads.stages) {
        if (!stage.motion || !seen.insert(stage.motion->boundary).second) continue;
        const double length = distance_across(model.system, stage.motion->boundary);
        for (const int boundary : {stage.motion->boundary, opposite_boundary(model.system, stage.motion->boundary)}) {
            if (boundary < 0) continue;
            const double apart = unevenness(model.system, boundary);
            if (apart <= uneven * length) continue;
            model.warnings.push_back(
                fmt::format("the platen on '{}' is laid on sides that lie up to {:.3g} m apart, and presses all of "
                            "them from the start as if it had been cast on them",
                            model.system.boundaries[boundary].name, apart));
        }
    }
}

} // namespace

Model build_model(BlockSystem system, const ModelInput& input) {
    Model model;
    model.plane = input.plane;
    model.kinematics = input.kinematics;
    model.gravity = input.gravity;
    model.loads = input.loads;
    model.loads.supports.resize(system.boundaries.size(), Support::none);

    model.force_points = points_of_forces(system, input.loads);
    model.histories = place_histories(system, input.histories);
    refuse_moved_fixed_blocks(system, input.loads);
    const double boundary_stress = largest_boundary_stress(system, input, model.force_points);
    add_laws(system, input, boundary_stress, model);
    if (has_rigid_net(input)) add_law_of_broken_net(system, input, boundary_stress, model);

    for (const Material& material : input.materials) {
        model.densities.push_back(material.density);
        const auto moduli = input.kinematics == Kinematics::affine
                                ? moduli_of_blocks(material, input)
                                : plane_moduli(material.youngs_modulus, material.poissons_ratio, input.plane);
        const auto effective = moduli_of_body(moduli, input, model, system.spacing);
        model.effective_modulus = std::max(model.effective_modulus, effective.youngs_modulus);
        model.moduli.push_back(moduli);
    }
    // One soft joint across a stiff body makes it as soft as k_n H.
    const double height = (system.upper - system.lower).maxCoeff();
    for (const Interface& interface : system.interfaces) {
        const double of_joint = model.laws[interface.interface_type].normal_stiffness * height;
        model.effective_modulus = std::min(model.effective_modulus, of_joint);
    }

    model.strengths.resize(system.interfaces.size());
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (!model.bonds[system.interfaces[i].interface_type]) continue;
        const auto [strength, was_capped] = capped(strength_of(system.interfaces[i], system, input));
        model.strengths[i] = scaled(strength, strength_factor(input.strength_noise, i));
        if (was_capped && model.warnings.empty()) {
            model.warnings.push_back(
                "the tensile strength of a potential crack is larger than c cot(phi) and was capped");
        }
        model.has_potential_cracks = true;
    }
    std::vector<const InterfaceLaw*> fracture_laws;
    for (const Interface& interface : system.interfaces)
        fracture_laws.push_back(&model.laws[model.fracture_law[interface.interface_type]]);
    model.overlap_points = overlap_points(system, fracture_laws);
    model.system = std::move(system);
    warn_of_uneven_platens(model);
    refuse_contradicting_supports(model);
    return model;
}

bool has_gravity(const Model& model) {
    return model.gravity != Vec2::Zero() || std::ranges::any_of(model.loads.stages, [](const Stage& stage) {
               return stage.gravity && *stage.gravity != Vec2::Zero();
           });
}

} // namespace kluft

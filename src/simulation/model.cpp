#include "kluft/simulation/model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/contact/overlap_rule.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/units.hpp"
#include "kluft/kinematics/material_point.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/causes.hpp"
#include "kluft/simulation/free_body.hpp"
#include "kluft/simulation/idle_forces.hpp"
#include "kluft/simulation/rock_constants.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/undeformable_blocks.hpp"

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
    law.overlap_points = type.overlap_points.value_or(0);
    law.friction_rounding = type.friction_rounding;
    return law;
}

/// The key of a point force in the first stage that has it.
std::string key_of_force(const LoadProgram& loads, int force) {
    const auto stage =
        std::ranges::find_if(loads.stages, [&](const Stage& each) { return each.forces.contains(force); });
    return fmt::format("stages.{}.forces.{}", stage - loads.stages.begin(),
                       loads.forces[static_cast<std::size_t>(force)].name);
}

/// Of the blocks at a point one that is not fixed and meets the first along something that is no edge of a net; -1 without one.
int block_across_a_joint(const BlockSystem& system, const std::vector<int>& blocks) {
    for (const Interface& each : system.interfaces) {
        if (each.origin == EdgeOrigin::tessellation) continue;
        const int other = each.block_a == blocks.front()   ? each.block_b
                          : each.block_b == blocks.front() ? each.block_a
                                                           : -1;
        const bool is_there = std::ranges::find(blocks, other) != blocks.end();
        if (other >= 0 && is_there && !system.blocks[other].fixed) return other;
    }
    return -1;
}

std::vector<MaterialPoint> points_of_forces(const BlockSystem& system, const LoadProgram& loads,
                                            std::vector<std::string>& warnings) {
    std::vector<MaterialPoint> points;
    for (const PointForce& force : loads.forces) {
        const std::string key = key_of_force(loads, static_cast<int>(points.size()));
        points.push_back(material_point(system, force.block, force.point, key));
        if (!force.block.empty()) continue;
        const int other = block_across_a_joint(system, blocks_containing(system, force.point));
        if (other >= 0)
            warnings.push_back(
                fmt::format("{}: its point lies on a joint of blocks {} and {}, and it acts on the first; `block` "
                            "names another, a point inside of one leaves no doubt",
                            key, block_label(system, points.back().block), block_label(system, other)));
    }
    return points;
}

/// Does what refuses values of a section of the scene by their keys alone.
template <class Do> auto in_section(const std::string& section, const Do& refuses) {
    try {
        return refuses();
    } catch (const InputError& error) {
        throw InputError(section + "." + error.what());
    }
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

/// A boundary that is smooth or has a platen is so in one direction.
void require_directions(const BlockSystem& system, const LoadProgram& loads) {
    const auto faces_all_ways = [&](int boundary) {
        const BoundaryFrame frame = boundary_frame(system, boundary);
        return frame.length > 0.0 && frame.normal.isZero();
    };
    for (std::size_t i = 0; i < loads.supports.size(); ++i) {
        const bool has_direction = loads.supports[i] == Support::smooth || loads.supports[i] == Support::pinned;
        if (has_direction && faces_all_ways(static_cast<int>(i)))
            throw InputError(fmt::format(
                "boundaries.{}.support: expected none or fixed for sides whose normals cancel, as around a hole, "
                "found {}",
                system.boundaries[i].name, loads.supports[i] == Support::smooth ? "smooth" : "pinned"));
    }
    for (const Stage& stage : loads.stages) {
        if (!stage.motion) continue;
        for (const int boundary : {stage.motion->boundary, resting_boundary(system, *stage.motion)}) {
            if (boundary < 0 || !faces_all_ways(boundary)) continue;
            throw InputError(
                fmt::format("{}: expected a boundary for the platen that faces one way, found '{}', whose sides "
                            "together face all ways",
                            stage.motion->place, system.boundaries[boundary].name));
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

/// A net of triangles has the edges that came out; Voronoi cells are taken for hexagons.
Net net_of_body(const BlockSystem& system, const ModelInput& input) {
    if (input.tessellation_type < 0) return {};
    if (input.net_kind != NetKind::triangles) return hexagon_net(system.spacing);
    return triangle_net_of(system.spacing, edges_per_triangle_area(system) / system.spacing);
}

/// The net where it has another spacing.
Net net_at(const Net& net, double spacing) {
    return {.kind = net.kind, .spacing = spacing, .edge_density = net.edge_density * net.spacing / spacing};
}

/// The E that ratios of stiffness refer to: the largest of the body's blocks (Pa).
double reference_modulus(const BlockSystem& system, const ModelInput& input) {
    double largest = 0.0;
    for (const Block& block : system.blocks)
        largest = std::max(largest, input.materials[block.material].youngs_modulus);
    return largest;
}

/// E and nu of a material are the rock's where the net's stiffness follows from them, and else the blocks'.
ElasticModuli moduli_of_blocks(const Material& material, const BlockSystem& system, const ModelInput& input,
                               const Net& body_net) {
    if (input.tessellation_type >= 0) {
        const InterfaceType& net = input.interface_types[input.tessellation_type];
        if (stiffness_from_ratio(net)) {
            const double ratio = net.stiffness_ratio.value_or(default_stiffness_ratio(body_net.kind));
            const double reference = std::max(reference_modulus(system, input), material.youngs_modulus);
            const double own_ratio = ratio * reference / material.youngs_modulus; // one that no block has stands alone
            return in_section("interfaces." + net.name, [&] {
                return block_moduli(material.youngs_modulus, material.poissons_ratio, input.plane, own_ratio,
                                    net.shear_ratio.value_or(default_shear_ratio), body_net);
            });
        }
    }
    return plane_moduli(material.youngs_modulus, material.poissons_ratio, input.plane);
}

bool has_rigid_net(const ModelInput& input) {
    return input.kinematics == Kinematics::rigid && input.tessellation_type >= 0;
}

/// The stiffness of the net's interfaces with the compliance of the blocks in them.
InterfaceStiffness net_of_rigid_blocks(const InterfaceStiffness& given, const BlockSystem& system,
                                       const ModelInput& input, const Net& net) {
    const Material& rock = rock_of_rigid_net(system, input);
    return in_section("materials." + rock.name, [&] {
        if (stiffness_from_ratio(input.interface_types[input.tessellation_type]))
            return rigid_lattice_stiffness(rock.youngs_modulus, rock.poissons_ratio, input.plane, net);
        return with_compliance_of_blocks(given, plane_moduli(rock.youngs_modulus, rock.poissons_ratio, input.plane),
                                         input.plane, net);
    });
}

/// The stiffness of an interface type in the body, which is the one that the scene gives but in a net of rigid blocks.
/// There the net's edges carry the compliance of the blocks, and of triangles, whose faces lie on the fractures, all do;
/// fractures cut hexagons, whose edges carry all compliance already.
InterfaceStiffness stiffness_in_body(int type, const InterfaceStiffness& given, const BlockSystem& system,
                                     const ModelInput& input, const Net& net) {
    if (!has_rigid_net(input)) return given;
    if (type == input.tessellation_type) return net_of_rigid_blocks(given, system, input, net);
    if (net.kind != NetKind::triangles) return given;
    const Material& rock = rock_of_rigid_net(system, input);
    const ElasticModuli blocks = moduli_of_blocks(rock, system, input, net);
    return in_section("materials." + rock.name,
                      [&] { return with_compliance_of_blocks(given, blocks, input.plane, net); });
}

/// What all laws of a model have in common.
struct LawBench {
    const BlockSystem& system;
    const ModelInput& input;
    double boundary_stress = 0.0;
    double youngs_modulus = 0.0; ///< that ratios refer to (Pa)
};

/// Adds a law of an interface type, with its own index as that after failure; returns the index.
int add_law(int type, const InterfaceStiffness& given, const InterfaceStiffness& stiffness, const LawBench& bench,
            Model& model) {
    const InterfaceType& of = bench.input.interface_types[type];
    const int law = static_cast<int>(model.laws.size());
    model.laws.push_back(resolve_law(of, stiffness, bench.boundary_stress));
    model.law_types.push_back(type);
    model.given_stiffness.push_back(given);
    model.bonds.push_back(of.kind == InterfaceKind::potential_crack ? 1 : 0);
    model.fracture_law.push_back(law);
    return law;
}

/// A law with the stiffness that the type has on a net, which decides what is given times the spacing or as a ratio.
int add_law_on_net(int type, const Net& net, const LawBench& bench, Model& model) {
    const InterfaceStiffness given = resolve_stiffness(bench.input.interface_types[type], net, bench.youngs_modulus);
    return add_law(type, given, stiffness_in_body(type, given, bench.system, bench.input, net), bench, model);
}

/// The laws of all interface types.
void add_laws(const LawBench& bench, Model& model) {
    const int n_types = static_cast<int>(bench.input.interface_types.size());
    Net net = model.net;
    net.spacing = bench.system.spacing; // also of a body without a net
    for (int t = 0; t < n_types; ++t) add_law_on_net(t, net, bench, model);
    for (int t = 0; t < n_types; ++t) {
        const int broken = bench.input.interface_types[t].fails_to;
        if (broken >= 0) model.fracture_law[t] = broken;
    }
}

/// What a broken edge of a net of rigid hexagons follows; mapped fractures of the same type keep the type's stiffness.
void add_law_of_broken_net(const LawBench& bench, Model& model) {
    const ModelInput& input = bench.input;
    const int broken = model.fracture_law[input.tessellation_type];
    if (model.net.kind == NetKind::triangles || broken == input.tessellation_type) return;
    const InterfaceStiffness given = model.given_stiffness[broken];
    const ElasticModuli blocks =
        moduli_of_blocks(rock_of_rigid_net(bench.system, input), bench.system, input, model.net);
    try {
        const auto stiffness = with_compliance_of_blocks(given, blocks, input.plane, model.net);
        model.fracture_law[input.tessellation_type] = add_law(broken, given, stiffness, bench, model);
    } catch (const InputError& error) {
        throw InputError("interfaces." + input.interface_types[broken].name +
                         ": broken edges of the tessellation: " + error.what());
    }
}

/// Laws of the edges of a graded net, and of what they fail to, for each spacing in it: their stiffness is that of a net of
/// this spacing, so that the body's moduli are the same everywhere.
void add_laws_of_graded_net(BlockSystem& system, const LawBench& bench, Model& model) {
    std::map<double, int> law_at;
    for (Interface& interface : system.interfaces) {
        if (interface.spacing <= 0.0 || interface.spacing == system.spacing) continue;
        const auto [found, is_new] = law_at.emplace(interface.spacing, static_cast<int>(model.laws.size()));
        interface.law = found->second;
        if (!is_new) continue;
        const Net net = net_at(model.net, interface.spacing);
        const int law = add_law_on_net(interface.interface_type, net, bench, model);
        const int broken = bench.input.interface_types[interface.interface_type].fails_to;
        if (broken >= 0) model.fracture_law[law] = add_law_on_net(broken, net, bench, model);
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

LatticeModuli moduli_of_body(const ElasticModuli& blocks, const ModelInput& input, const Model& model) {
    if (input.tessellation_type < 0) return engineering_moduli(blocks, input.plane);
    const InterfaceLaw& law = model.laws[input.tessellation_type];
    const InterfaceStiffness net{.normal = law.normal_stiffness, .shear = law.shear_stiffness};
    if (input.kinematics == Kinematics::rigid) return rigid_lattice_moduli(net, model.net, input.plane);
    return lattice_moduli(blocks, net, model.net, input.plane);
}

/// E, or half of E/(1 - nu^2) = 4 K G/(K + G) where that is more: a net with a shear stiffness far above its normal one has no
/// positive E in plane strain.
double modulus_for_scale(const LatticeModuli& body) {
    const double bulk = body.bulk_modulus;
    const double shear = body.shear_modulus;
    return std::max(body.youngs_modulus, 2.0 * bulk * shear / (bulk + shear));
}

/// Whether a fixed block or a support takes what a platen presses with.
bool is_platen_resisted(const BlockSystem& system, const LoadProgram& loads, int moved) {
    constexpr double along = 1e-3; // of a smooth side's normal on the platen's: less is round-off of a side beside it
    if (std::ranges::any_of(system.blocks, &Block::fixed)) return true;
    const Vec2 normal = boundary_frame(system, moved).normal;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        const Support support = loads.supports[i];
        if (i == moved || support == Support::none) continue;
        if (support != Support::smooth || std::abs(normal.dot(boundary_frame(system, i).normal)) > along) return true;
    }
    return false;
}

/// A platen that nothing stands against carries the body along, unless weight or forces press this on it.
void require_resistance(const BlockSystem& system, const Vec2& gravity, const LoadProgram& loads) {
    const bool is_loaded =
        !gravity.isZero() || !loads.forces.empty() ||
        std::ranges::any_of(loads.stages, [](const Stage& stage) { return stage.gravity.has_value(); });
    if (is_loaded) return;
    for (const Stage& stage : loads.stages) {
        if (!stage.motion || stage.motion->value == 0.0 || resting_boundary(system, *stage.motion) >= 0 ||
            is_platen_resisted(system, loads, stage.motion->boundary))
            continue;
        throw InputError(fmt::format(
            "{}: expected a boundary opposite to '{}', a support or a fixed block, against which its platen presses; "
            "found none: the body would be carried along",
            stage.motion->place.empty() ? stage.name : stage.motion->place,
            system.boundaries[stage.motion->boundary].name));
    }
}

/// Platens are laid on what they press as it lies, which a gap to some of it may not mean.
void warn_of_uneven_platen(const PlatenMotion& motion, Model& model) {
    const double length = distance_across(model.system, motion.boundary);
    for (const int boundary : {motion.boundary, resting_boundary(model.system, motion)}) {
        if (boundary < 0) continue;
        const double apart = unevenness(model.system, boundary);
        if (apart <= uneven * length) continue;
        model.warnings.push_back(
            fmt::format("the platen on '{}' is laid on sides that lie up to {:.3g} m apart, and presses all of "
                        "them from the start as if it had been cast on them",
                        model.system.boundaries[boundary].name, apart));
    }
}

/// Whether a support on another boundary than the platens' takes what the moved one presses with: one that is fixed, or faces it.
bool is_held_beside(const BlockSystem& system, const LoadProgram& loads, int moved, int rest) {
    constexpr double facing = -0.5; // cosine between the normals
    const Vec2 normal = boundary_frame(system, moved).normal;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        if (i == moved || i == rest || loads.supports[i] == Support::none) continue;
        if (loads.supports[i] == Support::fixed || boundary_frame(system, i).normal.dot(normal) < facing) return true;
    }
    return false;
}

/// A fixed platen lies on what faces the moved one, whether or not it was meant to be held there.
void warn_of_fixed_platen(const PlatenMotion& motion, Model& model) {
    constexpr double much_turned = 10.0 / degrees;
    const BlockSystem& system = model.system;
    const int moved = motion.boundary;
    const std::vector<int> opposite = opposite_boundaries(system, moved);
    if (motion.against || opposite.empty()) return;
    const int rest = opposite.front();
    std::vector<std::string> remarks;
    if (opposite.size() > 1) {
        std::vector<std::string> names;
        for (const int each : opposite) names.push_back("'" + system.boundaries[each].name + "'");
        remarks.push_back(fmt::format("the first of those that face it most, {}", fmt::join(names, ", ")));
    }
    const double cosine = -boundary_frame(system, moved).normal.dot(boundary_frame(system, rest).normal);
    const double turned = std::acos(std::clamp(cosine, -1.0, 1.0));
    if (turned > much_turned) remarks.push_back(fmt::format("turned against it by {:.3g} degrees", turned * degrees));
    if (model.loads.supports[rest] == Support::none && is_held_beside(system, model.loads, moved, rest))
        remarks.emplace_back("beside supports that hold the body there already");
    if (remarks.empty()) return;
    model.warnings.push_back(fmt::format("the platen on '{}' presses the body against a fixed platen on '{}', {}: "
                                         "`against` beside `boundary` names another one, or `none`",
                                         system.boundaries[moved].name, system.boundaries[rest].name,
                                         fmt::join(remarks, ", ")));
}

/// The axial stress counts from side to side of the body, also where a platen presses a part of it.
void warn_of_narrow_platen(int moved, Model& model) {
    if (!is_pressed_in_part(model.system, moved)) return;
    const double own = outer_width(model.system, moved, right_normal(boundary_frame(model.system, moved).normal));
    const double width = width_across(model.system, moved).width;
    model.warnings.push_back(fmt::format(
        "the axial stress of the platen on '{}' is its force over the width of the body, {:.4g} m, and not over "
        "its own {:.4g} m, on which it presses {:.3g} times as much; youngs_modulus and poissons_ratio of such a test "
        "are not the rock's, and by how much they differ cannot be known: smooth platens on the whole width give these",
        model.system.boundaries[moved].name, width, own, width / own));
}

/// What a platen has pressed is pressed evenly in a stage that has none there, and no support.
void warn_of_platens_that_go(Model& model) {
    const std::vector<Stage>& stages = model.loads.stages;
    for (std::size_t i = 1; i < stages.size(); ++i) {
        if (!stages[i - 1].motion) continue;
        const int boundary = stages[i - 1].motion->boundary;
        const auto& motion = stages[i].motion;
        const bool is_held =
            model.loads.supports[boundary] != Support::none ||
            (motion && (motion->boundary == boundary || resting_boundary(model.system, *motion) == boundary));
        const bool is_told =
            std::ranges::any_of(stages[i].pressure, [&](const auto& each) { return each.first == boundary; });
        if (is_held || is_told) continue;
        model.warnings.push_back(fmt::format("stage {} has no platen on '{}' any more: the force at the end of stage "
                                             "{} goes on as an even pressure there, "
                                             "which neither holds the sides in one plane nor rubs on them",
                                             i, model.system.boundaries[boundary].name, i - 1));
    }
}

void warn_of_platens(Model& model) {
    warn_of_platens_that_go(model);
    std::set<std::pair<int, int>> seen; // what moves, what rests
    std::set<int> moved;
    for (const Stage& stage : model.loads.stages) {
        if (!stage.motion) continue;
        const int rest = resting_boundary(model.system, *stage.motion);
        if (!seen.emplace(stage.motion->boundary, rest).second) continue;
        warn_of_fixed_platen(*stage.motion, model);
        warn_of_uneven_platen(*stage.motion, model);
        if (moved.insert(stage.motion->boundary).second) {
            warn_of_narrow_platen(stage.motion->boundary, model);
            continue;
        }
        model.warnings.push_back(fmt::format("what rests while the platen on '{}' moves changes from stage to stage: "
                                             "the axial strain is measured against what "
                                             "rests in the first of them",
                                             model.system.boundaries[stage.motion->boundary].name));
    }
}

/// What a boundary holds it holds along one direction, whichever way its sides face.
void warn_of_bent_supports(Model& model) {
    constexpr double much_turned = 10.0 / degrees; // of a side against the mean of the boundary
    const BlockSystem& system = model.system;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        const Support support = model.loads.supports[i];
        if (support != Support::smooth && support != Support::pinned) continue;
        const Vec2 normal = boundary_frame(system, i).normal;
        double turned = 0.0;
        for (const auto& [b, e] : system.boundaries[i].edges) {
            const Edge& edge = system.blocks[b].edges[e];
            const Vec2 own = right_normal(edge_end(system, edge) - edge_start(system, edge)).normalized();
            turned = std::max(turned, std::acos(std::clamp(own.dot(normal), -1.0, 1.0)));
        }
        if (turned <= much_turned) continue;
        model.warnings.push_back(
            fmt::format("the support of '{}' holds its sides along their mean normal, ({:.3g}, {:.3g}), from which "
                        "some are turned by "
                        "up to {:.3g} degrees: a boundary for each direction holds each along its own normal",
                        system.boundaries[i].name, normal.x(), normal.y(), turned * degrees));
    }
}

/// What presses a specimen from the side is measured on two sides that have boundaries of their own.
void warn_of_unmeasured_sides(Model& model) {
    const auto motion =
        std::ranges::find_if(model.loads.stages, [](const Stage& stage) { return stage.motion.has_value(); });
    if (motion == model.loads.stages.end()) return;
    const int moved = motion->motion->boundary;
    if (!lateral_sides(model.system, moved)[0].empty()) return;
    const int opposite = resting_boundary(model.system, *motion->motion);
    if (opposite < 0) return; // one part is pushed past another, as in a shear box: no specimen between platens
    for (const Stage& stage : model.loads.stages) {
        for (const auto& [boundary, pressure] : stage.pressure) {
            if (pressure == 0.0 || boundary == moved || boundary == opposite) continue;
            model.warnings.push_back(fmt::format(
                "the pressure on '{}' is in no lateral stress, and lateral strains and Poisson's ratio are not "
                "measured: no two sides across '{}' have boundaries of their own; give each of them one",
                model.system.boundaries[boundary].name, model.system.boundaries[moved].name));
            return;
        }
    }
}

bool has_fractures_of_scene(const BlockSystem& system) {
    return std::ranges::any_of(system.interfaces, [](const Interface& each) {
        return each.origin == EdgeOrigin::fracture || each.origin == EdgeOrigin::given;
    });
}

/// docs/theory.md, (41a). Blocks without a deformation of their own, whose net has none of it either, yield in their joints alone.
std::optional<double> compliance_across(const BlockSystem& system, const ModelInput& input) {
    if (!has_fractures_of_scene(system)) return std::nullopt;
    const bool is_undeformable = input.kinematics == Kinematics::rigid && !has_rigid_net(input);
    if (input.plane == Plane::stress || is_undeformable) return 0.0;
    double sum = 0.0;
    double area = 0.0;
    for (const Block& block : system.blocks) {
        if (block.fixed) continue;
        const Material& rock = input.materials[block.material];
        sum += block.area * rock.poissons_ratio * rock.poissons_ratio / rock.youngs_modulus;
        area += block.area;
    }
    return area > 0.0 ? sum / area : 0.0;
}

} // namespace

Model build_model(BlockSystem system, const ModelInput& input) {
    Model model;
    model.plane = input.plane;
    model.kinematics = input.kinematics;
    model.gravity = input.gravity;
    model.loads = input.loads;
    model.loads.supports.resize(system.boundaries.size(), Support::none);

    model.force_points = points_of_forces(system, input.loads, model.warnings);
    model.histories = place_histories(system, input.histories);
    refuse_moved_fixed_blocks(system, input.loads);
    require_directions(system, model.loads);
    require_resistance(system, model.gravity, model.loads);
    const double boundary_stress = largest_boundary_stress(system, input, model.force_points);
    model.net = net_of_body(system, input);
    model.compliance_across = compliance_across(system, input);
    const LawBench bench{.system = system,
                         .input = input,
                         .boundary_stress = boundary_stress,
                         .youngs_modulus = reference_modulus(system, input)};
    add_laws(bench, model);
    if (has_rigid_net(input)) add_law_of_broken_net(bench, model);
    add_laws_of_graded_net(system, bench, model);

    std::vector<bool> is_used(input.materials.size(), false);
    for (const Block& block : system.blocks) is_used[block.material] = true;
    for (const Material& material : input.materials) {
        model.densities.push_back(material.density);
        const auto moduli = input.kinematics == Kinematics::affine
                                ? moduli_of_blocks(material, system, input, model.net)
                                : plane_moduli(material.youngs_modulus, material.poissons_ratio, input.plane);
        if (is_used[&material - input.materials.data()])
            model.effective_modulus =
                std::max(model.effective_modulus, modulus_for_scale(moduli_of_body(moduli, input, model)));
        model.moduli.push_back(moduli);
    }
    // One soft joint across a stiff body makes it as soft as k_n H.
    const double height = (system.upper - system.lower).maxCoeff();
    for (const Interface& interface : system.interfaces) {
        const double of_joint = model.laws[law_of(interface)].normal_stiffness * height;
        model.effective_modulus = std::min(model.effective_modulus, of_joint);
    }

    model.strengths.resize(system.interfaces.size());
    bool any_was_capped = false;
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (!model.bonds[law_of(system.interfaces[i])]) continue;
        const auto [strength, was_capped] = capped(strength_of(system.interfaces[i], system, input));
        model.strengths[i] = scaled(strength, strength_factor(input.strength_noise, i));
        any_was_capped = any_was_capped || was_capped;
        model.has_potential_cracks = true;
    }
    if (any_was_capped)
        model.warnings.emplace_back(
            "the tensile strength of a potential crack is larger than c cot(phi) and was capped");
    std::vector<const InterfaceLaw*> fracture_laws;
    for (const Interface& interface : system.interfaces)
        fracture_laws.push_back(&model.laws[model.fracture_law[law_of(interface)]]);
    model.overlap_points = overlap_points(system, fracture_laws);
    model.system = std::move(system);
    warn_of_platens(model);
    warn_of_bent_supports(model);
    warn_of_unmeasured_sides(model);
    refuse_contradicting_supports(model);
    for (std::string& warning : idle_force_warnings(model)) model.warnings.push_back(std::move(warning));
    for (std::string& warning :
         std::array{unheld_body_warning(model), undeformable_blocks_warning(model), free_body_warning(model)})
        if (!warning.empty()) model.warnings.push_back(std::move(warning));
    return model;
}

bool has_gravity(const Model& model) {
    return model.gravity != Vec2::Zero() || std::ranges::any_of(model.loads.stages, [](const Stage& stage) {
               return stage.gravity && *stage.gravity != Vec2::Zero();
           });
}

} // namespace kluft

#include "kluft/constitutive/lattice_stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

namespace {

void require_elastic(double youngs_modulus, double poissons_ratio) {
    if (!(youngs_modulus > 0.0) || !std::isfinite(youngs_modulus))
        throw InputError(fmt::format("youngs_modulus: expected a value in Pa > 0, found {:g}", youngs_modulus));
    if (!(poissons_ratio > -1.0 && poissons_ratio < 0.5))
        throw InputError(fmt::format("poissons_ratio: expected a value > -1 and < 0.5, found {:g}", poissons_ratio));
}

double bulk_modulus(const ElasticModuli& moduli) { return moduli.lambda + moduli.mu; }

/// What a net adds to 1/(2 K) and 1/(2 G) of its blocks (1/Pa).
struct NetCompliance {
    double bulk = 0.0;
    double shear = 0.0;
};

/// (20) and (20a).
NetCompliance compliance_of(const Net& net, const InterfaceStiffness& interfaces) {
    const double bulk = net.edge_density / (2.0 * interfaces.normal);
    if (net.kind == NetKind::triangles)
        return {bulk, 0.25 * net.edge_density * (1.0 / interfaces.normal + 1.0 / interfaces.shear)};
    return {bulk, net.edge_density / (interfaces.normal + interfaces.shear)};
}

ElasticModuli moduli_from(double bulk, double shear) { return {.lambda = bulk - shear, .mu = shear}; }

/// Of an interface (m/Pa).
struct InterfaceCompliance {
    double normal = 0.0;
    double shear = 0.0;
};

/// The next ratio above or below with four decimals: what the message names is itself admissible.
double rounded_up(double ratio) { return (std::floor(ratio * 1e4) + 1.0) / 1e4; }
double rounded_down(double ratio) { return (std::ceil(ratio * 1e4) - 1.0) / 1e4; }

/// (20b): interfaces of rigid triangles that carry `own` compliance beside that of the blocks.
InterfaceStiffness of_rigid_triangles(const InterfaceCompliance& own, const ElasticModuli& blocks, const Net& net) {
    const double bulk = 1.0 / (net.edge_density * bulk_modulus(blocks));
    const double shear = own.shear + 2.0 / (net.edge_density * blocks.mu) - bulk;
    if (!(shear > 0.0))
        throw InputError(
            "poissons_ratio: too small for triangles of rigid blocks, whose interfaces would need a negative "
            "shear stiffness; take kinematics: affine");
    return {.normal = 1.0 / (own.normal + bulk), .shear = 1.0 / shear};
}

bool given_in_pascal_per_metre(const InterfaceType& type) { return type.normal_stiffness || type.shear_stiffness; }

bool given_times_spacing(const InterfaceType& type) {
    return type.normal_stiffness_times_spacing || type.shear_stiffness_times_spacing;
}

[[noreturn]] void reject(const InterfaceType& type, const std::string& reason) {
    throw InputError(fmt::format("interfaces.{}: {}", type.name, reason));
}

void require_one_way(const InterfaceType& type) {
    const int ways =
        int(given_in_pascal_per_metre(type)) + int(given_times_spacing(type)) + int(type.stiffness_ratio.has_value());
    if (ways > 1)
        reject(type,
               "expected one of normal_stiffness, normal_stiffness_times_spacing and stiffness_ratio, found several");
    if (type.shear_stiffness && !type.normal_stiffness) reject(type, "shear_stiffness needs normal_stiffness");
    if (type.shear_stiffness_times_spacing && !type.normal_stiffness_times_spacing)
        reject(type, "shear_stiffness_times_spacing needs normal_stiffness_times_spacing");
    if (type.shear_ratio && (type.shear_stiffness || type.shear_stiffness_times_spacing))
        reject(type, "expected a shear stiffness or shear_ratio, found both");
}

double required_spacing(const InterfaceType& type, double spacing) {
    if (!(spacing > 0.0))
        reject(type, fmt::format("{} needs a spacing: give geometry.tessellation or geometry.reference_spacing",
                                 given_times_spacing(type) ? "normal_stiffness_times_spacing" : "stiffness_ratio"));
    return spacing;
}

double normal_stiffness(const InterfaceType& type, const Net& net, double youngs_modulus_of_rock) {
    if (type.normal_stiffness) return *type.normal_stiffness;
    const double spacing = net.spacing;
    if (type.normal_stiffness_times_spacing)
        return *type.normal_stiffness_times_spacing / required_spacing(type, spacing);
    if (!(youngs_modulus_of_rock > 0.0)) reject(type, "stiffness_ratio needs youngs_modulus of the rock in Pa > 0");
    return type.stiffness_ratio.value_or(default_stiffness_ratio(net.kind)) * youngs_modulus_of_rock /
           required_spacing(type, spacing);
}

double shear_stiffness(const InterfaceType& type, double spacing, double normal) {
    if (type.shear_stiffness) return *type.shear_stiffness;
    if (type.shear_stiffness_times_spacing) return *type.shear_stiffness_times_spacing / spacing;
    return type.shear_ratio.value_or(default_shear_ratio) * normal;
}

} // namespace

ElasticModuli plane_moduli(double youngs_modulus, double poissons_ratio, Plane plane) {
    require_elastic(youngs_modulus, poissons_ratio);
    const double mu = youngs_modulus / (2.0 * (1.0 + poissons_ratio));
    const double through_thickness = plane == Plane::strain ? 1.0 - 2.0 * poissons_ratio : 1.0 - poissons_ratio;
    return {.lambda = 2.0 * mu * poissons_ratio / through_thickness, .mu = mu};
}

LatticeModuli engineering_moduli(const ElasticModuli& moduli, Plane plane) {
    const double bulk = bulk_modulus(moduli);
    const double shear = moduli.mu;
    const double poissons_ratio = plane == Plane::strain ? (1.0 - shear / bulk) / 2.0 : (bulk - shear) / (bulk + shear);
    return {.youngs_modulus = 2.0 * shear * (1.0 + poissons_ratio),
            .poissons_ratio = poissons_ratio,
            .bulk_modulus = bulk,
            .shear_modulus = shear};
}

Net hexagon_net(double spacing) {
    return {.kind = NetKind::hexagons, .spacing = spacing, .edge_density = 2.0 / spacing};
}

Net equilateral_net(double side) { return triangle_net_of(side, 2.0 * std::numbers::sqrt3 / side); }

Net triangle_net_of(double side, double edge_density) {
    return {.kind = NetKind::triangles, .spacing = side, .edge_density = edge_density};
}

LatticeModuli lattice_moduli(const ElasticModuli& blocks, const InterfaceStiffness& interfaces, const Net& net,
                             Plane plane) {
    const NetCompliance added = compliance_of(net, interfaces);
    const double bulk_compliance = 1.0 / (2.0 * bulk_modulus(blocks)) + added.bulk;
    const double shear_compliance = 1.0 / (2.0 * blocks.mu) + added.shear;
    return engineering_moduli(moduli_from(0.5 / bulk_compliance, 0.5 / shear_compliance), plane);
}

LatticeModuli rigid_lattice_moduli(const InterfaceStiffness& interfaces, const Net& net, Plane plane) {
    const NetCompliance all = compliance_of(net, interfaces);
    return engineering_moduli(moduli_from(0.5 / all.bulk, 0.5 / all.shear), plane);
}

InterfaceStiffness rigid_lattice_stiffness(double youngs_modulus_of_rock, double poissons_ratio_of_rock, Plane plane,
                                           const Net& net) {
    const ElasticModuli rock = plane_moduli(youngs_modulus_of_rock, poissons_ratio_of_rock, plane);
    if (net.kind == NetKind::triangles) return of_rigid_triangles({}, rock, net);
    const double normal = 2.0 * bulk_modulus(rock);
    const double shear = 4.0 * rock.mu - normal;
    if (!(shear > 1e-12 * normal))
        throw InputError(fmt::format(
            "poissons_ratio: {:g} is too large for hexagons of rigid blocks, whose interfaces would need a negative "
            "shear stiffness; it must be less than {} in plane {}, or give the interfaces' stiffnesses, or take "
            "kinematics: affine or a net of triangles",
            poissons_ratio_of_rock, plane == Plane::strain ? "1/4" : "1/3",
            plane == Plane::strain ? "strain" : "stress"));
    return {.normal = normal / net.spacing, .shear = shear / net.spacing};
}

double largest_poissons_ratio(const InterfaceStiffness& interfaces, double youngs_modulus, Plane plane,
                              double spacing) {
    const double sum = interfaces.normal + interfaces.shear;
    const double slack = youngs_modulus / spacing * interfaces.shear / (interfaces.normal * sum); // E/d (1/k_n - 1/sum)
    // k_s' = 0: (1 + nu)(1 - 2 nu) - (1 + nu)/2 = -slack in plane strain, (1 - nu) - (1 + nu)/2 = -slack in plane stress
    return plane == Plane::strain ? (std::sqrt(6.25 + 8.0 * slack) - 1.5) / 4.0 : (1.0 + 2.0 * slack) / 3.0;
}

InterfaceStiffness with_compliance_of_blocks(const InterfaceStiffness& interfaces, const ElasticModuli& blocks,
                                             Plane plane, const Net& net) {
    if (net.kind == NetKind::triangles)
        return of_rigid_triangles({1.0 / interfaces.normal, 1.0 / interfaces.shear}, blocks, net);
    const double spacing = net.spacing;
    const double normal = 1.0 / (1.0 / interfaces.normal + spacing / (2.0 * bulk_modulus(blocks)));
    const double sum = 1.0 / (1.0 / (interfaces.normal + interfaces.shear) + spacing / (4.0 * blocks.mu));
    const double shear = sum - normal;
    if (!(shear > 1e-12 * normal)) {
        const LatticeModuli rock = engineering_moduli(blocks, plane);
        throw InputError(fmt::format(
            "poissons_ratio: {:.4g} of the blocks is too large for rigid hexagons, whose interfaces would need a "
            "negative shear stiffness to carry the compliance of the blocks; with k_n {:g} and k_s {:g} Pa/m the "
            "largest admissible one is {:.4f}; or take kinematics: affine",
            rock.poissons_ratio, interfaces.normal, interfaces.shear,
            rounded_down(largest_poissons_ratio(interfaces, rock.youngs_modulus, plane, spacing))));
    }
    return {.normal = normal, .shear = shear};
}

double smallest_stiffness_ratio(double poissons_ratio_of_rock, Plane plane, double shear_ratio, const Net& net) {
    const ElasticModuli rock = plane_moduli(1.0, poissons_ratio_of_rock, plane);
    // The compliance of a net with k_n d = E = 1, which a ratio divides.
    const double normal = 1.0 / net.spacing;
    const NetCompliance at_one = compliance_of(net, {.normal = normal, .shear = shear_ratio * normal});
    return std::max(2.0 * bulk_modulus(rock) * at_one.bulk, 2.0 * rock.mu * at_one.shear);
}

ElasticModuli block_moduli(double youngs_modulus_of_rock, double poissons_ratio_of_rock, Plane plane,
                           double stiffness_ratio, double shear_ratio, const Net& net) {
    if (!(shear_ratio >= 0.0) || (shear_ratio == 0.0 && net.kind == NetKind::triangles))
        throw InputError(fmt::format("shear_ratio: expected a value {} 0, found {:g}",
                                     net.kind == NetKind::triangles ? ">" : ">=", shear_ratio));
    const ElasticModuli rock = plane_moduli(youngs_modulus_of_rock, poissons_ratio_of_rock, plane);
    const double smallest = smallest_stiffness_ratio(poissons_ratio_of_rock, plane, shear_ratio, net);
    if (!(stiffness_ratio > smallest))
        throw InputError(fmt::format(
            "stiffness_ratio: {:g} is too small: with poissons_ratio {:g} and shear_ratio {:g} no blocks are stiff "
            "enough to give the rock's youngs_modulus; the smallest admissible ratio is {:.4f}",
            stiffness_ratio, poissons_ratio_of_rock, shear_ratio, rounded_up(smallest)));
    const double normal = stiffness_ratio * youngs_modulus_of_rock / net.spacing;
    const NetCompliance added = compliance_of(net, {.normal = normal, .shear = shear_ratio * normal});
    const double bulk_compliance = 1.0 / (2.0 * bulk_modulus(rock)) - added.bulk;
    const double shear_compliance = 1.0 / (2.0 * rock.mu) - added.shear;
    return moduli_from(0.5 / bulk_compliance, 0.5 / shear_compliance);
}

bool stiffness_from_ratio(const InterfaceType& type) {
    return !given_in_pascal_per_metre(type) && !given_times_spacing(type);
}

InterfaceStiffness resolve_stiffness(const InterfaceType& type, const Net& net, double youngs_modulus_of_rock) {
    require_one_way(type);
    const double normal = normal_stiffness(type, net, youngs_modulus_of_rock);
    const double shear = shear_stiffness(type, net.spacing, normal);
    if (!(normal > 0.0) || !std::isfinite(normal))
        reject(type, fmt::format("expected a normal stiffness in Pa/m > 0, found {:g}", normal));
    if (!(shear >= 0.0) || !std::isfinite(shear))
        reject(type, fmt::format("expected a shear stiffness in Pa/m >= 0, found {:g}", shear));
    return {.normal = normal, .shear = shear};
}

} // namespace kluft

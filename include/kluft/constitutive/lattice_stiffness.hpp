// Elastic moduli in the plane, stiffness of interfaces, and what both give for a body cut by a net.
#pragma once

#include "kluft/constitutive/material.hpp"
#include "kluft/constitutive/net_kind.hpp"

namespace kluft {

/// Lame constants of the plane problem (Pa): stress = 2 mu strain + lambda tr(strain) I with 2x2 tensors. In plane
/// strain they are the rock's own; in plane stress lambda is 2 mu lambda/(lambda + 2 mu) of the rock's.
struct ElasticModuli {
    double lambda = 0.0;
    double mu = 0.0;
};

/// Isotropic moduli of a body in the plane (Pa).
struct LatticeModuli {
    double youngs_modulus = 0.0; ///< E of the material, whatever the plane
    double poissons_ratio = 0.0; ///< nu of the material, whatever the plane
    double bulk_modulus = 0.0;   ///< K = lambda + mu of the plane problem: (s_xx + s_yy)/2 per unit change of area
    double shear_modulus = 0.0;  ///< G = mu
};

/// Stiffness of an interface (Pa/m).
struct InterfaceStiffness {
    double normal = 0.0;
    double shear = 0.0;
};

inline constexpr double default_shear_ratio = 0.5; ///< k_s/k_n

/// Plane-reduced Lame constants of a material with Young's modulus E (Pa) and Poisson's ratio nu.
/// Throws InputError unless E > 0 and -1 < nu < 0.5.
[[nodiscard]] ElasticModuli plane_moduli(double youngs_modulus, double poissons_ratio, Plane plane);

/// E, nu, K and G of a material from its plane-reduced Lame constants; the inverse of plane_moduli.
[[nodiscard]] LatticeModuli engineering_moduli(const ElasticModuli& moduli, Plane plane);

/// What decides the compliance that a net's interfaces add to that of its blocks.
struct Net {
    NetKind kind = NetKind::hexagons;
    double spacing = 0.0;      ///< d: distance of centres of hexagons, side of triangles (m)
    double edge_density = 0.0; ///< Lambda: length of the net's edges inside the body per area (1/m)
};

/// Hexagons of spacing d: Lambda = 2/d. Voronoi cells are taken for hexagons of the same mean area.
[[nodiscard]] Net hexagon_net(double spacing);
/// Equilateral triangles of side a: Lambda = 2 sqrt(3)/a.
[[nodiscard]] Net equilateral_net(double side);
/// Triangles of mean side a with the edge density that they have.
[[nodiscard]] Net triangle_net_of(double side, double edge_density);

/// Moduli of a body cut by the net with elastic blocks and elastic interfaces (docs/theory.md, (20) and (20a)):
///   1/(2 K_eff) = 1/(2 K) + Lambda/(2 k_n),
///   1/(2 G_eff) = 1/(2 G) + Lambda/(k_n + k_s)               of hexagons,
///   1/(2 G_eff) = 1/(2 G) + Lambda/4 (1/k_n + 1/k_s)         of triangles.
/// Exact for regular hexagons and equilateral triangles without end; of other triangles a lower bound of the stiffness.
[[nodiscard]] LatticeModuli lattice_moduli(const ElasticModuli& blocks, const InterfaceStiffness& interfaces,
                                           const Net& net, Plane plane);

/// The same of rigid blocks: all compliance is that of the interfaces.
[[nodiscard]] LatticeModuli rigid_lattice_moduli(const InterfaceStiffness& interfaces, const Net& net, Plane plane);

/// Interfaces between rigid blocks that give the body the rock's E and nu: of hexagons k_n d = 2 K, k_s d = 4 G - 2 K, of
/// triangles k_n = Lambda K, 1/k_s = (4/Lambda)/(2 G) - (2/Lambda)/(2 K).
/// Throws InputError where k_s would not be positive: of hexagons nu >= 1/4 in plane strain, nu >= 1/3 in plane stress, of
/// triangles nu <= -1/2 and -1/3.
[[nodiscard]] InterfaceStiffness rigid_lattice_stiffness(double youngs_modulus_of_rock, double poissons_ratio_of_rock,
                                                         Plane plane, const Net& net);

/// Interfaces between rigid blocks that also carry the compliance of the blocks, so that the body is as stiff as one of
/// those blocks on `interfaces`. Of hexagons k_n' d = 2 K_eff, (k_n' + k_s') d = 4 G_eff of lattice_moduli, or
///   1/k_n' = 1/k_n + d/(2 K),   1/(k_n' + k_s') = 1/(k_n + k_s) + d/(4 G);
/// of triangles
///   1/k_n' = 1/k_n + (2/Lambda)/(2 K),   1/k_s' = 1/k_s + (4/Lambda)/(2 G) - (2/Lambda)/(2 K).
/// Throws InputError where k_s' would not be positive, of hexagons with the largest admissible nu of the blocks.
[[nodiscard]] InterfaceStiffness with_compliance_of_blocks(const InterfaceStiffness& interfaces,
                                                           const ElasticModuli& blocks, Plane plane, const Net& net);

/// The Poisson's ratio of rigid hexagons with this E from which on k_s' of with_compliance_of_blocks is not positive;
/// 1/2 or more: all are admissible.
[[nodiscard]] double largest_poissons_ratio(const InterfaceStiffness& interfaces, double youngs_modulus, Plane plane,
                                            double spacing);

/// Moduli that the blocks need so that the tessellated body has the rock's E and nu: lattice_moduli solved for the
/// blocks, with k_n d = stiffness_ratio E and k_s = shear_ratio k_n.
/// Throws InputError that names the smallest admissible stiffness_ratio where no positive moduli result.
[[nodiscard]] ElasticModuli block_moduli(double youngs_modulus_of_rock, double poissons_ratio_of_rock, Plane plane,
                                         double stiffness_ratio, double shear_ratio, const Net& net);

/// The ratio k_n d/E at which the blocks of block_moduli would have to be rigid; admissible ratios are larger.
[[nodiscard]] double smallest_stiffness_ratio(double poissons_ratio_of_rock, Plane plane, double shear_ratio,
                                              const Net& net);

/// True where the stiffness is given by stiffness_ratio (or not at all), so that a material's E and nu are the rock's.
[[nodiscard]] bool stiffness_from_ratio(const InterfaceType& type);

/// Stiffness in Pa/m from whichever of the three ways the interface type uses: normal_stiffness (Pa/m),
/// normal_stiffness_times_spacing (Pa) or stiffness_ratio (default that of the net's kind, times E of the rock). A shear
/// stiffness that is not given is shear_ratio (default 0.5) times the normal one. The net's spacing is needed by the two
/// scaled ways.
/// Throws InputError for two ways at once, a shear stiffness without its normal one or beside shear_ratio, a missing
/// spacing or E, a normal stiffness that is not positive, or a negative shear stiffness.
[[nodiscard]] InterfaceStiffness resolve_stiffness(const InterfaceType& type, const Net& net,
                                                   double youngs_modulus_of_rock);

} // namespace kluft

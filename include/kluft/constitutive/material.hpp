// Properties of rock and of interfaces as a scene gives them.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace kluft {

enum class Plane { strain, stress };

/// Strength of intact rock. Pa and radians.
struct Strength {
    double cohesion = 0.0;
    double friction_angle = 0.0;
    double tensile_strength = 0.0;
};

struct Material {
    std::string name;
    double density = 0.0;        ///< kg/m3
    double youngs_modulus = 0.0; ///< Pa; of the rock with stiffness_ratio, of the blocks with explicit stiffnesses
    double poissons_ratio = 0.0;
    std::optional<Strength> strength;
};

/// Young's modulus of the stiffest (Pa); 0 without any.
[[nodiscard]] inline double largest_modulus(const std::vector<Material>& materials) {
    double largest = 0.0;
    for (const Material& material : materials) largest = std::max(largest, material.youngs_modulus);
    return largest;
}

enum class InterfaceKind {
    potential_crack, ///< bonded until it fails
    fracture         ///< Coulomb friction, no tension
};

/// One entry of the scene's `interfaces`. Exactly one of the three ways to give the stiffness is used; `resolve` in
/// lattice_stiffness.hpp turns it into Pa/m.
struct InterfaceType {
    std::string name;
    InterfaceKind kind = InterfaceKind::fracture;
    std::optional<double> normal_stiffness;               ///< k_n, Pa/m
    std::optional<double> shear_stiffness;                ///< k_s, Pa/m
    std::optional<double> normal_stiffness_times_spacing; ///< k_n d, Pa
    std::optional<double> shear_stiffness_times_spacing;  ///< k_s d, Pa
    std::optional<double> stiffness_ratio;                ///< k_n d/E, default 10 when nothing is given
    std::optional<double> shear_ratio;                    ///< k_s/k_n, default 0.5
    double friction_angle = 0.0;                          ///< radians, of the fracture law
    double cohesion = 0.0;                                ///< Pa, of the fracture law
    double dilation_angle = 0.0;                          ///< radians
    std::optional<Strength> strength; ///< of a potential crack; absent: that of the weaker adjacent material
    int fails_to = -1; ///< interface type of a broken potential crack; -1: this one's own law as a fracture
    std::optional<double> cohesion_onset;   ///< t_r, Pa; default 0.01 c
    std::optional<double> contact_rounding; ///< g_0 k_n, Pa; default 1e-3 of the largest boundary or self-weight stress
    std::optional<int> overlap_points;      ///< 3 to 15; default 3, with cohesion up to 15
    double friction_rounding = 0.05;        ///< half-width of the rounding of Coulomb's limit, as a fraction of it
};

} // namespace kluft

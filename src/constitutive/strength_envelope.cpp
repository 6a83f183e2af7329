#include "kluft/constitutive/strength_envelope.hpp"

#include <cmath>
#include <limits>

namespace kluft {

namespace {

double load_over_strength(double load, double strength) {
    if (strength > 0.0) return load / strength;
    return load > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

FailureIndex governed(double shear, double tension) {
    const bool tension_governs = tension >= shear;
    return {
        .shear = shear, .tension = tension, .tension_governs = tension_governs, .f = tension_governs ? tension : shear};
}

} // namespace

PrincipalStresses principal_stresses(const Mat2& cauchy) {
    const double mean = (cauchy(0, 0) + cauchy(1, 1)) / 2.0;
    const double radius = std::hypot((cauchy(0, 0) - cauchy(1, 1)) / 2.0, (cauchy(0, 1) + cauchy(1, 0)) / 2.0);
    return {.p1 = radius - mean, .p3 = -radius - mean};
}

CappedStrength capped(const Strength& strength) {
    if (!(strength.friction_angle > 0.0)) return {.strength = strength};
    const double apex = strength.cohesion / std::tan(strength.friction_angle);
    if (strength.tensile_strength <= apex) return {.strength = strength};
    CappedStrength result{.strength = strength, .was_capped = true};
    result.strength.tensile_strength = apex;
    return result;
}

FailureIndex failure_index(double p1, double p3, const Strength& strength) {
    const double sine = std::sin(strength.friction_angle);
    const double shear_load = (1.0 - sine) * p1 - (1.0 + sine) * p3;
    const double shear_strength = 2.0 * strength.cohesion * std::cos(strength.friction_angle);
    return governed(load_over_strength(shear_load, shear_strength),
                    load_over_strength(-p3, capped(strength).strength.tensile_strength));
}

FailureIndex failure_index_traction(double normal_traction, double shear_traction, const Strength& strength) {
    const double shear_load = std::abs(shear_traction) + normal_traction * std::tan(strength.friction_angle);
    return governed(load_over_strength(shear_load, strength.cohesion),
                    load_over_strength(normal_traction, capped(strength).strength.tensile_strength));
}

double compressive_strength(const Strength& strength, double sigma_3) {
    const double sine = std::sin(strength.friction_angle);
    return (2.0 * strength.cohesion * std::cos(strength.friction_angle) + sigma_3 * (1.0 + sine)) / (1.0 - sine);
}

double uniaxial_compressive_strength(const Strength& strength) { return compressive_strength(strength, 0.0); }

double uniaxial_tension_in_shear(const Strength& strength) {
    return 2.0 * strength.cohesion * std::cos(strength.friction_angle) / (1.0 + std::sin(strength.friction_angle));
}

const Strength& weaker(const Strength& a, const Strength& b) {
    const double of_a = uniaxial_compressive_strength(a);
    const double of_b = uniaxial_compressive_strength(b);
    if (of_a != of_b) return of_a < of_b ? a : b;
    return b.tensile_strength < a.tensile_strength ? b : a;
}

} // namespace kluft

// When a potential crack fails: Mohr-Coulomb with a tension cut-off.
#pragma once

#include "kluft/constitutive/material.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

/// In-plane principal stresses, positive in compression, p1 >= p3 (Pa).
struct PrincipalStresses {
    double p1 = 0.0;
    double p3 = 0.0;
};

/// How near failure is: each index is linear in the stress and reaches 1 at failure.
struct FailureIndex {
    double shear = 0.0;
    double tension = 0.0;
    bool tension_governs = true; ///< tension >= shear: the mode of failure
    double f = 0.0;              ///< the larger of the two
};

/// A strength whose tensile part does not exceed the apex of the Coulomb line, c cot(phi).
struct CappedStrength {
    Strength strength;
    bool was_capped = false; ///< the tensile strength given was larger
};

/// Principal stresses of a Cauchy stress that is positive in tension (Pa); its symmetric part is taken.
[[nodiscard]] PrincipalStresses principal_stresses(const Mat2& cauchy);

[[nodiscard]] CappedStrength capped(const Strength& strength);

/// Failure by principal stresses, positive in compression, p1 >= p3 (Pa):
///   shear   ((1 - sin phi) p1 - (1 + sin phi) p3)/(2 c cos phi)   (Coulomb 1776 in principal stresses),
///   tension -p3/sigma_t, with sigma_t capped at c cot(phi).
/// A strength of zero gives +infinity at any positive numerator, else 0.
[[nodiscard]] FailureIndex failure_index(double p1, double p3, const Strength& strength);

/// Failure by an interface's own traction, t_n positive in tension (Pa):
///   shear   (|t_s| + t_n tan phi)/c,   tension t_n/sigma_t, with sigma_t capped at c cot(phi).
/// A strength of zero gives +infinity at any positive numerator, else 0.
[[nodiscard]] FailureIndex failure_index_traction(double normal_traction, double shear_traction,
                                                  const Strength& strength);

/// 2 c cos(phi)/(1 - sin(phi)) (Pa).
[[nodiscard]] double uniaxial_compressive_strength(const Strength& strength);

/// (2 c cos(phi) + sigma_3 (1 + sin(phi)))/(1 - sin(phi)) (Pa), Mohr-Coulomb's largest stress beside the confining one; docs/theory.md, (36).
[[nodiscard]] double compressive_strength(const Strength& strength, double sigma_3);

/// 2 c cos(phi)/(1 + sin(phi)) (Pa): the tension one way at which Mohr-Coulomb's shear criterion is met, whatever the tensile strength.
[[nodiscard]] double uniaxial_tension_in_shear(const Strength& strength);

/// The strength with the smaller uniaxial compressive strength, on a tie that with the smaller tensile strength.
[[nodiscard]] const Strength& weaker(const Strength& a, const Strength& b);

} // namespace kluft

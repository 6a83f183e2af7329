// Co-rotated linear elasticity of a block, closed form in the plane (docs/theory.md).
#pragma once

#include <Eigen/Core>

#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/core/vector.hpp"

namespace kluft {

using Mat4 = Eigen::Matrix4d;

/// First Piola-Kirchhoff stress P = 2 mu (F - R) + lambda (tr S - 2) R of the deformation gradient F = R S (Pa,
/// positive in tension). R is the closest rotation: with x = F11 + F22, y = F21 - F12, tr S = hypot(x, y).
[[nodiscard]] Mat2 first_piola_stress(const Mat2& deformation_gradient, const ElasticModuli& moduli);

/// The same from the displacement gradient H = F - I, without the round-off of 1 + H: small strains keep all digits.
[[nodiscard]] Mat2 stress_of_gradient(const Mat2& displacement_gradient, const ElasticModuli& moduli);

/// Strain energy density, mu |F - R|^2 + lambda/2 (tr S - 2)^2 (J/m3): the potential of first_piola_stress.
[[nodiscard]] double strain_energy_density(const Mat2& deformation_gradient, const ElasticModuli& moduli);

/// Cauchy stress P F^T/det F (Pa, positive in tension).
[[nodiscard]] Mat2 cauchy_stress(const Mat2& deformation_gradient, const ElasticModuli& moduli);
/// The same from H = F - I, with all digits also where the strain is a tiny part of 1.
[[nodiscard]] Mat2 cauchy_stress_of_gradient(const Mat2& displacement_gradient, const ElasticModuli& moduli);

/// dP/dF for F and P read column by column (F11, F21, F12, F22). Its eigenvalue along the rotation,
/// (tr S - 2)(2 mu + 2 lambda)/tr S, is negative under compression; `positive` sets it to zero then.
[[nodiscard]] Mat4 elastic_tangent(const Mat2& deformation_gradient, const ElasticModuli& moduli, bool positive);

} // namespace kluft

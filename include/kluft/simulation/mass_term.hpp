// The coefficients of the mass-like term: what holds the blocks of a body that contacts and supports do not hold.
#pragma once

#include <vector>

#include "kluft/loading/boundary_loads.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

/// True if the constraints stop every rigid motion of every group of bonded blocks. `bonded`: one per interface.
[[nodiscard]] bool is_held(const BlockSystem& system, const std::vector<char>& bonded, const Constraints& constraints);

/// eta = viscosity E/H^2 with the modulus and the height of the body (Pa/m2; docs/theory.md, mass-like term).
[[nodiscard]] double mass_coefficient(const Model& model, double viscosity);

/// The same per block, times the factors of the last relaxation; these may be empty, for 1 everywhere.
[[nodiscard]] std::vector<double> mass_coefficients(const Model& model, double viscosity,
                                                    const std::vector<double>& factors);

/// A block counts with at least the area of a cell of the net in M (m2).
[[nodiscard]] double least_mass_area(const BlockSystem& system);

/// Factors of the mass-like term in a relaxation: multiplied by 16 on the given blocks, on all if there are none. False
/// if nothing is left to grow.
bool grow_mass(const std::vector<int>& blocks, std::vector<double>& factors);

/// Divides the factor of a block on its way by 4, down to 1e-4.
void quicken(double& factor);

/// Divided by 4, down to 1; empty when nothing is left.
void decay_mass(std::vector<double>& factors);

} // namespace kluft

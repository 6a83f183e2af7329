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

/// A block counts with at least the area of a cell of the net in M (m2).
[[nodiscard]] double least_mass_area(const BlockSystem& system);

} // namespace kluft

// Strengths divided by a factor F: tan(phi) and c of the fractures and of the potential cracks (docs/theory.md, "Factor
// of safety").
#pragma once

#include <vector>

#include "kluft/constitutive/interface_law.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// The reduction that F of a stage belongs to: its own, or the next one, whose `from` is F while its loads are brought
/// up. Null where F is 1.
[[nodiscard]] const StrengthReduction* reduction_of(const LoadProgram& loads, int stage);

/// F at a load factor of a stage.
[[nodiscard]] double strength_factor(const LoadProgram& loads, int stage, double load_factor);

/// Strengths divided by F, of the interface types that the reduction names. Stiffness and tensile strength stay; a
/// dilation angle is cut to the friction angle that is left.
struct ReducedStrengths {
    std::vector<InterfaceLaw> laws;  ///< per interface type
    std::vector<Strength> strengths; ///< per interface
};
[[nodiscard]] ReducedStrengths reduced_strengths(const Model& model, int stage, double load_factor);

} // namespace kluft

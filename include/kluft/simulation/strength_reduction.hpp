// Strengths divided by a factor F: tan(phi) and c of the fractures and of the potential cracks (docs/theory.md, "Factor
// of safety").
#pragma once

#include <string>
#include <vector>

#include "kluft/constitutive/interface_law.hpp"
#include "kluft/constitutive/strength_envelope.hpp"
#include "kluft/simulation/model.hpp"

namespace kluft {

/// The reduction that F of a stage belongs to: its own, or the next one, whose `from` is F while its loads are brought
/// up. Null where F is 1.
[[nodiscard]] const StrengthReduction* reduction_of(const LoadProgram& loads, int stage);

/// F at a load factor of a stage.
[[nodiscard]] double strength_factor(const LoadProgram& loads, int stage, double load_factor);

/// The interfaces that the reduction of a stage names, where others in the body keep their strengths; else empty.
[[nodiscard]] std::vector<std::string> reduced_alone(const Model& model, int stage);

/// The laws of the model with tan(phi) and c divided by `factor`, of the interface types that the reduction of a stage
/// names. Stiffness and tensile strength stay; a dilation angle is cut to the friction angle that is left.
[[nodiscard]] std::vector<InterfaceLaw> reduced_laws(const Model& model, int stage, double factor);

/// The strengths of the potential cracks divided in the same way, one per interface.
[[nodiscard]] std::vector<Strength> reduced_strengths(const Model& model, int stage, double factor);

} // namespace kluft

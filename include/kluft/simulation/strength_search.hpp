// The factor of safety: strengths divided by larger and larger factors until no equilibrium is found
// (docs/theory.md, "Factor of safety").
#pragma once

#include <string>

#include "kluft/simulation/load_step.hpp"

namespace kluft {

/// Takes the load steps of a stage that reduces strengths. Where no equilibrium is found, the interval between the last
/// factor with equilibrium and the first one without is halved, always from the last equilibrium: load steps that fail
/// leave nothing behind. The stage then ends with a failure and the factor of safety, or with a warning that the factor
/// is above the stage's.
[[nodiscard]] StageEnd find_strength_limit(const StepBench& bench, State& state);

/// A warning that the factor of safety found may be that of another place of the body: `said` is what the body has come to,
/// `without` the last factor before.
[[nodiscard]] std::string doubt_in_words(const std::string& said, double factor, double without);

/// |R|/F_ref that an equilibrium with reduced strengths must reach.
[[nodiscard]] double reduction_tolerance(const StrengthReduction& reduction, const SolverOptions& solver);

} // namespace kluft

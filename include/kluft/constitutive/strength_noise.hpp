// Random strengths for replicas of a run.
#pragma once

#include <cstdint>

#include "kluft/constitutive/material.hpp"

namespace kluft {

struct StrengthNoise {
    double deviation = 0.0; ///< relative standard deviation, 0 <= deviation < 0.3
    std::uint64_t seed = 1;
};

/// A log-normal number of mean 1 and standard deviation `noise.deviation` for the interface with this index; 1 without
/// noise. It is exp(s z - s^2/2), s^2 = ln(1 + deviation^2), with z the normal quantile of a number that depends on the
/// seed and the index only.
[[nodiscard]] double strength_factor(const StrengthNoise& noise, int interface);

/// Cohesion and tensile strength times the factor; the friction angle stays.
[[nodiscard]] Strength scaled(const Strength& strength, double factor);

} // namespace kluft

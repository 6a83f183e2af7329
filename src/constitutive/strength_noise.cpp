#include "kluft/constitutive/strength_noise.hpp"

#include <cmath>
#include <numbers>

#include <boost/math/special_functions/erf.hpp>

#include "kluft/core/mixed_bits.hpp"

namespace kluft {

namespace {

/// In (0, 1), symmetric about 1/2, from the upper 52 bits.
double open_unit(std::uint64_t bits) { return (static_cast<double>(bits >> 12U) + 0.5) * 0x1.0p-52; }

double normal_quantile(double probability) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * probability); }

} // namespace

double strength_factor(const StrengthNoise& noise, int interface) {
    if (noise.deviation == 0.0) return 1.0;
    const std::uint64_t bits = mixed_bits(mixed_bits(noise.seed) ^ static_cast<std::uint64_t>(interface));
    const double variance = std::log1p(noise.deviation * noise.deviation);
    return std::exp(std::sqrt(variance) * normal_quantile(open_unit(bits)) - 0.5 * variance);
}

Strength scaled(const Strength& strength, double factor) {
    Strength result = strength;
    result.cohesion *= factor;
    result.tensile_strength *= factor;
    return result;
}

} // namespace kluft

// A block on a slope, for tests of friction and overturning.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

namespace kluft {

/// A block of width x height (m) on a fixed plinth of its width, gravity turned by the slope; phi = 30 degrees.
inline std::string block_on_slope(double width, double height, double slope_degrees) {
    const double angle = slope_degrees * std::numbers::pi / 180.0;
    return fmt::format(R"(
kluft: 1
analysis: {{plane: stress, gravity: [{:.17g}, {:.17g}]}}
materials: {{rock: {{density: 2500, youngs_modulus: 100 GPa, poissons_ratio: 0.2}}}}
interfaces: {{joint: {{kind: fracture, normal_stiffness: 1e11, shear_stiffness: 1e11, friction_angle: 30, contact_rounding: 0, friction_rounding: 0}}}}
geometry:
  domain: {{rectangle: {{width: {}, height: {}}}}}
  fractures: [{{name: plane, trace: [[-9, 0.5], [9, 0.5]], interface: joint}}]
  reference_spacing: 1.0
boundaries: {{bottom: {{support: fixed}}}}
stages: [{{name: weight, steps: 2}}]
solver: {{tolerance: 1e-10, balance: 1e-6, max_unbalanced_steps: 1}}
)",
                       10.0 * std::sin(angle), -10.0 * std::cos(angle), width, height + 0.5);
}

} // namespace kluft

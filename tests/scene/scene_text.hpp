// Scene texts and error messages for the tests of the scene reader.
#pragma once

#include <string>
#include <vector>

#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_reader.hpp"

namespace kluft::test {

/// A complete scene with one of everything.
inline const std::string full_scene = R"(kluft: 1
title: One of everything
analysis: {plane: strain, integrator: implicit, kinematics: affine, gravity: 9.81}
materials:
  rock:
    density: 2650 kg/m3
    youngs_modulus: 25 GPa
    poissons_ratio: 0.25
    cohesion: 5 MPa
    friction_angle: 40 deg
    tensile_strength: 2 MPa
  clay: {density: 2000, youngs_modulus: 10 MPa, poissons_ratio: 0.4, cohesion: 0.1 MPa, friction_angle: 20,
         tensile_strength: 1 kPa}
interfaces:
  joint:
    kind: fracture
    normal_stiffness: 10 GPa/m
    shear_stiffness: 5 GPa/m
    friction_angle: 25
    cohesion: 10 kPa
    dilation_angle: 5
    cohesion_onset: 1 kPa
    contact_rounding: 2 kPa
    friction_rounding: 0.1
  bond: {kind: potential_crack, stiffness_ratio: 12, shear_ratio: 0.4, fails_to: joint}
  seam: {kind: potential_crack, normal_stiffness_times_spacing: 1 GPa, shear_stiffness_times_spacing: 0.5 GPa,
         cohesion: 1 MPa, friction_angle: 35, tensile_strength: 0.5 MPa, fails_to: joint}
geometry:
  domain:
    rectangle: {width: 2, height: 4, origin: [1, -1]}
  fractures:
    - {name: main, trace: [[0, 0], [4, 2]], interface: joint}
    - {trace: [[0, 1], [1.5, 1], [4, 200 cm]], interface: seam}
  tessellation:
    hexagons: {spacing: 20 cm, rotation: 15, offset: [1 cm, 0.02], jitter: 0.1, seed: 7}
    interface: bond
    region: [[1, 0], [3, 0], [3, 2], [1, 2]]
  reference_spacing: 0.3
  minimum_area: 0.04
  material: rock
  regions:
    - {polygon: [[1, -1], [3, -1], [3, 0], [1, 0]], material: clay}
boundaries:
  bottom: {support: fixed}
  left: {support: smooth}
stages:
  - {name: weight, pressure: {right: 1 MPa, top: 2 MPa}, steps: 3}
  - {name: press, strain: {boundary: top, value: 1.5 %}, platens: rough, steps: 40}
  - {name: push, displacement: {boundary: right, value: 3 mm}}
  - {name: load, stress: {boundary: top, value: 3 MPa}, steps: 5}
cracks: {criterion: interface_traction, update: all, every: 2, event_tolerance: 1e-3}
solver: {tolerance: 1e-6, balance: 1e-4, viscosity: 0.1, max_iterations: 30, max_unbalanced_steps: 4,
         tangent: symmetric, repeatable: true}
output: {fields: false, fields_every: 10, pictures: false, checkpoint_every: 5, checkpoint_seconds: 90 s}
)";

/// The shortest scene: a block between platens.
inline const std::string short_scene = R"(kluft: 1
materials:
  rock: {youngs_modulus: 1 GPa, poissons_ratio: 0.25}
geometry:
  domain: {rectangle: {width: 1, height: 2}}
stages:
  - strain: {boundary: top, value: 1 %}
)";

/// The messages of what a reader throws; none if it does not throw.
template <class Read> std::vector<std::string> messages_of(Read read) {
    try {
        (void)read();
    } catch (const InputError& error) {
        return error.messages();
    }
    return {};
}

inline std::vector<std::string> errors_in(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return messages_of([&] { return read_scene_text(text, overrides); });
}

/// Errors of the full scene with overrides.
inline std::vector<std::string> errors_with(const std::vector<std::string>& overrides) {
    return errors_in(full_scene, overrides);
}

} // namespace kluft::test

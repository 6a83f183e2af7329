// Scenes and calibration files for the tests of calibration.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace kluft::testing {

/// A specimen of 0.2 m x 0.4 m of rock with E 15 GPa, nu 0.25, cut by `tessellation` and `fractures` (YAML, may be empty).
inline std::string specimen(const std::string& tessellation, const std::string& fractures = "",
                            const std::string& plane = "strain") {
    return "kluft: 1\n"
           "analysis: {plane: " +
           plane +
           "}\n"
           "materials:\n"
           "  rock: {density: 2500, youngs_modulus: 15 GPa, poissons_ratio: 0.25, cohesion: 8 MPa, friction_angle: 40, "
           "tensile_strength: 2.5 MPa}\n"
           "interfaces:\n"
           "  joint: {kind: fracture, normal_stiffness: 400 GPa/m, shear_stiffness: 150 GPa/m, friction_angle: 20}\n"
           "  bond: {kind: potential_crack, normal_stiffness: 3 TPa/m, shear_stiffness: 1.5 TPa/m, fails_to: joint}\n"
           "geometry:\n"
           "  domain: {rectangle: {width: 0.2, height: 0.4}}\n" +
           (fractures.empty() ? "" : "  fractures: " + fractures + "\n") + "  tessellation: {" + tessellation +
           ", interface: bond}\n"
           "stages:\n"
           "  - {name: pressure, pressure: {left: 0, right: 0}, steps: 1}\n"
           "  - {name: platen, strain: {boundary: top, value: 0.8 %}, steps: 20}\n"
           "output: {pictures: false, fields: false}\n";
}

inline const std::string hexagons = "hexagons: {spacing: 0.02}";
inline const std::string jittered_hexagons = "hexagons: {spacing: 0.02, jitter: 0.15, seed: 3}";
inline const std::string voronoi = "voronoi: {spacing: 0.02, seed: 5}";
inline const std::string triangles = "triangles: {spacing: 0.03, seed: 2}";
inline const std::string two_fractures = "[{name: a, trace: [[-0.01, 0.1], [0.15, 0.26]], interface: joint}, "
                                         "{name: b, trace: [[0.05, 0.35], [0.21, 0.2]], interface: joint}]";

inline void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

} // namespace kluft::testing

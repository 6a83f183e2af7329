// The body with its mechanics resolved to numbers: what a run needs and never changes.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/interface_law.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/constitutive/material.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/loading/load_program.hpp"

namespace kluft {

struct Model {
    BlockSystem system;
    Plane plane = Plane::strain;
    Kinematics kinematics = Kinematics::affine;
    Vec2 gravity = Vec2::Zero();       ///< m/s2
    std::vector<ElasticModuli> moduli; ///< of the blocks, per material
    std::vector<double> densities;     ///< per material (kg/m3)
    std::vector<InterfaceLaw> laws;    ///< per interface type
    std::vector<char> bonds;           ///< per interface type: 1 for a potential crack
    std::vector<int> fracture_law;     ///< per interface type: the law after failure, its own for a fracture
    std::vector<Strength> strengths;   ///< per interface; of use for potential cracks only
    LoadProgram loads;
    double effective_modulus = 0.0; ///< E of the body, for the mass-like term (Pa)
    bool has_potential_cracks = false;
    std::vector<std::string> warnings;
};

/// What a scene says of the mechanics.
struct ModelInput {
    Plane plane = Plane::strain;
    Kinematics kinematics = Kinematics::affine;
    Vec2 gravity = Vec2::Zero();
    std::vector<Material> materials;
    std::vector<InterfaceType> interface_types;
    int tessellation_type = -1; ///< interface type of the hexagon net; -1 without one
    LoadProgram loads;
};

/// Throws InputError where stiffnesses cannot be resolved or a potential crack has no strength.
[[nodiscard]] Model build_model(BlockSystem system, const ModelInput& input);

/// A number of the body, its mechanics and its loads, as text: a saved state belongs to one of them.
[[nodiscard]] std::string fingerprint(const Model& model);

} // namespace kluft

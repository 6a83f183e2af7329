// The body with its mechanics resolved to numbers: what a run needs and never changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/constitutive/interface_law.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/constitutive/material.hpp"
#include "kluft/constitutive/strength_noise.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/loading/load_program.hpp"
#include "kluft/simulation/histories.hpp"

namespace kluft {

struct Model {
    BlockSystem system;
    Plane plane = Plane::strain;
    Kinematics kinematics = Kinematics::affine;
    Vec2 gravity = Vec2::Zero();       ///< at the end of the first stage, unless that has its own (m/s2)
    std::vector<ElasticModuli> moduli; ///< of the blocks, per material
    std::vector<double> densities;     ///< per material (kg/m3)
    /// One per interface type; then those of edges whose stiffness differs from the type's: of a broken net of rigid
    /// hexagons, which carries the compliance of the blocks, and of a graded net for each of its spacings.
    std::vector<InterfaceLaw> laws;
    std::vector<int> law_types;                      ///< per law: the interface type that it belongs to
    std::vector<InterfaceStiffness> given_stiffness; ///< per law: as the scene has it, without compliance of blocks
    std::vector<char> bonds;                         ///< per law: 1 for a potential crack
    std::vector<int> fracture_law;                   ///< per law: that after failure, its own for a fracture
    Net net;                                         ///< of the tessellation, if there is one
    std::vector<int> overlap_points;                 ///< per interface: points of an overlap of two blocks along it
    std::vector<Strength> strengths;                 ///< per interface; of use for potential cracks only
    LoadProgram loads;
    std::vector<MaterialPoint> force_points; ///< where LoadProgram::forces act
    /// E of the body (at least half of E/(1 - nu^2)), or of its softest joint, k_n H, for the mass-like term (Pa).
    double effective_modulus = 0.0;
    /// By how much more a body with fractures yields under a stress in plane stress than in plane strain, the mean of nu^2/E over its
    /// blocks (1/Pa); 0 in plane stress. None of a body without fractures that are mapped or lie between given blocks (docs/theory.md, (41a)).
    std::optional<double> compliance_across;
    std::vector<HistoryGauge> histories;
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
    int tessellation_type = -1; ///< interface type of the net; -1 without one
    NetKind net_kind = NetKind::hexagons;
    StrengthNoise strength_noise;
    LoadProgram loads;
    std::vector<HistoryRequest> histories;
};

/// In a tessellated body of rigid blocks the net's interfaces take over the compliance of the blocks (docs/theory.md,
/// lattice). Throws InputError where stiffnesses cannot be resolved, a potential crack has no strength, a platen moves a
/// fixed block, a boundary whose normals cancel has a platen or a support other than fixed, or a point force or a history is of
/// no block.
[[nodiscard]] Model build_model(BlockSystem system, const ModelInput& input);

/// Whether there is gravity in any stage.
[[nodiscard]] bool has_gravity(const Model& model);

} // namespace kluft

// A scene: everything that a scene file says, checked and in SI. Never changes after reading.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/geometry_spec.hpp"
#include "kluft/constitutive/material.hpp"
#include "kluft/kinematics/rigid.hpp"
#include "kluft/loading/load_program.hpp"
#include "kluft/scene/key_places.hpp"
#include "kluft/simulation/histories.hpp"
#include "kluft/simulation/simulation_options.hpp"

namespace kluft {

/// What a run writes beside history.csv, cracks.csv, equilibria.csv and summary.json.
struct OutputOptions {
    int fields_every = 0;                  ///< load steps between two field files; 0: none for that reason
    int fields_at_cracks = 10;             ///< the most field files for cracks that failed
    bool fields = true;                    ///< write fields.pvd and fields/*.vtu
    bool pictures = true;                  ///< write curve and blocks pictures
    bool report = true;                    ///< write report.html
    std::vector<HistoryRequest> histories; ///< the columns of histories.csv
    int checkpoint_every = 0; ///< load steps between two state.h5; 0: at the end of each stage and when the run ends
    double checkpoint_seconds = 60.0; ///< after so much time by the clock a state is saved too; 0: not for that reason
};

struct Scene {
    std::string name; ///< the file's stem
    std::string title;
    Plane plane = Plane::strain;
    Kinematics kinematics = Kinematics::affine;
    double gravity_x = 0.0; ///< m/s2
    double gravity_y = 0.0;
    std::vector<Material> materials;
    std::vector<InterfaceType> interface_types;
    GeometrySpec geometry;
    LoadProgram loads;
    CrackOptions cracks;
    SolverOptions solver;
    Integrator integrator = Integrator::implicit;
    ExplicitOptions explicit_options; ///< of use for the explicit integrator only
    OutputOptions output;
    std::vector<std::string> warnings; ///< what the reader noticed and accepted
    std::vector<KeyPlace> places;      ///< of its keys, for messages
    std::string text; ///< YAML with all overrides and extended scenes in it; reading it gives the same scene
};

/// What a heading calls the scene: its title, its name where it has none.
[[nodiscard]] inline const std::string& heading_of(const Scene& scene) {
    return scene.title.empty() ? scene.name : scene.title;
}

} // namespace kluft

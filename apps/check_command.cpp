// kluft check SCENE
#include <algorithm>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/scene/scene_model.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "standard_output.hpp"

namespace kluft {

namespace {

void print_blocks(const Scene& scene, const SceneModel& built) {
    const BlockSystem& system = built.model.system;
    const Vec2 extent = system.upper - system.lower;
    say("body         {:.6g} m x {:.6g} m, plane {}\n", extent.x(), extent.y(),
        scene.plane == Plane::strain ? "strain" : "stress");
    say("blocks       {}\n", system.n_blocks());
    say("unknowns     {}\n", unknowns_per_block(scene.kinematics) * system.n_blocks());
    say("interfaces   {}\n", system.n_interfaces());
    for (std::size_t t = 0; t < scene.interface_types.size(); ++t) {
        const auto count = std::ranges::count(system.interfaces, static_cast<int>(t), &Interface::interface_type);
        if (count == 0) continue;
        say("  {:<16} {:>7}  {}\n", scene.interface_types[t].name, count,
            built.model.bonds[t] ? "potential crack" : "fracture");
    }
}

void print_cut(const CutReport& cut) {
    say("smallest     area {:.4g} m2, edge {:.4g} m, angle {:.4g} deg\n", cut.smallest_area, cut.smallest_edge,
        cut.smallest_angle * 180.0 / std::numbers::pi);
    say("mended       {} slivers merged, {} short edges collapsed, {} ends pruned\n", cut.merged.size(),
        cut.collapsed_edges, cut.pruned_ends);
    constexpr std::size_t most_listed = 10;
    for (std::size_t i = 0; i < std::min(most_listed, cut.merged.size()); ++i) {
        say("  merged {:.3g} m2 at ({:.6g}, {:.6g})\n", cut.merged[i].area, cut.merged[i].at.x(), cut.merged[i].at.y());
    }
    if (cut.merged.size() > most_listed) say("  and {} more\n", cut.merged.size() - most_listed);
}

void print_stiffness(const Scene& scene, const Model& model) {
    const double d = model.system.spacing;
    for (std::size_t t = 0; t < scene.interface_types.size(); ++t) {
        const auto& [normal, shear] = model.given_stiffness[t];
        say("stiffness    {}: k_n {:.4g} Pa/m, k_s {:.4g} Pa/m, k_n d/E {:.4g}\n", scene.interface_types[t].name,
            normal, shear, normal * d / scene.materials.front().youngs_modulus);
    }
    for (std::size_t t = 0; t < model.laws.size(); ++t) {
        const InterfaceLaw& law = model.laws[t];
        if (t >= scene.interface_types.size() && model.net.kind == NetKind::triangles) break; // of other spacings
        if (law.normal_stiffness == model.given_stiffness[t].normal) continue;
        say("             {}{}: k_n {:.4g} Pa/m, k_s {:.4g} Pa/m with the compliance of the rigid blocks\n",
            scene.interface_types[model.law_types[t]].name,
            t < scene.interface_types.size() ? "" : " of a broken hexagon edge", law.normal_stiffness,
            law.shear_stiffness);
    }
    if (!scene.geometry.tessellation) return;
    const InterfaceLaw& net = model.laws[scene.geometry.tessellation->interface_type];
    for (std::size_t m = 0; m < model.moduli.size(); ++m) {
        const InterfaceStiffness stiffness{.normal = net.normal_stiffness, .shear = net.shear_stiffness};
        const auto lattice = model.kinematics == Kinematics::rigid
                                 ? rigid_lattice_moduli(stiffness, model.net, model.plane)
                                 : lattice_moduli(model.moduli[m], stiffness, model.net, model.plane);
        say("lattice      {}: E {:.4g} Pa, nu {:.4g}\n", scene.materials[m].name, lattice.youngs_modulus,
            lattice.poissons_ratio);
    }
}

/// Largest memory of a run with a factor of so many bytes, fitted to measured ones: "Memory" in docs/theory.md.
double estimated_memory(const Scene& scene, const Model& model, double factor) {
    constexpr double program = 28e6;
    constexpr double per_block = 7.4e3;
    constexpr double per_fracture = 2.2e3; // interface that is no bond
    constexpr double pictures = 48e6;      // with the program; they are drawn when the factor is gone
    constexpr double pictures_per_block = 2.6e3;
    const BlockSystem& system = model.system;
    const auto n_fractures = std::ranges::count_if(
        system.interfaces, [&](const Interface& interface) { return model.bonds[law_of(interface)] == 0; });
    const double run =
        program + per_block * system.n_blocks() + per_fracture * static_cast<double>(n_fractures) + factor;
    return scene.output.pictures ? std::max(run, pictures + pictures_per_block * system.n_blocks()) : run;
}

void print_memory(const Scene& scene, const Model& model) {
    std::vector<std::pair<int, int>> pairs;
    for (const Interface& interface : model.system.interfaces) pairs.emplace_back(interface.block_a, interface.block_b);
    const FactorCost cost = factor_cost(BlockPattern(model.system.n_blocks(), pairs, model.kinematics));
    const bool unsymmetric_factors = scene.solver.tangent == Tangent::unsymmetric && !scene.solver.reuse;
    const double factor = (unsymmetric_factors ? 3.0 : 1.0) * cost.bytes;
    say("memory       about {:.3g} MB, of which the factor {:.3g} MB ({:.3g} flops by Cholesky's method)\n",
        1e-6 * estimated_memory(scene, model, factor), 1e-6 * factor, cost.flops);
}

/// A laterally loaded body under a platen is most often a cylinder.
bool looks_like_a_triaxial_test(const Scene& scene) {
    const bool platen = std::ranges::any_of(scene.loads.stages, [](const Stage& s) { return s.motion.has_value(); });
    const bool pressed = std::ranges::any_of(scene.loads.stages, [](const Stage& s) { return s.pressure.size() >= 2; });
    return platen && pressed;
}

} // namespace

ExitCode check(const CheckArguments& arguments) {
    const Scene scene = read_scene(arguments.scene, arguments.overrides);
    const SceneModel built = build_scene_model(scene);
    say("scene        {}{}\n", scene.name, scene.title.empty() ? "" : ": " + scene.title);
    print_blocks(scene, built);
    print_cut(built.cut);
    print_stiffness(scene, built.model);
    print_memory(scene, built.model);
    for (const Stage& stage : scene.loads.stages) say("stage        {}: {} steps\n", stage.name, stage.steps);
    for (const auto* warnings : {&scene.warnings, &built.model.warnings}) {
        for (const auto& warning : *warnings) say("warning: {}\n", warning);
    }
    if (looks_like_a_triaxial_test(scene)) {
        say("warning: a triaxial test is run in plane {}; a cylinder has the lateral pressure all around and no "
            "plane of the section is free of the others\n",
            scene.plane == Plane::strain ? "strain" : "stress");
    }
    return ExitCode::done;
}

} // namespace kluft

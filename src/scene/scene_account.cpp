#include "kluft/scene/scene_account.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kluft/assembly/block_matrix.hpp"
#include "kluft/assembly/linear_solver.hpp"
#include "kluft/constitutive/lattice_stiffness.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/core/units.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/boundary_geometry.hpp"

namespace kluft {

namespace {

using Lines = std::vector<SceneAccount::Line>;

void say_blocks(const Scene& scene, const SceneModel& built, Lines& lines) {
    const BlockSystem& system = built.model.system;
    const Vec2 extent = system.upper - system.lower;
    lines.push_back({"body", fmt::format("{:.6g} m x {:.6g} m, plane {}", extent.x(), extent.y(),
                                         scene.plane == Plane::strain ? "strain" : "stress")});
    lines.push_back({"blocks", fmt::format("{}", system.n_blocks())});
    lines.push_back({"unknowns", fmt::format("{}", unknowns_per_block(scene.kinematics) * system.n_blocks())});
    lines.push_back({"interfaces", fmt::format("{}", system.n_interfaces())});
    for (std::size_t t = 0; t < scene.interface_types.size(); ++t) {
        const auto count = std::ranges::count(system.interfaces, static_cast<int>(t), &Interface::interface_type);
        if (count == 0) continue;
        lines.push_back({{},
                         fmt::format("  {:<16} {:>7}  {}", scene.interface_types[t].name, count,
                                     built.model.bonds[t] ? "potential crack" : "fracture")});
    }
}

void say_cut(const CutReport& cut, const GeometrySpec& geometry, Lines& lines) {
    lines.push_back({"smallest", fmt::format("area {:.4g} m2, edge {:.4g} m, angle {:.4g} deg", cut.smallest_area,
                                             cut.smallest_edge, cut.smallest_angle * degrees)});
    lines.push_back({"mended", fmt::format("{} slivers merged, {} short edges collapsed, {} ends pruned",
                                           cut.merged.size(), cut.collapsed_edges, cut.pruned.size())});
    constexpr std::size_t most_listed = 10;
    for (std::size_t i = 0; i < std::min(most_listed, cut.merged.size()); ++i) {
        const CutReport::Merged& piece = cut.merged[i];
        std::string line = fmt::format("  merged {:.3g} m2 at {}", piece.area, place_text(piece.at));
        if (piece.fracture >= 0)
            line += fmt::format(", with {:.3g} m of {}", piece.length,
                                geometry.fractures[static_cast<std::size_t>(piece.fracture)].name);
        lines.push_back({{}, line});
    }
    if (cut.merged.size() > most_listed)
        lines.push_back({{}, fmt::format("  and {} more", cut.merged.size() - most_listed)});
    for (std::size_t i = 0; i < std::min(most_listed, cut.taken_off.size()); ++i)
        lines.push_back({{},
                         fmt::format("  taken off the surface {:.3g} m2 at {}, which would lock a fracture",
                                     cut.taken_off[i].area, place_text(cut.taken_off[i].at))});
    if (cut.taken_off.size() > most_listed)
        lines.push_back({{}, fmt::format("  and {} more", cut.taken_off.size() - most_listed)});
}

void say_stiffness(const Scene& scene, const Model& model, Lines& lines) {
    const double d = model.system.spacing;
    for (std::size_t t = 0; t < scene.interface_types.size(); ++t) {
        const auto& [normal, shear] = model.given_stiffness[t];
        lines.push_back({"stiffness", fmt::format("{}: k_n {:.4g} Pa/m, k_s {:.4g} Pa/m, k_n d/E {:.4g}",
                                                  scene.interface_types[t].name, normal, shear,
                                                  normal * d / scene.materials.front().youngs_modulus)});
    }
    for (std::size_t t = 0; t < model.laws.size(); ++t) {
        const InterfaceLaw& law = model.laws[t];
        if (t >= scene.interface_types.size() && model.net.kind == NetKind::triangles) break; // of other spacings
        if (law.normal_stiffness == model.given_stiffness[t].normal) continue;
        lines.push_back(
            {{},
             fmt::format("             {}{}: k_n {:.4g} Pa/m, k_s {:.4g} Pa/m with the compliance of the rigid blocks",
                         scene.interface_types[model.law_types[t]].name,
                         t < scene.interface_types.size() ? "" : " of a broken hexagon edge", law.normal_stiffness,
                         law.shear_stiffness)});
    }
    if (!scene.geometry.tessellation) return;
    const InterfaceLaw& net = model.laws[scene.geometry.tessellation->interface_type];
    for (std::size_t m = 0; m < model.moduli.size(); ++m) {
        const InterfaceStiffness stiffness{.normal = net.normal_stiffness, .shear = net.shear_stiffness};
        const auto lattice = model.kinematics == Kinematics::rigid
                                 ? rigid_lattice_moduli(stiffness, model.net, model.plane)
                                 : lattice_moduli(model.moduli[m], stiffness, model.net, model.plane);
        const std::string& name = scene.materials[m].name;
        lines.push_back(
            {"lattice",
             lattice.poissons_ratio > -1.0
                 ? fmt::format("{}: E {:.4g} Pa, nu {:.4g}", name, lattice.youngs_modulus, lattice.poissons_ratio)
                 : fmt::format(
                       "{}: K {:.4g} Pa, G {:.4g} Pa in the plane, as of no isotropic material: k_s is far above k_n",
                       name, lattice.bulk_modulus, lattice.shear_modulus)});
    }
}

std::string_view support_text(Support support) {
    switch (support) {
    case Support::none:
        return "none";
    case Support::smooth:
        return "smooth";
    case Support::pinned:
        return "pinned";
    case Support::fixed:
        return "fixed";
    }
    return "";
}

/// Where the sides of a boundary lie, in coordinates of the scene (m).
Box extent_of(const BlockSystem& system, const Boundary& boundary) {
    std::vector<Vec2> ends;
    for (const auto& [block, e] : boundary.edges) {
        const Edge& edge = system.blocks[block].edges[e];
        ends.insert(ends.end(), {system.origin + edge_start(system, edge), system.origin + edge_end(system, edge)});
    }
    return ends.empty() ? Box{} : bounding_box(ends);
}

void say_boundaries(const Model& model, Lines& lines) {
    constexpr int most_listed = 12;
    const BlockSystem& system = model.system;
    const auto n = static_cast<int>(system.boundaries.size());
    for (int i = 0; i < std::min(n, most_listed); ++i) {
        const BoundaryFrame frame = boundary_frame(system, i);
        const Vec2 normal = frame.normal + Vec2::Zero(); // no -0
        const Box extent = extent_of(system, system.boundaries[i]);
        const std::string facing =
            frame.normal.isZero() ? "all around" : fmt::format("facing ({:.3g}, {:.3g})", normal.x(), normal.y());
        lines.push_back(
            {"boundary", fmt::format("{}: {:.4g} m {}, between {} and {}, support {}", system.boundaries[i].name,
                                     frame.length, facing, place_text(extent.lower), place_text(extent.upper),
                                     support_text(model.loads.supports[i]))});
    }
    if (n > most_listed) lines.push_back({{}, fmt::format("  and {} more boundaries", n - most_listed)});
}

std::string stage_text(const Stage& stage, const BlockSystem& system) {
    std::string text = fmt::format("{}: {} steps", stage.name, stage.steps);
    if (!stage.motion) return text;
    const int rest = resting_boundary(system, *stage.motion);
    return text + fmt::format("; a platen on '{}'{}", system.boundaries[stage.motion->boundary].name,
                              rest < 0 ? std::string()
                                       : fmt::format(", '{}' rests on a fixed one", system.boundaries[rest].name));
}

/// What a run takes beside the program, the factor and the fractures (bytes), fitted to measured runs.
struct MemoryOfBlocks {
    double run = 0.0;      ///< until the factor is gone
    double pictures = 0.0; ///< with the blocks, when they are drawn
};

MemoryOfBlocks memory_of_affine_blocks(double n_blocks) {
    constexpr double per_block = 7.4e3;
    constexpr double pictures_per_block = 2.6e3;
    return {.run = per_block * n_blocks, .pictures = pictures_per_block * n_blocks};
}

/// Blocks of the matrix have a quarter of the entries of affine ones, vectors half of them. Contacts that open, close or
/// slide make the linear systems take vectors (Krylov's), which whole bodies do not need.
MemoryOfBlocks memory_of_rigid_blocks(double n_blocks, bool has_fractures) {
    constexpr double per_block = 4.2e3;
    constexpr double vectors_per_block = 1.7e3;
    constexpr double more_per_block = 4.3e3; // of small bodies
    constexpr double most_more = 12e6;
    constexpr double pictures_per_block = 5.0e3;
    return {.run = (per_block + (has_fractures ? vectors_per_block : 0.0)) * n_blocks +
                   std::min(more_per_block * n_blocks, most_more),
            .pictures = pictures_per_block * n_blocks};
}

/// Largest memory of a run with a factor that takes so many bytes, fitted to measured ones: "Memory" in docs/theory.md.
double estimated_memory(const Scene& scene, const Model& model, double factor) {
    constexpr double program = 28e6;
    constexpr double per_fracture = 2.2e3; // interface that is no bond
    constexpr double pictures = 48e6;      // with the program; they are drawn when the factor is gone
    const BlockSystem& system = model.system;
    const auto n_fractures = std::ranges::count_if(
        system.interfaces, [&](const Interface& interface) { return model.bonds[law_of(interface)] == 0; });
    const MemoryOfBlocks blocks = scene.kinematics == Kinematics::rigid
                                      ? memory_of_rigid_blocks(system.n_blocks(), n_fractures > 0)
                                      : memory_of_affine_blocks(system.n_blocks());
    const double run = program + blocks.run + per_fracture * static_cast<double>(n_fractures) + factor;
    return scene.output.pictures ? std::max(run, pictures + blocks.pictures) : run;
}

/// The one that takes most memory.
Factorization largest_factorization(const Scene& scene, const Model& model) {
    if (!scene.solver.reuse) return Factorization::cholesky;
    const bool slides = std::ranges::any_of(
        model.system.interfaces, [&](const Interface& interface) { return model.bonds[law_of(interface)] == 0; });
    return slides && scene.solver.tangent == Tangent::unsymmetric ? Factorization::rounded_lu
                                                                  : Factorization::rounded_cholesky;
}

double say_memory(const Scene& scene, const Model& model, Lines& lines) {
    std::vector<std::pair<int, int>> pairs;
    for (const Interface& interface : model.system.interfaces) pairs.emplace_back(interface.block_a, interface.block_b);
    const FactorCost cost = factor_cost(BlockPattern(model.system.n_blocks(), pairs, model.kinematics),
                                        largest_factorization(scene, model));
    const bool unsymmetric_factors = scene.solver.tangent == Tangent::unsymmetric && !scene.solver.reuse;
    const double factor = (unsymmetric_factors ? 3.0 : 1.0) * cost.bytes;
    const double memory = estimated_memory(scene, model, factor + cost.working_bytes);
    lines.push_back(
        {"memory", fmt::format("about {:.3g} MB, of which the factor {:.3g} MB ({:.3g} flops by Cholesky's method){}",
                               1e-6 * memory, 1e-6 * factor, cost.flops,
                               model.has_potential_cracks ? "; up to twice as much where many bonds fail" : "")});
    return memory;
}

/// A laterally loaded body under a platen is most often a cylinder.
bool looks_like_a_triaxial_test(const Scene& scene) {
    const bool platen = std::ranges::any_of(scene.loads.stages, [](const Stage& s) { return s.motion.has_value(); });
    const bool pressed = std::ranges::any_of(scene.loads.stages, [](const Stage& s) { return s.pressure.size() >= 2; });
    return platen && pressed;
}

/// The first stage in which a bonded body breaks under a platen with nothing at its sides, and is then followed to the end;
/// -1 without one.
int stage_of_loose_pieces(const Scene& scene, const Model& model) {
    if (!model.has_potential_cracks) return -1;
    for (std::size_t s = 0; s < scene.loads.stages.size(); ++s) {
        const Stage& stage = scene.loads.stages[s];
        const auto presses = [](const auto& pressure) { return pressure.second > 0.0; };
        if (std::ranges::any_of(stage.pressure, presses)) return -1;
        if (stage.motion && stage.motion->value > 0.0 && !stage.stop_after_drop) return static_cast<int>(s);
    }
    return -1;
}

} // namespace

SceneAccount account_of(const Scene& scene, const SceneModel& built) {
    SceneAccount account;
    Lines& lines = account.lines;
    account.blocks = built.model.system.n_blocks();
    account.interfaces = built.model.system.n_interfaces();
    account.unknowns = unknowns_per_block(scene.kinematics) * account.blocks;
    account.smallest_area = built.cut.smallest_area;
    account.smallest_edge = built.cut.smallest_edge;
    account.smallest_angle = built.cut.smallest_angle;
    account.merged = static_cast<int>(built.cut.merged.size());
    lines.push_back({"scene", scene.name + (scene.title.empty() ? "" : ": " + scene.title)});
    say_blocks(scene, built, lines);
    say_cut(built.cut, scene.geometry, lines);
    say_boundaries(built.model, lines);
    say_stiffness(scene, built.model, lines);
    account.memory_bytes = say_memory(scene, built.model, lines);
    for (const Stage& stage : scene.loads.stages) lines.push_back({"stage", stage_text(stage, built.model.system)});
    account.warnings = scene.warnings;
    account.warnings.insert(account.warnings.end(), built.model.warnings.begin(), built.model.warnings.end());
    if (looks_like_a_triaxial_test(scene)) {
        lines.push_back(
            {"note", fmt::format("a triaxial test is run in plane {}; a cylinder has the lateral pressure all "
                                 "around and no plane of the section is free of the others",
                                 scene.plane == Plane::strain ? "strain" : "stress")});
    }
    if (const int stage = stage_of_loose_pieces(scene, built.model); stage >= 0) {
        lines.push_back(
            {"note",
             fmt::format("what breaks without lateral pressure comes loose, and to follow the pieces takes most of "
                         "the time of a run; stages.{}.stop_after_drop: 80 % ends it behind the peak",
                         stage)});
    }
    return account;
}

std::string text_of(const SceneAccount& account) {
    std::string text;
    for (const auto& [name, line] : account.lines)
        text += name.empty() ? fmt::format("{}\n", line) : fmt::format("{:<13}{}\n", name, line);
    for (const std::string& warning : account.warnings) text += fmt::format("warning: {}\n", warning);
    return text;
}

std::string json_of(const SceneAccount& account, const Scene& scene, const SceneModel& built) {
    using Json = nlohmann::ordered_json;
    Json json{{"scene", scene.name},
              {"title", scene.title},
              {"plane", scene.plane == Plane::strain ? "strain" : "stress"},
              {"kinematics", scene.kinematics == Kinematics::affine ? "affine" : "rigid"},
              {"blocks", account.blocks},
              {"interfaces", account.interfaces},
              {"unknowns", account.unknowns},
              {"smallest_area", account.smallest_area},
              {"smallest_edge", account.smallest_edge},
              {"smallest_angle", account.smallest_angle * degrees},
              {"merged", Json::array()},
              {"taken_off", Json::array()},
              {"boundaries", Json::array()},
              {"interface_types", Json::array()},
              {"stages", Json::array()},
              {"memory_bytes", account.memory_bytes},
              {"warnings", account.warnings}};
    for (const auto& sliver : built.cut.merged)
        json["merged"].push_back({{"area", sliver.area}, {"x", sliver.at.x()}, {"y", sliver.at.y()}});
    for (const auto& piece : built.cut.taken_off)
        json["taken_off"].push_back({{"area", piece.area}, {"x", piece.at.x()}, {"y", piece.at.y()}});
    const Model& model = built.model;
    for (std::size_t i = 0; i < model.system.boundaries.size(); ++i) {
        const BoundaryFrame frame = boundary_frame(model.system, static_cast<int>(i));
        const Box extent = extent_of(model.system, model.system.boundaries[i]);
        json["boundaries"].push_back({{"name", model.system.boundaries[i].name},
                                      {"length", frame.length},
                                      {"normal", {frame.normal.x() + 0.0, frame.normal.y() + 0.0}}, // no -0
                                      {"lower", {extent.lower.x(), extent.lower.y()}},
                                      {"upper", {extent.upper.x(), extent.upper.y()}},
                                      {"support", support_text(model.loads.supports[i])}});
    }
    for (std::size_t t = 0; t < scene.interface_types.size(); ++t)
        json["interface_types"].push_back(
            {{"name", scene.interface_types[t].name},
             {"kind", model.bonds[t] ? "potential_crack" : "fracture"},
             {"count", std::ranges::count(model.system.interfaces, static_cast<int>(t), &Interface::interface_type)},
             {"normal_stiffness", model.given_stiffness[t].normal},
             {"shear_stiffness", model.given_stiffness[t].shear}});
    for (const Stage& stage : scene.loads.stages)
        json["stages"].push_back({{"name", stage.name}, {"steps", stage.steps}});
    return json.dump(2) + "\n";
}

} // namespace kluft

#include "kluft/simulation/stage_loads.hpp"

#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

constexpr int no_boundary = -1; ///< of the prescribed displacements of a fixed block

/// The gravity at the end of a stage; -1: before the first one.
Vec2 gravity_after(const Model& model, int stage) {
    for (int s = stage; s >= 0; --s)
        if (model.loads.stages[s].gravity) return *model.loads.stages[s].gravity;
    return stage < 0 ? Vec2(Vec2::Zero()) : model.gravity;
}

/// A point force at the end of a stage.
Vec2 force_after(const Model& model, int force, int stage) {
    for (int s = stage; s >= 0; --s) {
        const auto& forces = model.loads.stages[s].forces;
        if (const auto found = forces.find(force); found != forces.end()) return found->second;
    }
    return Vec2::Zero();
}

Vec2 between(const Vec2& start, const Vec2& end, double load_factor) {
    return start == end ? end : Vec2(start + load_factor * (end - start));
}

/// (block, vertex) on a boundary nearest to its middle.
std::optional<std::pair<int, int>> middle_vertex(const BlockSystem& system, int boundary) {
    const Vec2 middle = mean_position(system, boundary);
    std::optional<std::pair<int, int>> nearest;
    double least = 0.0;
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        const Edge& edge = system.blocks[b].edges[e];
        for (const int vertex : {edge.start, edge.end}) {
            const double distance = (system.vertices[vertex] - middle).norm();
            if (nearest && distance >= least) continue;
            nearest = std::pair(b, vertex);
            least = distance;
        }
    }
    return nearest;
}

/// The platen that a stage moves, and what all boundaries are held by meanwhile.
struct MovedPlaten {
    std::vector<Support> supports;    ///< one per boundary
    int boundary = -1;                ///< -1 without one
    Vec2 velocity = Vec2::Zero();     ///< per unit of load factor (m), or per unit of a travel that is unknown
    std::optional<PlatenForce> force; ///< of a platen under stress
    [[nodiscard]] Vec2 velocity_of(int i) const { return i == boundary ? velocity : Vec2(Vec2::Zero()); }
};

MovedPlaten platen_of(const Model& model, const Stage& stage) {
    MovedPlaten platen;
    platen.supports = model.loads.supports;
    if (!stage.motion) return platen;
    const BlockSystem& system = model.system;
    const int moved = platen.boundary = stage.motion->boundary;
    const int fixed = opposite_boundary(system, moved);
    const Support kind = stage.platens == Platens::rough ? Support::fixed : Support::smooth;
    platen.supports[moved] = kind;
    if (fixed >= 0 && kind == Support::fixed) platen.supports[fixed] = Support::fixed;
    if (fixed >= 0 && platen.supports[fixed] == Support::none) platen.supports[fixed] = Support::pinned;
    const Vec2 inward = -boundary_frame(system, moved).normal;
    double distance = stage.motion->value;
    if (stage.motion->control == PlatenControl::strain) distance *= distance_across(system, moved);
    platen.velocity = distance * inward;
    if (stage.motion->control == PlatenControl::stress) {
        platen.velocity = inward;
        platen.force = width_across(system, moved);
    }
    return platen;
}

/// Prescribed displacements with their targets at load factor 0 and the rates of these per unit of load factor.
struct PrescribedRows {
    std::vector<PrescribedDisplacement> rows;
    std::vector<double> start_targets; ///< m
    std::vector<double> target_rates;  ///< m

    void add(const PrescribedDisplacement& row, double rate) {
        rows.push_back(row);
        start_targets.push_back(row.target);
        target_rates.push_back(rate);
    }
};

/// A vertex of a held boundary follows its support: along the normal, and along the boundary too if it `sticks`.
void add_vertex(const MovedPlaten& platen, int boundary, int block, const Vec2& xi, const Vec2& start,
                const Vec2& normal, bool sticks, PrescribedRows& prescribed) {
    const auto prescribe = [&](const Vec2& direction) {
        const double rate = direction.dot(platen.velocity_of(boundary));
        prescribed.add({block, xi, direction, boundary, direction.dot(start), platen.force ? rate : 0.0},
                       platen.force ? 0.0 : rate);
    };
    prescribe(normal);
    if (sticks) prescribe(Vec2(-normal.y(), normal.x()));
}

/// The rows of the support of one boundary, each vertex of a block once.
void add_support(const BlockSystem& system, const MovedPlaten& platen, int boundary, const Eigen::VectorXd& start,
                 PrescribedRows& prescribed) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const Support support = platen.supports[boundary];
    const auto pin = support == Support::pinned ? middle_vertex(system, boundary) : std::nullopt;
    std::set<std::pair<int, int>> done; // (block, vertex)
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        if (system.blocks[b].fixed) continue;
        const Edge& edge = system.blocks[b].edges[e];
        for (const int vertex : {edge.start, edge.end}) {
            if (!done.emplace(b, vertex).second) continue;
            const Vec2 xi = block_coordinates(system.blocks[b], system.vertices[vertex]);
            const bool sticks = support == Support::fixed || pin == std::pair(b, vertex);
            add_vertex(platen, boundary, b, xi, displacement_at(start, b, xi), normal, sticks, prescribed);
        }
    }
}

/// Three points of a fixed block do not move.
void add_fixed_blocks(const BlockSystem& system, PrescribedRows& prescribed) {
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (!system.blocks[b].fixed) continue;
        for (const Vec2& xi : {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)}) {
            for (const Vec2& direction : {Vec2(1.0, 0.0), Vec2(0.0, 1.0)})
                prescribed.add({b, xi, direction, no_boundary}, 0.0);
        }
    }
}

} // namespace

StageLoads::StageLoads(const Model& model, const StageStart& start, const Stage& stage)
    : start_pressure_(start.boundary_pressure), end_pressure_(start.boundary_pressure) {
    const BlockSystem& system = model.system;
    const int n = static_cast<int>(system.boundaries.size());
    for (const auto& [boundary, pressure] : stage.pressure) end_pressure_[boundary] = pressure;
    const MovedPlaten platen = platen_of(model, stage);
    platen_force_ = platen.force;
    if (platen_force_) {
        start_platen_stress_ = start_pressure_[platen.boundary];
        end_platen_stress_ = stage.motion->value;
    }

    PrescribedRows prescribed;
    held_.assign(n, 0);
    for (int boundary = 0; boundary < n; ++boundary) {
        if (platen.supports[boundary] == Support::none) continue;
        held_[boundary] = 1;
        start_pressure_[boundary] = end_pressure_[boundary] = 0.0;
        add_support(system, platen, boundary, start.displacement, prescribed);
    }
    add_fixed_blocks(system, prescribed);
    start_targets_ = std::move(prescribed.start_targets);
    target_rates_ = std::move(prescribed.target_rates);
    constraints_ = model.kinematics == Kinematics::rigid
                       ? Constraints(std::move(prescribed.rows), system, start.displacement)
                       : Constraints(std::move(prescribed.rows));
    for (int boundary = 0; boundary < n; ++boundary) {
        if (start_pressure_[boundary] == 0.0 && end_pressure_[boundary] == 0.0) continue;
        const auto more = pressure_edges(system, boundary);
        edges_.insert(edges_.end(), more.begin(), more.end());
    }
}

std::vector<double> StageLoads::pressures(double load_factor) const {
    std::vector<double> result(start_pressure_.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = start_pressure_[i] + load_factor * (end_pressure_[i] - start_pressure_[i]);
    }
    return result;
}

std::optional<PlatenForce> StageLoads::platen_force(double load_factor) const {
    auto force = platen_force_;
    if (force) force->stress = start_platen_stress_ + load_factor * (end_platen_stress_ - start_platen_stress_);
    return force;
}

void StageLoads::set_targets(Constraints& constraints, double load_factor) const {
    for (std::size_t i = 0; i < start_targets_.size(); ++i) {
        constraints.set_target(static_cast<int>(i), start_targets_[i] + load_factor * target_rates_[i]);
    }
}

const PrescribedDisplacement* StageLoads::contradicting_row() const {
    std::vector<double> rates = target_rates_;
    const auto& rows = constraints_.rows();
    for (std::size_t i = 0; i < rates.size(); ++i) rates[i] += rows[i].rate;
    const int row = constraints_.contradicting_row(rates);
    return row < 0 ? nullptr : &rows[row];
}

void refuse_contradicting_supports(const Model& model) {
    const BlockSystem& system = model.system;
    const StageStart rest{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * system.n_blocks()),
                          std::vector<double>(system.boundaries.size(), 0.0)};
    for (const Stage& stage : model.loads.stages) {
        if (!stage.motion) continue;
        const StageLoads loads(model, rest, stage);
        const PrescribedDisplacement* row = loads.contradicting_row();
        if (row == nullptr) continue;
        const int moved = stage.motion->boundary;
        std::string holding;
        for (const auto& other : loads.constraints().rows()) {
            if (other.block == row->block && other.boundary != moved && other.boundary != no_boundary)
                holding = system.boundaries[other.boundary].name;
        }
        const Vec2 at = system.origin + system.blocks[row->block].centroid;
        throw InputError(fmt::format(
            "boundaries.{}.support: expected one that leaves the block {} at ({:.6g}, {:.6g}) "
            "free to follow the platen on '{}' in {}, as smooth sides do; found one that holds "
            "it",
            holding, block_label(system, row->block), at.x(), at.y(), system.boundaries[moved].name, stage.name));
    }
}

LoadsAt loads_at(const Model& model, const StageLoads& stage_loads, int stage, double load_factor) {
    LoadsAt at;
    at.loads.constraints = stage_loads.constraints();
    at.loads.pressure_edges = stage_loads.edges();
    move_loads(model, stage_loads, stage, load_factor, at.loads);
    at.load_factor = load_factor;
    at.strength_factor = strength_factor(model.loads, stage, load_factor);
    at.laws = reduced_laws(model, stage, at.strength_factor);
    return at;
}

void move_loads(const Model& model, const StageLoads& stage_loads, int stage, double load_factor, Loads& loads) {
    loads.pressures = stage_loads.pressures(load_factor);
    loads.platen_force = stage_loads.platen_force(load_factor);
    stage_loads.set_targets(loads.constraints, load_factor);
    loads.gravity = between(gravity_after(model, stage - 1), gravity_after(model, stage), load_factor);
    loads.point_loads.clear();
    for (int i = 0; i < static_cast<int>(model.force_points.size()); ++i) {
        const auto [block, xi] = model.force_points[i];
        const Vec2 force = between(force_after(model, i, stage - 1), force_after(model, i, stage), load_factor);
        if (force != Vec2::Zero()) loads.point_loads.push_back({block, xi, force});
    }
}

StageLoads enter_stage(const Model& model, State& state) {
    const Stage& stage = model.loads.stages[state.at.stage];
    if (state.at.is_at_stage_start()) {
        state.stage_start.displacement = state.body.displacement;
        if (stage.motion && state.strain_zero.size() == 0) state.strain_zero = state.body.displacement;
    }
    return {model, state.stage_start, stage};
}

void leave_stage(const Model& model, const StageLoads& stage_loads, const Loads& loads, const Eigen::VectorXd& forces,
                 State& state) {
    std::vector<double> end = stage_loads.pressures(1.0);
    for (int i = 0; i < static_cast<int>(end.size()); ++i) {
        const auto frame = boundary_frame(model.system, i);
        if (stage_loads.is_held(i)) end[i] = boundary_stress(loads, forces, i, true, frame.length, frame.normal);
    }
    state.stage_start.boundary_pressure = std::move(end); // from here on nothing throws
    ++state.at.stage;
    state.at.step_in_stage = 0;
    state.at.load_factor = 0.0;
}

double boundary_stress(const Loads& loads, const Eigen::VectorXd& forces, int boundary, bool held,
                       double current_length, const Vec2& normal) {
    if (!held) return loads.pressures[boundary];
    return -normal.dot(loads.constraints.reaction(forces, boundary)) / current_length;
}

} // namespace kluft

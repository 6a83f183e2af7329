#include "kluft/simulation/stage_loads.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/core/place_text.hpp"
#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/boundary_geometry.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

constexpr double holds_along = 0.5; ///< cosine between a row and a direction in which it counts as holding the body
constexpr int no_boundary = -1;     ///< of the prescribed displacements of a fixed block

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

double friction_of(const Support support, double of_platens) {
    return support == Support::fixed ? std::numeric_limits<double>::infinity() : of_platens;
}

/// The platen that a stage moves and the one opposite to it, which a support may make rough.
std::vector<Platen> platens_of(const Model& model, const Stage& stage) {
    if (!stage.motion) return {};
    const BlockSystem& system = model.system;
    const int boundary = stage.motion->boundary;
    Platen moved{.boundary = boundary,
                 .normal = boundary_frame(system, boundary).normal,
                 .tan_friction = stage.platen_friction,
                 .glued = stage.motion->glued};
    double distance = stage.motion->value;
    if (stage.motion->control == PlatenControl::strain) distance *= distance_across(system, boundary);
    const bool by_stress = stage.motion->control == PlatenControl::stress;
    (by_stress ? moved.rate : moved.velocity) = by_stress ? -1.0 : -distance;
    const int opposite = resting_boundary(system, *stage.motion);
    if (opposite < 0) return {moved};
    const Platen fixed{.boundary = opposite,
                       .normal = boundary_frame(system, opposite).normal,
                       .tan_friction = friction_of(model.loads.supports[opposite], stage.platen_friction),
                       .glued = stage.motion->glued};
    return {moved, fixed};
}

/// A vertex that does not move along a direction.
PrescribedDisplacement held(const BlockSystem& system, int boundary, int block, int vertex, const Vec2& direction,
                            const Eigen::VectorXd& start) {
    PrescribedDisplacement row{block, block_coordinates(system.blocks[block], system.vertices[vertex]), direction,
                               boundary};
    row.start = row.target = direction.dot(displacement_at(start, block, row.xi));
    return row;
}

/// The rows of the support of one boundary, each vertex of a block once.
void add_support(const BlockSystem& system, Support support, int boundary, const Eigen::VectorXd& start,
                 std::vector<PrescribedDisplacement>& rows) {
    const Vec2 mean_normal = boundary_frame(system, boundary).normal;
    const Vec2 normal = mean_normal.isZero() ? Vec2::UnitX() : mean_normal; // fixed ones alone may face all ways
    const Vec2 tangent(-normal.y(), normal.x());
    const auto pin = support == Support::pinned ? middle_vertex(system, boundary) : std::nullopt;
    std::set<std::pair<int, int>> done; // (block, vertex)
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        if (system.blocks[b].fixed) continue;
        const Edge& edge = system.blocks[b].edges[e];
        for (const int vertex : {edge.start, edge.end}) {
            if (!done.emplace(b, vertex).second) continue;
            rows.push_back(held(system, boundary, b, vertex, normal, start));
            const bool sticks = support == Support::fixed || pin == std::pair(b, vertex);
            if (sticks) rows.push_back(held(system, boundary, b, vertex, tangent, start));
        }
    }
}

/// On smooth platens the body would drift: a vertex near the middle of the fixed one does not move along it, unless another row holds
/// the body there, or the scene says that the boundary has a smooth support.
void add_pin(const Model& model, const Platen& platen, const Eigen::VectorXd& start,
             std::vector<PrescribedDisplacement>& rows) {
    const Support support = model.loads.supports[platen.boundary];
    if (platen.tan_friction > 0.0 || support == Support::smooth) return;
    const auto holds = [&](const PrescribedDisplacement& row) {
        return std::abs(row.direction.dot(platen.tangent())) > holds_along;
    };
    if (std::ranges::any_of(rows, holds)) return;
    const auto pin = middle_vertex(model.system, platen.boundary);
    if (pin) rows.push_back(held(model.system, platen.boundary, pin->first, pin->second, platen.tangent(), start));
}

/// Three points of a fixed block do not move.
void add_fixed_blocks(const BlockSystem& system, std::vector<PrescribedDisplacement>& rows) {
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (!system.blocks[b].fixed) continue;
        for (const Vec2& xi : {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)}) {
            for (const Vec2& direction : {Vec2(1.0, 0.0), Vec2(0.0, 1.0)})
                rows.push_back({b, xi, direction, no_boundary});
        }
    }
}

/// Platens that are there already keep their points; those of others are gone.
void lay_platens(const StageLoads& loads, std::vector<PlatenPoint>& points) {
    const auto is_present = [](const auto& platens, int boundary) {
        return std::ranges::any_of(platens, [&](const auto& each) { return each.boundary == boundary; });
    };
    std::erase_if(points, [&](const PlatenPoint& point) { return !is_present(loads.platens(), point.boundary); });
    const std::vector<PlatenPoint> before = points;
    std::ranges::copy_if(loads.platen_points(), std::back_inserter(points),
                         [&](const PlatenPoint& point) { return !is_present(before, point.boundary); });
}

Constraints constraints_of(const Model& model, std::vector<PrescribedDisplacement> rows, const StageStart& start) {
    return model.kinematics == Kinematics::rigid ? Constraints(std::move(rows), model.system, start.displacement)
                                                 : Constraints(std::move(rows));
}

} // namespace

StageStart start_at_rest(const BlockSystem& system) {
    return {Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * system.n_blocks()),
            std::vector<double>(system.boundaries.size(), 0.0)};
}

StageLoads::StageLoads(const Model& model, const StageStart& start, const Stage& stage)
    : start_pressure_(start.boundary_pressure), end_pressure_(start.boundary_pressure) {
    const BlockSystem& system = model.system;
    const int n = static_cast<int>(system.boundaries.size());
    for (const auto& [boundary, pressure] : stage.pressure) end_pressure_[boundary] = pressure;
    if (is_platen_loaded_by_stress(stage)) {
        const int moved = stage.motion->boundary;
        platen_force_ = width_across(system, moved);
        start_platen_stress_ = start_pressure_[moved] * pressed_length(system, moved) / platen_force_->width;
        end_platen_stress_ = stage.motion->value;
    }
    platens_ = platens_of(model, stage);
    std::vector<PrescribedDisplacement> rows;
    held_.assign(n, 0);
    for (int boundary = 0; boundary < n; ++boundary) {
        const auto platen = std::ranges::find(platens_, boundary, &Platen::boundary);
        const Support support = model.loads.supports[boundary];
        if (platen == platens_.end() && support == Support::none) continue;
        held_[boundary] = 1;
        start_pressure_[boundary] = end_pressure_[boundary] = 0.0;
        if (platen == platens_.end()) {
            add_support(system, support, boundary, start.displacement, rows);
            continue;
        }
        for (const PlatenPoint& point : laid_points(system, *platen, start.displacement)) {
            append_rows(system, *platen, point, static_cast<int>(platen_points_.size()), rows);
            platen_points_.push_back(point);
        }
    }
    place_platens(system, platen_points_);
    add_fixed_blocks(system, rows);
    for (std::size_t i = 1; i < platens_.size(); ++i) add_pin(model, platens_[i], start.displacement, rows);
    constraints_ = constraints_of(model, std::move(rows), start);
    for (int boundary = 0; boundary < n; ++boundary) {
        if (start_pressure_[boundary] == 0.0 && end_pressure_[boundary] == 0.0) continue;
        const auto more = pressure_edges(system, boundary);
        edges_.insert(edges_.end(), more.begin(), more.end());
    }
}

void StageLoads::place_platens(const BlockSystem& system, const std::vector<PlatenPoint>& points) {
    for (Platen& platen : platens_) platen.face = face_of(system, platen, points);
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

const PrescribedDisplacement* StageLoads::contradicting_row() const {
    const int row = constraints_.contradicting_row();
    return row < 0 ? nullptr : &constraints_.rows()[row];
}

namespace {

/// Whether the rows could be met without those of a boundary.
bool agree_without(int boundary, const Model& model, std::vector<PrescribedDisplacement> rows, const StageStart& rest) {
    std::erase_if(rows, [&](const PrescribedDisplacement& row) { return row.boundary == boundary; });
    return constraints_of(model, std::move(rows), rest).contradicting_row() < 0;
}

std::string shared_block_message(const Model& model, const Stage& stage, int opposite, int block) {
    const BlockSystem& system = model.system;
    const Vec2 at = system.origin + system.blocks[block].centroid;
    return fmt::format(
        "{}: expected a boundary that shares no block with '{}', which rests on the fixed platen opposite to it; found "
        "'{}' in {}, and the block {} at {} on both, which cannot follow the one and stay on the other",
        stage.motion->place.empty() ? stage.name : stage.motion->place, system.boundaries[opposite].name,
        system.boundaries[stage.motion->boundary].name, stage.name, block_label(system, block), place_text(at));
}

} // namespace

void refuse_contradicting_supports(const Model& model) {
    const BlockSystem& system = model.system;
    const StageStart rest = start_at_rest(system);
    for (const Stage& stage : model.loads.stages) {
        if (!stage.motion) continue;
        const StageLoads loads(model, rest, stage);
        const PrescribedDisplacement* row = loads.contradicting_row();
        if (row == nullptr) continue;
        const int moved = stage.motion->boundary;
        const int opposite = resting_boundary(system, *stage.motion);
        if (opposite >= 0 && agree_without(opposite, model, loads.constraints().rows(), rest))
            throw InputError(shared_block_message(model, stage, opposite, row->block));
        std::string holding;
        for (const auto& other : loads.constraints().rows()) {
            if (other.block == row->block && other.boundary != moved && other.boundary != no_boundary)
                holding = system.boundaries[other.boundary].name;
        }
        const Vec2 at = system.origin + system.blocks[row->block].centroid;
        throw InputError(fmt::format(
            "boundaries.{}.support: expected one that leaves the block {} at {} "
            "free to follow the platen on '{}' in {}, as smooth sides do; found one that holds "
            "it",
            holding, block_label(system, row->block), place_text(at), system.boundaries[moved].name, stage.name));
    }
}

LoadsAt loads_at(const Model& model, const StageLoads& stage_loads, const PlatenHold& hold, int stage,
                 double load_factor) {
    LoadsAt at;
    at.loads.constraints = hold.constraints;
    at.loads.platen_points = hold.points;
    at.loads.friction = hold.friction;
    at.loads.platens = stage_loads.platens();
    at.loads.pressure_edges = stage_loads.edges();
    move_loads(model, stage_loads, stage, load_factor, at.loads);
    at.load_factor = load_factor;
    at.strength_factor = strength_factor(model.loads, stage, load_factor);
    at.laws = reduced_laws(model, stage, at.strength_factor);
    return at;
}

bool has_given_loads(const Model& model, const Loads& loads) {
    return has_gravity(model) || loads.platen_force.has_value() || !loads.point_loads.empty() ||
           std::ranges::any_of(loads.pressures, [](double pressure) { return pressure != 0.0; });
}

void move_loads(const Model& model, const StageLoads& stage_loads, int stage, double load_factor, Loads& loads) {
    loads.pressures = stage_loads.pressures(load_factor);
    loads.platen_force = stage_loads.platen_force(load_factor);
    loads.constraints.move_to(load_factor);
    for (Platen& platen : loads.platens) platen.moved = load_factor * platen.velocity;
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
    StageLoads loads(model, state.stage_start, stage);
    if (state.at.is_at_stage_start()) {
        lay_platens(loads, state.body.platen_points);
        for (const Platen& platen : loads.platens())
            meet_anew(model.system, platen, state.body.displacement, state.body.platen_points);
    }
    loads.place_platens(model.system, state.body.platen_points);
    return loads;
}

PlatenHold hold_of(const Model& model, const StageLoads& stage_loads, const BodyState& state) {
    if (state.platen_points == stage_loads.platen_points())
        return {stage_loads.platen_points(), stage_loads.constraints(), {}};
    Loads loads;
    loads.constraints = stage_loads.constraints();
    loads.platens = stage_loads.platens();
    loads.platen_points = state.platen_points;
    LoadedBody body;
    body.kinematics = model.kinematics;
    body.system = &model.system;
    hold_by_platens(body, state.displacement, loads);
    return {std::move(loads.platen_points), std::move(loads.constraints), std::move(loads.friction)};
}

void leave_stage(const Model& model, const StageLoads& stage_loads, const Loads& loads, State& state) {
    std::vector<double> end = stage_loads.pressures(1.0);
    for (int i = 0; i < static_cast<int>(end.size()); ++i) {
        if (!stage_loads.is_held(i)) continue;
        PlatenForce of_unit_pressure = width_across(model.system, i);
        of_unit_pressure.stress = pressed_length(model.system, i) / of_unit_pressure.width;
        const double force = of_unit_pressure.at(state.body.displacement);
        end[i] = force > 0.0 ? state.body.holding_forces[i] / force : 0.0;
    }
    state.stage_start.boundary_pressure = std::move(end); // from here on nothing throws
    const double travel = platen_travel(loads, state.body.displacement);
    for (PlatenPoint& point : state.body.platen_points) {
        const auto platen = std::ranges::find(loads.platens, point.boundary, &Platen::boundary);
        point.reach += platen->moved + platen->rate * travel;
    }
    ++state.at.stage;
    state.at.step_in_stage = 0;
    state.at.load_factor = 0.0;
    state.stresses.largest_in_stage = 0.0;
}

std::vector<double> holding_forces(const Model& model, const StageLoads& stage_loads, const Loads& loads,
                                   const Eigen::VectorXd& forces) {
    std::vector<double> holding(model.system.boundaries.size(), 0.0);
    for (int i = 0; i < static_cast<int>(holding.size()); ++i)
        if (stage_loads.is_held(i)) holding[i] = holding_force(model.system, loads, forces, i);
    return holding;
}

double holding_force(const BlockSystem& system, const Loads& loads, const Eigen::VectorXd& forces, int boundary) {
    return -boundary_frame(system, boundary).normal.dot(loads.constraints.reaction(forces, boundary));
}

} // namespace kluft

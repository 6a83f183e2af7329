#include "kluft/simulation/stage_loads.hpp"

#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "kluft/blocks/block_search.hpp"
#include "kluft/core/diagnostics.hpp"
#include "kluft/kinematics/affine.hpp"

namespace kluft {

namespace {

constexpr int no_boundary = -1; ///< of the prescribed displacements of a fixed block

template <typename Visit> void for_each_edge(const BlockSystem& system, int boundary, Visit visit) {
    for (const auto& [b, e] : system.boundaries[boundary].edges) {
        const Edge& edge = system.blocks[b].edges[e];
        visit(b, edge_start(system, edge), edge_end(system, edge));
    }
}

/// At the end of a stage; -1: before the first one.
Vec2 gravity_after(const Model& model, int stage) {
    for (int s = stage; s >= 0; --s)
        if (model.loads.stages[s].gravity) return *model.loads.stages[s].gravity;
    return stage < 0 ? Vec2(Vec2::Zero()) : model.gravity;
}

/// The same of a point force.
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

} // namespace

BoundaryFrame boundary_frame(const BlockSystem& system, int boundary) {
    BoundaryFrame frame;
    Vec2 sum = Vec2::Zero();
    for_each_edge(system, boundary, [&](int, const Vec2& start, const Vec2& end) {
        sum += right_normal(end - start);
        frame.length += (end - start).norm();
    });
    if (frame.length == 0.0) return frame;
    if (sum.norm() > 0.0) frame.normal = sum.normalized();
    for (int i = 0; i < 2; ++i) { // a side along an axis has exactly that normal
        if (std::abs(frame.normal[i]) < 1e-12)
            frame.normal = Vec2::Unit(1 - i) * (frame.normal[1 - i] < 0.0 ? -1.0 : 1.0);
    }
    return frame;
}

int opposite_boundary(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    int best = -1;
    double most_opposite = -0.5;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        const double cosine = normal.dot(boundary_frame(system, i).normal);
        if (cosine < most_opposite) {
            most_opposite = cosine;
            best = i;
        }
    }
    return best;
}

Vec2 mean_position(const BlockSystem& system, int boundary) {
    Vec2 sum = Vec2::Zero();
    double length = 0.0;
    for_each_edge(system, boundary, [&](int, const Vec2& start, const Vec2& end) {
        sum += 0.5 * (end - start).norm() * (start + end);
        length += (end - start).norm();
    });
    return length > 0.0 ? Vec2(sum / length) : sum;
}

Vec2 mean_displacement(const BlockSystem& system, const Eigen::VectorXd& q, int boundary) {
    Vec2 sum = Vec2::Zero();
    double length = 0.0;
    for_each_edge(system, boundary, [&](int b, const Vec2& start, const Vec2& end) {
        const Vec2 xi = block_coordinates(system.blocks[b], 0.5 * (start + end));
        sum += (end - start).norm() * displacement_at(q, b, xi);
        length += (end - start).norm();
    });
    return length > 0.0 ? Vec2(sum / length) : sum;
}

std::vector<int> lateral_boundaries(const BlockSystem& system, int boundary) {
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const Vec2 lateral(normal.y(), -normal.x());
    std::vector<int> result;
    for (const double side : {1.0, -1.0}) {
        int best = -1;
        double most_lateral = 0.7;
        for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
            const double cosine = side * lateral.dot(boundary_frame(system, i).normal);
            if (cosine > most_lateral) {
                most_lateral = cosine;
                best = i;
            }
        }
        if (best >= 0) result.push_back(best);
    }
    if (result.size() < 2) result.clear();
    return result;
}

PlatenForce width_across(const BlockSystem& system, int boundary) {
    PlatenForce force;
    force.widening.setZero(n_block_unknowns * system.n_blocks());
    force.width = boundary_frame(system, boundary).length;
    const auto sides = lateral_boundaries(system, boundary);
    if (sides.empty()) return force;
    const Vec2 normal = boundary_frame(system, boundary).normal;
    const Vec2 lateral(normal.y(), -normal.x());
    force.width = std::abs(lateral.dot(mean_position(system, sides[0]) - mean_position(system, sides[1])));
    for (const int i : sides) {
        const double side = i == sides.front() ? 1.0 : -1.0;
        const double length = boundary_frame(system, i).length;
        for_each_edge(system, i, [&](int b, const Vec2& start, const Vec2& end) {
            const Vec2 xi = block_coordinates(system.blocks[b], 0.5 * (start + end));
            const double share = side * (end - start).norm() / length;
            force.widening.segment<n_block_unknowns>(n_block_unknowns * b) += share * displacement_row(lateral, xi);
        });
    }
    return force;
}

StageLoads::StageLoads(const Model& model, const State& stage_start, const Stage& stage) {
    const BlockSystem& system = model.system;
    const int n = static_cast<int>(system.boundaries.size());
    held_.assign(n, 0);
    start_pressure_ = stage_start.boundary_pressure;
    end_pressure_ = start_pressure_;
    for (const auto& [boundary, pressure] : stage.pressure) end_pressure_[boundary] = pressure;

    std::vector<Support> supports = model.loads.supports;
    Vec2 velocity = Vec2::Zero(); // of the moved platen per unit of load factor
    int moved = -1;
    if (stage.motion) {
        moved = stage.motion->boundary;
        const int fixed = opposite_boundary(system, moved);
        const Support kind = stage.platens == Platens::rough ? Support::fixed : Support::smooth;
        supports[moved] = kind;
        if (fixed >= 0 && kind == Support::fixed) supports[fixed] = Support::fixed;
        if (fixed >= 0 && supports[fixed] == Support::none) supports[fixed] = Support::pinned;
        const Vec2 inward = -boundary_frame(system, moved).normal;
        double distance = stage.motion->value;
        if (stage.motion->control == PlatenControl::strain) {
            const Vec2 base = fixed >= 0 ? mean_position(system, fixed) : system.lower;
            distance *= std::abs(inward.dot(base - mean_position(system, moved)));
        }
        velocity = distance * inward;
        if (stage.motion->control == PlatenControl::stress) {
            velocity = inward; // per unit of its unknown travel
            start_platen_stress_ = start_pressure_[moved];
            end_platen_stress_ = stage.motion->value;
            platen_force_ = width_across(system, moved);
        }
    }

    std::vector<PrescribedDisplacement> rows;
    for (int boundary = 0; boundary < n; ++boundary) {
        if (supports[boundary] == Support::none) continue;
        held_[boundary] = 1;
        start_pressure_[boundary] = end_pressure_[boundary] = 0.0;
        const Vec2 normal = boundary_frame(system, boundary).normal;
        const Vec2 motion = boundary == moved ? velocity : Vec2::Zero();
        const Vec2 along(-normal.y(), normal.x());
        const auto pin = supports[boundary] == Support::pinned ? middle_vertex(system, boundary) : std::nullopt;
        std::set<std::pair<int, int>> done; // (block, vertex)
        for (const auto& [b, e] : system.boundaries[boundary].edges) {
            if (system.blocks[b].fixed) continue;
            const Edge& edge = system.blocks[b].edges[e];
            for (const int vertex : {edge.start, edge.end}) {
                if (!done.emplace(b, vertex).second) continue;
                const Vec2 xi = block_coordinates(system.blocks[b], system.vertices[vertex]);
                const Vec2 start = displacement_at(stage_start.displacement, b, xi);
                const auto prescribe = [&, b = b](const Vec2& direction) {
                    const double rate = direction.dot(motion);
                    rows.push_back({b, xi, direction, boundary, direction.dot(start), platen_force_ ? rate : 0.0});
                    start_targets_.push_back(direction.dot(start));
                    target_rates_.push_back(platen_force_ ? 0.0 : rate);
                };
                prescribe(normal);
                if (supports[boundary] == Support::fixed || pin == std::pair(b, vertex)) prescribe(along);
            }
        }
    }
    for (int b = 0; b < system.n_blocks(); ++b) {
        if (!system.blocks[b].fixed) continue;
        for (const Vec2& xi : {Vec2(0.0, 0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)}) {
            for (const Vec2& direction : {Vec2(1.0, 0.0), Vec2(0.0, 1.0)}) {
                rows.push_back({b, xi, direction, no_boundary});
                start_targets_.push_back(0.0);
                target_rates_.push_back(0.0);
            }
        }
    }
    constraints_ = model.kinematics == Kinematics::rigid
                       ? Constraints(std::move(rows), system, stage_start.displacement)
                       : Constraints(std::move(rows));
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
    State rest;
    rest.displacement = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n_block_unknowns) * system.n_blocks());
    rest.boundary_pressure.assign(system.boundaries.size(), 0.0);
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

StageLoads enter_stage(const Model& model, State& state) {
    const Stage& stage = model.loads.stages[state.stage];
    if (state.step_in_stage == 0) {
        state.stage_start_displacement = state.displacement;
        if (stage.motion && !state.reference_set) {
            state.reference_displacement = state.displacement;
            state.reference_set = true;
        }
    }
    State start;
    start.displacement = state.stage_start_displacement;
    start.boundary_pressure = state.boundary_pressure;
    return {model, start, stage};
}

void leave_stage(const Model& model, const StageLoads& loads, const LoadedBody& body, const Eigen::VectorXd& forces,
                 State& state) {
    const auto end = loads.pressures(1.0);
    for (int i = 0; i < static_cast<int>(end.size()); ++i) {
        const auto frame = boundary_frame(model.system, i);
        state.boundary_pressure[i] =
            loads.is_held(i) ? boundary_stress(body, forces, i, true, frame.length, frame.normal) : end[i];
    }
    ++state.stage;
    state.step_in_stage = 0;
    state.load_factor = 0.0;
}

void apply_load(const Model& model, const StageLoads& loads, int stage, double load_factor, LoadedBody& body) {
    body.pressures = loads.pressures(load_factor);
    body.platen_force = loads.platen_force(load_factor);
    loads.set_targets(body.constraints, load_factor);
    body.gravity = between(gravity_after(model, stage - 1), gravity_after(model, stage), load_factor);
    body.point_loads.clear();
    for (int i = 0; i < static_cast<int>(model.force_points.size()); ++i) {
        const auto [block, xi] = model.force_points[i];
        const Vec2 force = between(force_after(model, i, stage - 1), force_after(model, i, stage), load_factor);
        if (force != Vec2::Zero()) body.point_loads.push_back({block, xi, force});
    }
}

double boundary_stress(const LoadedBody& body, const Eigen::VectorXd& forces, int boundary, bool held,
                       double current_length, const Vec2& normal) {
    if (!held) return body.pressures[boundary];
    return -normal.dot(body.constraints.reaction(forces, boundary)) / current_length;
}

} // namespace kluft

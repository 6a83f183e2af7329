#include "kluft/simulation/measurements.hpp"

#include <algorithm>
#include <cmath>

#include "kluft/kinematics/affine.hpp"
#include "kluft/loading/boundary_geometry.hpp"

namespace kluft {

namespace {

int uppermost_boundary(const BlockSystem& system) {
    int best = -1;
    double most_upward = 0.5;
    for (int i = 0; i < static_cast<int>(system.boundaries.size()); ++i) {
        const double up = boundary_frame(system, i).normal.y();
        if (up > most_upward) {
            most_upward = up;
            best = i;
        }
    }
    return best;
}

struct PairOfEdges {
    int block_a, edge_a, block_b, edge_b;
    bool operator==(const PairOfEdges&) const = default;
};

void count(ContactState state, ContactCounts& counts) {
    ++(state == ContactState::open ? counts.open : state == ContactState::sliding ? counts.sliding : counts.locked);
}

PairOfEdges edges_of(const ContactKey& key) { return {key.block_a, key.edge_a, key.block_b, key.edge_b}; }

/// A part of the body's extent along an axis (m).
struct Layer {
    Vec2 axis;
    double low = 0.0;
    double high = 0.0;

    [[nodiscard]] bool contains(const Vec2& x) const { return axis.dot(x) >= low && axis.dot(x) <= high; }
};

/// Between the quarters.
Layer middle_half(const BlockSystem& system, const Vec2& axis) {
    std::vector<double> heights;
    for (const Vec2& vertex : system.vertices) heights.push_back(axis.dot(vertex));
    const auto [low, high] = std::ranges::minmax(heights);
    const double quarter = 0.25 * (high - low);
    return {axis, low + quarter, high - quarter};
}

/// Whether it is made of cells of the net. Larger blocks are rock around a region with a net: that carries load when all
/// bonds of the net have failed.
bool cells_fill(const BlockSystem& system, const Layer& layer) {
    constexpr double most_of_it = 0.95;
    double of_cells = 0.0;
    double all = 0.0;
    for (const Block& block : system.blocks) {
        if (!layer.contains(block.centroid)) continue;
        all += block.area;
        if (is_cell_of_net(system, block)) of_cells += block.area;
    }
    return of_cells >= most_of_it * all;
}

std::vector<int> bonds_in_the_middle(const Model& model, const Vec2& axis) {
    const BlockSystem& system = model.system;
    const Layer middle = middle_half(system, axis);
    std::vector<int> bonds;
    if (!cells_fill(system, middle)) return bonds;
    for (int i = 0; i < system.n_interfaces(); ++i) {
        const Interface& interface = system.interfaces[i];
        if (interface.origin != EdgeOrigin::tessellation || !model.bonds[interface.interface_type]) continue;
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        if (middle.contains(0.5 * (edge_start(system, edge) + edge_end(system, edge)))) bonds.push_back(i);
    }
    return bonds;
}

/// 0 where there are none.
double broken_share(const std::vector<int>& bonds, const std::vector<InterfaceStatus>& interfaces) {
    const auto broken =
        std::ranges::count_if(bonds, [&](int i) { return interfaces[i] != InterfaceStatus::potential_crack; });
    return bonds.empty() ? 0.0 : static_cast<double>(broken) / static_cast<double>(bonds.size());
}

} // namespace

Gauges make_gauges(const Model& model) {
    const BlockSystem& system = model.system;
    Gauges gauges;
    for (std::size_t s = 0; s < model.loads.stages.size(); ++s) {
        const auto& motion = model.loads.stages[s].motion;
        if (!motion) continue;
        gauges.moved = motion->boundary;
        gauges.opposite = resting_boundary(system, *motion);
        gauges.first_platen_stage = static_cast<int>(s);
        break;
    }
    if (gauges.moved < 0) {
        gauges.moved = uppermost_boundary(system);
        if (gauges.moved >= 0) gauges.opposite = opposite_boundary(system, gauges.moved);
    }
    if (gauges.moved >= 0) gauges.axial_normal = boundary_frame(system, gauges.moved).normal;
    gauges.middle_bonds = bonds_in_the_middle(model, gauges.axial_normal);
    if (gauges.moved < 0) return gauges;
    gauges.lateral_normal = {gauges.axial_normal.y(), -gauges.axial_normal.x()};
    gauges.length = distance_across(system, gauges.moved);
    gauges.lateral = lateral_sides(system, gauges.moved);
    gauges.width = width_across(system, gauges.moved).width;
    if (gauges.first_platen_stage >= 0) gauges.pressed_share = pressed_length(system, gauges.moved) / gauges.width;
    return gauges;
}

Strains measure_strains(const Model& model, const Gauges& gauges, const Loads& loads, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& reference) {
    Strains strains;
    if (gauges.moved < 0) return strains;
    const Eigen::VectorXd from = reference.size() == q.size() ? reference : Eigen::VectorXd::Zero(q.size());
    const Eigen::VectorXd change = q - from;
    const double travel = platen_travel(loads, q);
    const auto outward = [&](int boundary, const Vec2& mean) {
        const auto platen = std::ranges::find(loads.platens, boundary, &Platen::boundary);
        if (platen == loads.platens.end()) return boundary_frame(model.system, boundary).normal.dot(mean);
        const double until_stage =
            mean_reach(*platen, loads.platen_points) - mean_reach(*platen, laid_points(model.system, *platen, from));
        return until_stage + platen->moved + platen->rate * travel;
    };
    for (const int i : {gauges.moved, gauges.opposite})
        if (i >= 0) strains.axial -= outward(i, mean_displacement(model.system, change, i)) / gauges.length;
    if (gauges.lateral[0].empty()) return strains;
    for (const Side& side : gauges.lateral)
        for (const SidePart& part : side) {
            const Vec2 mean = mean_displacement(model.system, change, part);
            strains.lateral -= part.weight * outward(part.boundary, mean) / gauges.width;
        }
    return strains;
}

ContactState worse(ContactState a, ContactState b) {
    const auto severity = [](ContactState state) {
        if (state == ContactState::open) return 0;
        return state == ContactState::locked ? 1 : 2;
    };
    return severity(b) > severity(a) ? b : a;
}

ContactCounts count_contacts(const Model& model, const State& state, const LoadedBody& body, const Eigen::VectorXd& q) {
    const std::vector<ContactPoint>& points = body.placement->contacts;
    const int n = static_cast<int>(points.size());
    ContactCounts counts;
    std::vector<char> seen(model.system.interfaces.size(), 0);
    for (int first = 0, last = 0; first < n; first = last) {
        ContactState worst = ContactState::open;
        for (; last < n && edges_of(points[last].key) == edges_of(points[first].key); ++last)
            worst = worse(worst, contact_traction(body, last, q).state);
        const int interface = points[first].interface;
        if (interface >= 0) seen[interface] = 1;
        if (interface >= 0 || worst != ContactState::open) count(worst, counts);
    }
    for (int i = 0; i < model.system.n_interfaces(); ++i) {
        if (state.body.interfaces[i] == InterfaceStatus::potential_crack) {
            ++counts.locked;
        } else if (!seen[i]) {
            ++counts.open;
        }
    }
    return counts;
}

InterfaceTraction mean_traction(const std::vector<InterfaceLaw>& laws, const Bond& bond, const Eigen::VectorXd& q) {
    InterfaceTraction mean;
    for (int k = 0; k < n_bond_points; ++k) {
        const PointTraction traction = bond_traction(laws[bond.law], bond, k, q);
        mean.normal += traction.normal / n_bond_points;
        mean.shear += traction.shear / n_bond_points;
    }
    return mean;
}

std::vector<InterfaceTraction> bond_tractions(const Model& model, const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<InterfaceTraction> tractions(model.system.interfaces.size());
    for (const Bond& bond : body.placement->bonds) tractions[bond.interface] = mean_traction(*body.laws, bond, q);
    return tractions;
}

StepRecord measure_step(const Model& model, const Gauges& gauges, const State& state, const LoadedBody& body,
                        const StageLoads& loads, const Eigen::VectorXd& q, const Eigen::VectorXd& forces) {
    StepRecord record;
    record.step = state.at.step + 1;
    record.stage = state.at.stage;
    record.load_factor = state.at.load_factor;
    const Strains strains = measure_strains(model, gauges, *body.loads, q, state.strain_zero);
    const Strains total = measure_strains(model, gauges, *body.loads, q, Eigen::VectorXd());
    record.axial_strain = strains.axial;
    record.lateral_strain = strains.lateral;
    record.volumetric_strain = strains.axial + strains.lateral;
    const auto stress_on = [&](int boundary, double length, double share_of_pressure) {
        return loads.is_held(boundary) ? holding_force(model.system, *body.loads, forces, boundary) / length
                                       : body.loads->pressures[boundary] * share_of_pressure;
    };
    if (gauges.moved >= 0) {
        const double width = gauges.width * (1.0 - total.lateral);
        record.axial_stress = stress_on(gauges.moved, width, gauges.pressed_share);
    }
    const double height = gauges.length * (1.0 - total.axial);
    for (const Side& side : gauges.lateral) {
        for (const SidePart& part : side)
            record.lateral_stress += 0.5 * part.share * stress_on(part.boundary, height * part.share, 1.0);
    }
    record.differential_stress = record.axial_stress - record.lateral_stress;
    record.cracks_tension = static_cast<int>(std::ranges::count(state.body.interfaces, InterfaceStatus::tension_crack));
    record.cracks_shear = static_cast<int>(std::ranges::count(state.body.interfaces, InterfaceStatus::shear_crack));
    record.net_broken = broken_share(gauges.middle_bonds, state.body.interfaces);
    const auto counts = count_contacts(model, state, body, q);
    record.open = counts.open;
    record.sliding = counts.sliding;
    record.locked = counts.locked;
    record.histories = measure_histories(model, body, q);
    return record;
}

} // namespace kluft

#include "kluft/simulation/measurements.hpp"

#include <algorithm>
#include <cmath>

#include "kluft/kinematics/affine.hpp"

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

/// Severity of a state, to name an interface by its worst point.
int severity(ContactState state) {
    if (state == ContactState::open) return 0;
    return state == ContactState::locked ? 1 : 2;
}

struct PairOfEdges {
    int block_a, edge_a, block_b, edge_b;
    bool operator==(const PairOfEdges&) const = default;
};

PairOfEdges edges_of(const ContactKey& key) { return {key.block_a, key.edge_a, key.block_b, key.edge_b}; }

} // namespace

Gauges make_gauges(const Model& model) {
    const BlockSystem& system = model.system;
    Gauges gauges;
    for (std::size_t s = 0; s < model.loads.stages.size(); ++s) {
        const auto& motion = model.loads.stages[s].motion;
        if (!motion) continue;
        gauges.moved = motion->boundary;
        gauges.first_platen_stage = static_cast<int>(s);
        break;
    }
    if (gauges.moved < 0) gauges.moved = uppermost_boundary(system);
    if (gauges.moved < 0) return gauges;
    gauges.axial_normal = boundary_frame(system, gauges.moved).normal;
    gauges.lateral_normal = {gauges.axial_normal.y(), -gauges.axial_normal.x()};
    gauges.opposite = opposite_boundary(system, gauges.moved);
    const Vec2 base = gauges.opposite >= 0 ? mean_position(system, gauges.opposite) : system.lower;
    gauges.length = std::abs(gauges.axial_normal.dot(mean_position(system, gauges.moved) - base));
    gauges.lateral = lateral_boundaries(system, gauges.moved);
    gauges.width = width_across(system, gauges.moved).width;
    return gauges;
}

Strains measure_strains(const Model& model, const Gauges& gauges, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& reference) {
    Strains strains;
    if (gauges.moved < 0) return strains;
    const Eigen::VectorXd change = reference.size() == q.size() ? Eigen::VectorXd(q - reference) : q;
    const auto closure = [&](int a, int b, const Vec2& normal) {
        double shortening = -normal.dot(mean_displacement(model.system, change, a));
        if (b >= 0) shortening += normal.dot(mean_displacement(model.system, change, b));
        return shortening;
    };
    strains.axial = closure(gauges.moved, gauges.opposite, gauges.axial_normal) / gauges.length;
    if (gauges.lateral.size() == 2) {
        strains.lateral = closure(gauges.lateral[0], gauges.lateral[1], gauges.lateral_normal) / gauges.width;
    }
    return strains;
}

ContactCounts count_contacts(const Model& model, const State& state, const LoadedBody& body, const Eigen::VectorXd& q) {
    ContactCounts counts;
    const auto add = [&](ContactState worst) {
        ++(worst == ContactState::open ? counts.open : worst == ContactState::sliding ? counts.sliding : counts.locked);
    };
    std::vector<char> seen(model.system.interfaces.size(), 0);
    for (int first = 0; first < static_cast<int>(body.contacts.size());) {
        int last = first;
        ContactState worst = ContactState::open;
        const ContactPoint& head = body.contacts[first];
        while (last < static_cast<int>(body.contacts.size()) &&
               edges_of(body.contacts[last].key) == edges_of(head.key)) {
            const ContactState s = contact_traction(body, last, q).state;
            if (severity(s) > severity(worst)) worst = s;
            ++last;
        }
        if (head.interface >= 0) {
            seen[head.interface] = 1;
            add(worst);
        } else if (worst != ContactState::open) {
            add(worst);
        }
        first = last;
    }
    for (int i = 0; i < model.system.n_interfaces(); ++i) {
        if (state.interfaces[i] == InterfaceStatus::potential_crack) {
            ++counts.locked;
        } else if (!seen[i]) {
            ++counts.open;
        }
    }
    return counts;
}

std::vector<InterfaceTraction> bond_tractions(const Model& model, const LoadedBody& body, const Eigen::VectorXd& q) {
    std::vector<InterfaceTraction> tractions(model.system.interfaces.size());
    for (const Bond& bond : body.bonds) {
        for (int k = 0; k < n_bond_points; ++k) {
            const auto traction = bond_traction((*body.laws)[bond.law], bond, k, q);
            tractions[bond.interface].normal += 0.5 * traction.normal;
            tractions[bond.interface].shear += 0.5 * traction.shear;
        }
    }
    return tractions;
}

StepRecord measure_step(const Model& model, const Gauges& gauges, const State& state, const LoadedBody& body,
                        const StageLoads& loads, const Eigen::VectorXd& q, const Eigen::VectorXd& forces) {
    StepRecord record;
    record.step = state.step + 1;
    record.stage = state.stage;
    record.load_factor = state.load_factor;
    const Strains strains = measure_strains(model, gauges, q, state.reference_displacement);
    const Strains total = measure_strains(model, gauges, q, Eigen::VectorXd());
    record.axial_strain = strains.axial;
    record.lateral_strain = strains.lateral;
    record.volumetric_strain = strains.axial + strains.lateral;
    const auto stress_on = [&](int boundary, double length, const Vec2& normal) {
        return boundary_stress(body, forces, boundary, loads.is_held(boundary), length, normal);
    };
    if (gauges.moved >= 0) {
        const double width = gauges.width * (1.0 - total.lateral);
        record.axial_stress = stress_on(gauges.moved, width, gauges.axial_normal);
    }
    for (const int side : gauges.lateral) {
        const double height = gauges.length * (1.0 - total.axial);
        record.lateral_stress += 0.5 * stress_on(side, height, boundary_frame(model.system, side).normal);
    }
    record.differential_stress = record.axial_stress - record.lateral_stress;
    record.cracks_tension = static_cast<int>(std::ranges::count(state.interfaces, InterfaceStatus::tension_crack));
    record.cracks_shear = static_cast<int>(std::ranges::count(state.interfaces, InterfaceStatus::shear_crack));
    const auto counts = count_contacts(model, state, body, q);
    record.open = counts.open;
    record.sliding = counts.sliding;
    record.locked = counts.locked;
    record.histories = measure_histories(model, body, q);
    return record;
}

FieldRecord field_record(const Model& model, const State& state, const LoadedBody& body) {
    const BlockSystem& system = model.system;
    const Eigen::VectorXd& q = state.displacement;
    FieldRecord fields;
    fields.stress = block_stresses(body, q);
    for (int b = 0; b < system.n_blocks(); ++b) {
        for (const Edge& edge : system.blocks[b].edges) {
            const Vec2 xi = block_coordinates(system.blocks[b], edge_start(system, edge));
            fields.displacement.push_back(displacement_at(q, b, xi));
        }
    }
    fields.interfaces.resize(system.interfaces.size());
    for (int i = 0; i < system.n_interfaces(); ++i) {
        const Interface& interface = system.interfaces[i];
        const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
        auto& record = fields.interfaces[i];
        record.bonded = state.interfaces[i] == InterfaceStatus::potential_crack;
        record.broken = state.interfaces[i] == InterfaceStatus::tension_crack ||
                        state.interfaces[i] == InterfaceStatus::shear_crack;
        record.mode = state.interfaces[i] == InterfaceStatus::shear_crack ? CrackMode::shear : CrackMode::tension;
        record.state = record.bonded ? ContactState::locked : ContactState::open;
        const Vec2 middle = 0.5 * (edge_start(system, edge) + edge_end(system, edge));
        const auto moved = [&](int b) { return displacement_at(q, b, block_coordinates(system.blocks[b], middle)); };
        const Vec2 relative = moved(interface.block_b) - moved(interface.block_a);
        const Vec2 along = (current_position(system, q, interface.block_a, edge.end) -
                            current_position(system, q, interface.block_a, edge.start))
                               .normalized();
        record.gap = right_normal(along).dot(relative);
        record.slip = along.dot(relative);
    }
    const auto bonds = bond_tractions(model, body, q);
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (!fields.interfaces[i].bonded) continue;
        fields.interfaces[i].normal_traction = bonds[i].normal;
        fields.interfaces[i].shear_traction = bonds[i].shear;
    }
    std::vector<double> lengths(system.interfaces.size(), 0.0);
    for (int i = 0; i < static_cast<int>(body.contacts.size()); ++i) {
        const ContactPoint& point = body.contacts[i];
        if (point.interface < 0) continue;
        const auto traction = contact_traction(body, i, q);
        auto& record = fields.interfaces[point.interface];
        if (severity(traction.state) > severity(record.state)) record.state = traction.state;
        record.normal_traction += point.weight * traction.normal;
        record.shear_traction += point.weight * traction.shear;
        lengths[point.interface] += point.weight;
    }
    for (int i = 0; i < system.n_interfaces(); ++i) {
        if (lengths[i] == 0.0) continue;
        fields.interfaces[i].normal_traction /= lengths[i];
        fields.interfaces[i].shear_traction /= lengths[i];
    }
    return fields;
}

} // namespace kluft

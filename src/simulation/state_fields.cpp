#include "kluft/simulation/state_fields.hpp"

#include <vector>

#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

FieldRecord field_record(const Model& model, const State& state, const LoadedBody& body) {
    const BlockSystem& system = model.system;
    const Eigen::VectorXd& q = state.body.displacement;
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
        record.bonded = state.body.interfaces[i] == InterfaceStatus::potential_crack;
        record.broken = state.body.interfaces[i] == InterfaceStatus::tension_crack ||
                        state.body.interfaces[i] == InterfaceStatus::shear_crack;
        record.mode = state.body.interfaces[i] == InterfaceStatus::shear_crack ? CrackMode::shear : CrackMode::tension;
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
    for (int i = 0; i < static_cast<int>(body.placement->contacts.size()); ++i) {
        const ContactPoint& point = body.placement->contacts[i];
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

FieldRecord fields_of_state(const Model& model, const State& state) {
    Placement placement;
    placement.bonds = placed_bonds(model, state.body);
    placement.contacts = detected_contacts(model, state.body).points;
    State copy = state;
    const StageLoads loads = enter_stage(model, copy);
    const LoadsAt at = loads_at(model, loads, state.at.stage, state.at.load_factor);
    return field_record(model, state, loaded_body(model, placement, at));
}

} // namespace kluft

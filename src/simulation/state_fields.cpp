#include "kluft/simulation/state_fields.hpp"

#include <vector>

#include "kluft/kinematics/affine.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/stage_loads.hpp"

namespace kluft {

namespace {

using InterfaceFields = FieldRecord::InterfaceFields;

std::vector<Vec2> vertex_displacements(const BlockSystem& system, const Eigen::VectorXd& q) {
    std::vector<Vec2> displacements;
    for (int b = 0; b < system.n_blocks(); ++b) {
        for (const Edge& edge : system.blocks[b].edges) {
            const Vec2 xi = block_coordinates(system.blocks[b], edge_start(system, edge));
            displacements.push_back(displacement_at(q, b, xi));
        }
    }
    return displacements;
}

/// Status, gap and slip of an interface; its tractions are still zero.
InterfaceFields interface_fields(const BlockSystem& system, int i, InterfaceStatus status, const Eigen::VectorXd& q) {
    const Interface& interface = system.interfaces[i];
    const Edge& edge = system.blocks[interface.block_a].edges[interface.edge_a];
    InterfaceFields record;
    record.bonded = status == InterfaceStatus::potential_crack;
    record.broken = status == InterfaceStatus::tension_crack || status == InterfaceStatus::shear_crack;
    record.mode = status == InterfaceStatus::shear_crack ? CrackMode::shear : CrackMode::tension;
    record.state = record.bonded ? ContactState::locked : ContactState::open;
    const Vec2 middle = 0.5 * (edge_start(system, edge) + edge_end(system, edge));
    const auto moved = [&](int b) { return displacement_at(q, b, block_coordinates(system.blocks[b], middle)); };
    const Vec2 relative = moved(interface.block_b) - moved(interface.block_a);
    const Vec2 along = (current_position(system, q, interface.block_a, edge.end) -
                        current_position(system, q, interface.block_a, edge.start))
                           .normalized();
    record.relative = relative;
    record.gap = right_normal(along).dot(relative);
    record.slip = along.dot(relative);
    return record;
}

/// Mean tractions of the contact points on the interfaces' own edges, and their worst states.
void add_contacts(const LoadedBody& body, const Eigen::VectorXd& q, std::vector<InterfaceFields>& interfaces) {
    std::vector<double> lengths(interfaces.size(), 0.0);
    for (int i = 0; i < static_cast<int>(body.placement->contacts.size()); ++i) {
        const ContactPoint& point = body.placement->contacts[i];
        if (point.interface < 0) continue;
        const auto traction = contact_traction(body, i, q);
        InterfaceFields& record = interfaces[point.interface];
        record.state = worse(record.state, traction.state);
        record.normal_traction += point.weight * traction.normal;
        record.shear_traction += point.weight * traction.shear;
        const Vec2 on_a = point.weight * (traction.normal * point.normal + traction.shear * point.tangent);
        record.force += point.block_a == body.system->interfaces[point.interface].block_a ? on_a : Vec2(-on_a);
        lengths[point.interface] += point.weight;
    }
    for (std::size_t i = 0; i < interfaces.size(); ++i) {
        if (lengths[i] == 0.0) continue;
        interfaces[i].normal_traction /= lengths[i];
        interfaces[i].shear_traction /= lengths[i];
    }
}

void add_bonds(const LoadedBody& body, const Eigen::VectorXd& q, std::vector<InterfaceFields>& interfaces) {
    for (int i = 0; i < static_cast<int>(body.placement->bonds.size()); ++i) {
        const Bond& bond = body.placement->bonds[i];
        InterfaceFields& record = interfaces[bond.interface];
        for (int k = 0; k < n_bond_points; ++k) {
            const auto traction = bond_traction(body, i, k, q);
            record.normal_traction += 0.5 * traction.normal;
            record.shear_traction += 0.5 * traction.shear;
            record.force += bond.weight * (traction.normal * bond.normal() + traction.shear * bond.tangent);
        }
    }
}

/// What keeps the strain across the plane at zero, or nothing in plane stress.
std::vector<double> stresses_across(const Model& model, const std::vector<Mat2>& stresses) {
    std::vector<double> across(stresses.size(), 0.0);
    if (model.plane == Plane::stress) return across;
    for (int b = 0; b < model.system.n_blocks(); ++b) {
        const ElasticModuli& moduli = model.moduli[model.system.blocks[b].material];
        across[b] = engineering_moduli(moduli, model.plane).poissons_ratio * stresses[b].trace();
    }
    return across;
}

} // namespace

FieldRecord field_record(const Model& model, const State& state, const LoadedBody& body) {
    const Eigen::VectorXd& q = state.body.displacement;
    FieldRecord fields;
    fields.stress = block_stresses(body, q);
    fields.stress_zz = stresses_across(model, fields.stress);
    fields.displacement = vertex_displacements(model.system, q);
    for (int i = 0; i < model.system.n_interfaces(); ++i)
        fields.interfaces.push_back(interface_fields(model.system, i, state.body.interfaces[i], q));
    add_bonds(body, q, fields.interfaces);
    add_contacts(body, q, fields.interfaces);
    fields.platens = faces_of(model.system, *body.loads, q);
    fields.contacts = contact_forces(body, q);
    fields.supports = support_forces(body, q);
    return fields;
}

void with_body_of_state(const Model& model, const State& state, const std::function<void(const LoadedBody&)>& use) {
    const Placement placement = placed_anew(model, state.body, state.at.stage);
    State copy = state;
    const StageLoads loads = enter_stage(model, copy);
    const LoadsAt at = loads_at(model, loads, hold_of(model, loads, copy.body), state.at.stage, state.at.load_factor);
    use(loaded_body(model, placement, at));
}

FieldRecord fields_of_state(const Model& model, const State& state) {
    FieldRecord fields;
    with_body_of_state(model, state, [&](const LoadedBody& body) { fields = field_record(model, state, body); });
    return fields;
}

} // namespace kluft

#include "kluft/simulation/state_points.hpp"

#include <algorithm>

#include "kluft/contact/bonds.hpp"
#include "kluft/contact/detection.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

/// Largest opening at which a contact point is kept, relative to the lattice spacing. Twice this is less than the
/// distance of hexagons that are not neighbours, so that an undeformed net has no pairs but its own.
constexpr double contact_reach = 0.1;

} // namespace

std::vector<char> bonded_interfaces(const State& state) {
    std::vector<char> bonded(state.interfaces.size());
    std::ranges::transform(state.interfaces, bonded.begin(),
                           [](InterfaceStatus s) { return s == InterfaceStatus::potential_crack ? 1 : 0; });
    return bonded;
}

void place_bonds(const Model& model, const State& state, std::vector<Bond>& bonds) {
    bonds.clear();
    bonds.reserve(static_cast<std::size_t>(std::ranges::count(state.interfaces, InterfaceStatus::potential_crack)));
    for (int i = 0; i < model.system.n_interfaces(); ++i) {
        if (state.interfaces[i] != InterfaceStatus::potential_crack) continue;
        bonds.push_back(bond_at(model.system, i, state.displacement, &state.bond_shear[n_bond_points * i]));
    }
}

bool may_outlines_meet(const Model& model) { return model.system.outline_type >= 0; }

StateContacts state_contacts(const Model& model, const State& state) {
    ContactSurfaces surfaces;
    surfaces.bonded = bonded_interfaces(state);
    for (const Interface& interface : model.system.interfaces) {
        surfaces.law.push_back(model.fracture_law[interface.interface_type]);
    }
    for (const InterfaceLaw& law : model.laws) surfaces.friction.push_back(law.tan_friction);
    const auto fracture = std::ranges::find(model.bonds, 0);
    surfaces.default_law = fracture != model.bonds.end() ? static_cast<int>(fracture - model.bonds.begin()) : 0;
    if (model.system.outline_type >= 0) surfaces.default_law = model.fracture_law[model.system.outline_type];
    surfaces.outlines_meet = may_outlines_meet(model);
    auto detected = detect_contacts(model.system, surfaces, state.displacement, contact_reach * model.system.spacing,
                                    state.contacts);
    return {std::move(detected.points), std::move(detected.near_pairs)};
}

void renew_contacts(const State& state, std::vector<ContactPoint>& points) {
    for (ContactPoint& point : points) {
        const auto memory = std::ranges::lower_bound(state.contacts, point.key, {}, &ContactMemory::key);
        const bool known = memory != state.contacts.end() && memory->key == point.key;
        point.history = known ? memory->history : PointHistory{};
        point.slip_start = point.tangent.dot(relative_position(point, state.displacement));
    }
}

void keep_histories(const LoadedBody& body, const Eigen::VectorXd& q, State& state) {
    for (const Bond& bond : body.bonds) {
        const InterfaceLaw& law = (*body.laws)[bond.law];
        double* const shear = &state.bond_shear[n_bond_points * bond.interface];
        for (int k = 0; k < n_bond_points; ++k) shear[k] = bond_traction(law, bond, k, q).shear;
    }
    state.contacts.clear();
    for (const ContactPoint& point : body.contacts) {
        const auto traction = contact_traction(*body.laws, point, q);
        if (traction.state == ContactState::open && traction.history.dilation == 0.0) continue;
        state.contacts.push_back({point.key, traction.history});
    }
}

FieldRecord fields_of_state(const Model& model, const State& state) {
    LoadedBody body;
    body.kinematics = model.kinematics;
    body.system = &model.system;
    body.moduli = &model.moduli;
    const auto reduced = reduced_strengths(model, state.stage, state.load_factor);
    body.laws = &reduced.laws;
    place_bonds(model, state, body.bonds);
    body.contacts = state_contacts(model, state).points;
    if (model.kinematics == Kinematics::rigid) { // stresses come from the forces
        State copy = state;
        const StageLoads loads = enter_stage(model, copy);
        body.constraints = loads.constraints();
        body.pressure_edges = loads.edges();
        if (has_gravity(model)) body.densities = model.densities;
        apply_load(model, loads, state.stage, state.load_factor, body);
    }
    return field_record(model, state, body);
}

} // namespace kluft

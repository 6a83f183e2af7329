#include "kluft/simulation/placement.hpp"

#include <algorithm>

#include "kluft/contact/overlap_rule.hpp"

namespace kluft {

namespace {

/// A joint that has dilated carries that far apart (m).
double largest_dilation(const std::vector<ContactMemory>& contacts) {
    double largest = 0.0;
    for (const ContactMemory& contact : contacts) largest = std::max(largest, contact.history.dilation);
    return largest;
}

} // namespace

std::vector<char> bonded_interfaces(const BodyState& body) {
    std::vector<char> bonded(body.interfaces.size());
    std::ranges::transform(body.interfaces, bonded.begin(),
                           [](InterfaceStatus s) { return s == InterfaceStatus::potential_crack ? 1 : 0; });
    return bonded;
}

std::vector<Bond> placed_bonds(const Model& model, const BodyState& body) {
    std::vector<Bond> bonds;
    bonds.reserve(static_cast<std::size_t>(std::ranges::count(body.interfaces, InterfaceStatus::potential_crack)));
    for (int i = 0; i < model.system.n_interfaces(); ++i) {
        if (body.interfaces[i] != InterfaceStatus::potential_crack) continue;
        bonds.push_back(bond_at(model.system, i, body.displacement, &body.bond_shear[n_bond_points * i]));
    }
    return bonds;
}

bool may_outlines_meet(const Model& model) { return model.system.outline_type >= 0; }

bool ground_holds_tips(const Model& model, int stage) { return !model.loads.stages[stage].strength_reduction; }

DetectedContacts detected_contacts(const Model& model, const BodyState& body, bool ground_holds_tips) {
    ContactSurfaces surfaces;
    surfaces.ground_holds_tips = ground_holds_tips;
    surfaces.bonded = bonded_interfaces(body);
    for (const Interface& interface : model.system.interfaces) {
        surfaces.law.push_back(model.fracture_law[law_of(interface)]);
    }
    surfaces.n_points = model.overlap_points;
    for (const InterfaceLaw& law : model.laws) surfaces.friction.push_back(law.tan_friction);
    const auto fracture = std::ranges::find(model.bonds, 0);
    surfaces.default_law = fracture != model.bonds.end() ? static_cast<int>(fracture - model.bonds.begin()) : 0;
    surfaces.outlines_meet = may_outlines_meet(model);
    if (surfaces.outlines_meet) surfaces.default_law = model.fracture_law[model.system.outline_type];
    if (surfaces.outlines_meet) surfaces.outline_points = overlap_points_alone(model.laws[surfaces.default_law]);
    const double reach = contact_reach * model.system.spacing + largest_dilation(body.contacts);
    return detect_contacts(model.system, surfaces, body.displacement, reach, body.contacts);
}

bool is_of(const LastDetection& last, const BodyState& body, bool ground_holds_tips) {
    return last.ground_holds_tips == ground_holds_tips && last.of.displacement == body.displacement &&
           last.of.interfaces == body.interfaces && last.of.contacts == body.contacts;
}

Placement placed_anew(const Model& model, const BodyState& body, int stage) {
    Placement placement;
    placement.bonds = placed_bonds(model, body);
    placement.contacts = detected_contacts(model, body, ground_holds_tips(model, stage)).points;
    return placement;
}

std::vector<ContactPoint> renewed_contacts(const BodyState& body, std::vector<ContactPoint> points) {
    for (ContactPoint& point : points) {
        const auto memory = std::ranges::lower_bound(body.contacts, point.key, {}, &ContactMemory::key);
        const bool known = memory != body.contacts.end() && memory->key == point.key;
        point.history = known ? memory->history : PointHistory{};
        point.slip_start = point.tangent.dot(relative_position(point, body.displacement));
    }
    return points;
}

LoadedBody loaded_body(const Model& model, const Placement& placement, const LoadsAt& at) {
    LoadedBody body;
    body.kinematics = model.kinematics;
    body.system = &model.system;
    body.moduli = &model.moduli;
    body.densities = has_gravity(model) ? &model.densities : nullptr;
    body.laws = &at.laws;
    body.placement = &placement;
    body.loads = &at.loads;
    body.carried_stress = at.carried_stress;
    return body;
}

void keep_histories(const LoadedBody& body, const Eigen::VectorXd& q, BodyState& state) {
    for (const Bond& bond : body.placement->bonds) {
        const InterfaceLaw& law = (*body.laws)[bond.law];
        double* const shear = &state.bond_shear[n_bond_points * bond.interface];
        for (int k = 0; k < n_bond_points; ++k) shear[k] = bond_traction(law, bond, k, q).shear;
    }
    state.contacts.clear();
    for (const ContactPoint& point : body.placement->contacts) {
        const auto traction = contact_traction(*body.laws, point, q);
        if (traction.state == ContactState::open && traction.history.dilation == 0.0) continue;
        state.contacts.push_back({point.key, traction.history});
    }
}

} // namespace kluft

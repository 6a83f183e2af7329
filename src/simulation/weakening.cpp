#include "kluft/simulation/weakening.hpp"

#include <algorithm>

#include "kluft/contact/bonds.hpp"
#include "kluft/contact/contact.hpp"
#include "kluft/contact/overlap_rule.hpp"
#include "kluft/simulation/measurements.hpp"
#include "kluft/simulation/placement.hpp"
#include "kluft/simulation/strength_reduction.hpp"

namespace kluft {

namespace {

constexpr double critical_share = 0.95; ///< of f_max in `critical_first`

double failure_threshold(const CrackOptions& options, double largest) {
    switch (options.update) {
    case CrackUpdate::event:
        return largest - options.event_tolerance;
    case CrackUpdate::critical_first:
        return std::max(1.0, critical_share * largest);
    case CrackUpdate::all:
        return 1.0;
    case CrackUpdate::single:
        return largest;
    }
    return 1.0;
}

} // namespace

std::vector<CrackCandidate> check_cracks(const Model& model, CrackCriterion criterion, const State& state,
                                         double strength_factor, const LoadedBody& body, const Eigen::VectorXd& q) {
    const auto bonded = bonded_interfaces(state.body);
    const auto stresses = block_stresses(body, q);
    const auto check = [&](const std::vector<Strength>& strengths) {
        if (criterion == CrackCriterion::principal_stress)
            return crack_check(model.system, bonded, strengths, stresses);
        return crack_check(model.system, bonded, strengths, stresses, bond_tractions(model, body, q));
    };
    if (strength_factor == 1.0) return check(model.strengths);
    return check(reduced_strengths(model, state.at.stage, strength_factor));
}

std::vector<CrackCandidate> chosen_to_fail(const CrackOptions& options, const std::vector<CrackCandidate>& candidates) {
    const double largest = largest_index(candidates);
    if (largest < 1.0) return {};
    auto chosen = failing(candidates, failure_threshold(options, largest));
    if (options.update == CrackUpdate::single) chosen.resize(1);
    return chosen;
}

CrackRecord weaken(const Model& model, const CrackCandidate& candidate, State& state) {
    const int i = candidate.interface;
    const Interface& interface = model.system.interfaces[i];
    const bool tension = candidate.index.tension_governs;
    state.body.interfaces[i] = tension ? InterfaceStatus::tension_crack : InterfaceStatus::shear_crack;
    const bool ordered = interface.block_a < interface.block_b;
    const OverlapRule rule = overlap_rule(model.overlap_points[i]);
    for (std::size_t point = 0; point < rule.positions.size(); ++point) {
        const double along_a = rule.positions[point];
        ContactMemory memory;
        memory.key = key_of_own_edges(interface, static_cast<int>(point));
        memory.history.shear_trial =
            bond_shear_at(&state.body.bond_shear[n_bond_points * i], ordered ? along_a : 1.0 - along_a);
        state.body.contacts.push_back(memory);
    }
    const Edge& edge = model.system.blocks[interface.block_a].edges[interface.edge_a];
    const Vec2 middle = model.system.origin + 0.5 * (edge_start(model.system, edge) + edge_end(model.system, edge));
    CrackRecord record;
    record.step = state.at.step + 1;
    record.interface = i;
    record.x = middle.x();
    record.y = middle.y();
    record.mode = tension ? CrackMode::tension : CrackMode::shear;
    record.p1 = candidate.stress.p1;
    record.p3 = candidate.stress.p3;
    return record;
}

void weaken_together(const Model& model, const std::vector<CrackCandidate>& broken, double axial_strain, Step& step) {
    ++step.crack_passes;
    for (const CrackCandidate& candidate : broken) {
        CrackRecord record = weaken(model, candidate, step.end);
        record.pass = step.crack_passes;
        record.axial_strain = axial_strain;
        step.cracks.push_back(record);
    }
    std::ranges::sort(step.end.body.contacts, {}, &ContactMemory::key);
}

} // namespace kluft

// The bonds and contacts of a state: where open-close iteration starts from.
#pragma once

#include <utility>
#include <vector>

#include "kluft/contact/bonds.hpp"
#include "kluft/contact/contact.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/state.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// 1 for each interface that is still bonded.
[[nodiscard]] std::vector<char> bonded_interfaces(const State& state);

/// Replaces `bonds` by those of the state, in its frames.
void place_bonds(const Model& model, const State& state, std::vector<Bond>& bonds);

struct StateContacts {
    std::vector<ContactPoint> points;
    std::vector<std::pair<int, int>> near_pairs; ///< blocks near enough to touch soon
};

/// Whether blocks touch with their outlines alone: given blocks do, with gaps between them too.
[[nodiscard]] bool may_outlines_meet(const Model& model);

/// Contacts of the unbonded surfaces, with the histories of the state.
[[nodiscard]] StateContacts state_contacts(const Model& model, const State& state);

/// The same contact points and frames once more, with the histories of the state and slip counted from its
/// displacements.
void renew_contacts(const State& state, std::vector<ContactPoint>& points);

/// Puts the shear tractions of the body's bonds and the histories of its touching contacts at displacements q into the
/// state. Contacts that are open and have not dilated are forgotten.
void keep_histories(const LoadedBody& body, const Eigen::VectorXd& q, State& state);

/// Fields of a committed state, for pictures and ParaView.
[[nodiscard]] FieldRecord fields_of_state(const Model& model, const State& state);

} // namespace kluft

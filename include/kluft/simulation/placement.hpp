// The bonds and contacts of a state: where open-close iteration starts from, and what it leaves behind.
#pragma once

#include <vector>

#include "kluft/contact/bonds.hpp"
#include "kluft/contact/contact.hpp"
#include "kluft/contact/detection.hpp"
#include "kluft/loading/loaded_body.hpp"
#include "kluft/simulation/model.hpp"
#include "kluft/simulation/stage_loads.hpp"
#include "kluft/simulation/state.hpp"

namespace kluft {

/// Largest opening at which a contact point is kept beyond what slip has forced, relative to the lattice spacing. Twice this is less than the
/// distance of hexagons that are not neighbours, so that an undeformed net has no pairs but its own.
inline constexpr double contact_reach = 0.1;

/// 1 for each interface that is still bonded.
[[nodiscard]] std::vector<char> bonded_interfaces(const BodyState& body);

/// The bonds of the state, in its frames.
[[nodiscard]] std::vector<Bond> placed_bonds(const Model& model, const BodyState& body);

/// Whether blocks touch with their outlines alone: given blocks do, with gaps between them too.
[[nodiscard]] bool may_outlines_meet(const Model& model);

/// Whether a stage lets the ground before a toe hold the tip that comes out there: not where strengths are reduced, since it counts for
/// nothing in the strength of rock.
[[nodiscard]] bool ground_holds_tips(const Model& model, int stage);

/// Contacts of the unbonded surfaces, with the histories of the state.
[[nodiscard]] DetectedContacts detected_contacts(const Model& model, const BodyState& body, bool ground_holds_tips);

/// The contacts that were detected last, and the body that they are of.
struct LastDetection {
    DetectedContacts contacts;
    BodyState of;
    bool ground_holds_tips = false;
};

/// Whether the body stands as it did then: all that detection asks of it is the same.
[[nodiscard]] bool is_of(const LastDetection& last, const BodyState& body, bool ground_holds_tips);

/// Bonds and contacts of the state where it stands, as a load step of that stage would begin with.
[[nodiscard]] Placement placed_anew(const Model& model, const BodyState& body, int stage);

/// The same contact points and frames once more, with the histories of the state and slip counted from its
/// displacements.
[[nodiscard]] std::vector<ContactPoint> renewed_contacts(const BodyState& body, std::vector<ContactPoint> points);

/// The body in a placement under loads, both of which it refers to.
[[nodiscard]] LoadedBody loaded_body(const Model& model, const Placement& placement, const LoadsAt& at);
LoadedBody loaded_body(const Model& model, const Placement& placement, LoadsAt&& at) = delete; ///< it refers to them

/// Puts the shear tractions of the bonds and the histories of the touching contacts at displacements q into the state.
/// Contacts that are open and have not dilated are forgotten.
void keep_histories(const LoadedBody& body, const Eigen::VectorXd& q, BodyState& state);

} // namespace kluft

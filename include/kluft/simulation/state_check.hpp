// Whether displacements are those of a body at all: what no load step may be accepted with.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// What is wrong with displacements q of the body, "" if nothing: one that is no finite number, a block that is turned
/// inside out (det F <= 0), or a closed contact so deep that blocks pass through each other: of the two faces of an
/// interface, three quarters of the extent of a block across them; of others, what detection would lose. Of a body with a
/// net only contacts of the first kind count, and not those of fragments, below a quarter of a cell of the net.
[[nodiscard]] std::string flaw_of_displacements(const LoadedBody& body, const Eigen::VectorXd& q);

/// The same of the contacts that do not count there: fragments of a net that has failed get so deep, and the next
/// detection may lose their contact. "" if there is none.
[[nodiscard]] std::string lost_contact(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft

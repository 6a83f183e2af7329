// Whether displacements are those of a body at all: what no load step may be accepted with.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// What is wrong with displacements q of the body, "" if nothing: one that is no finite number, a block that is turned
/// inside out (det F <= 0), or a closed contact so deep that blocks pass through each other: of the two faces of an
/// interface, three quarters of the extent of a block across them; of others, where the blocks are given ones, what detection would lose.
[[nodiscard]] std::string flaw_of_displacements(const LoadedBody& body, const Eigen::VectorXd& q);

/// The same of a contact of faces that were no neighbours: fragments of a net that has failed get so deep, and the next
/// detection loses their contact. "" if there is none.
[[nodiscard]] std::string lost_contact(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft

// Whether displacements are those of a body at all: what no load step may be accepted with.
#pragma once

#include <string>

#include <Eigen/Core>

#include "kluft/loading/loaded_body.hpp"

namespace kluft {

/// What is wrong with displacements q of the body, "" if nothing: one that is no finite number, a block that is turned
/// inside out (det F <= 0), or a closed contact that is deeper than detection can tell from two opposite sides of a block
/// (`deepest_penetration` of the smaller block), so that the blocks would pass through each other.
[[nodiscard]] std::string flaw_of_displacements(const LoadedBody& body, const Eigen::VectorXd& q);

} // namespace kluft

// Places where the stress of the rock changes within a block: cracks of a net come late there, and an opening without one hardly closes.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/constitutive/material.hpp"
#include "kluft/kinematics/rigid.hpp"

namespace kluft {

/// Warnings, for users: holes with a net coarser than 0.15 of their radius, and the shortest rock bridge of fewer than four
/// cells between the end of an open fracture and another one, or a side of the body or of a hole; not where the lines go round that
/// rock on a way three times as long or less, nor before another part of the same fracture.
/// None without a net. Of `types` the kind counts. Source of the limits: docs/accuracy.md, "Where stress concentrates".
[[nodiscard]] std::vector<std::string> coarse_places(const GeometrySpec& geometry, const CutReport& report,
                                                     const std::vector<InterfaceType>& types);

/// Warnings, for users, of a body without a net: holes that a block has more than a third of the edge of, or a tenth of it and more area
/// than the hole. Its one strain is that of the rock far off, too. None of rigid blocks, which have no strain and say nothing of
/// stresses within them. `resolution`: of the cut (m).
[[nodiscard]] std::vector<std::string> openings_in_large_blocks(const GeometrySpec& geometry, const BlockSystem& system,
                                                                double resolution, Kinematics kinematics);

} // namespace kluft

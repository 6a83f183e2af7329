// Places where the stress of the rock changes within a block of the net, so that cracks come late there.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_cutter.hpp"
#include "kluft/constitutive/material.hpp"

namespace kluft {

/// Warnings, for users: holes with a net coarser than 0.15 of their radius, and the shortest rock bridge of fewer than four
/// cells between the end of an open fracture and another one, or a side of the body or of a hole; not where the lines go round that
/// rock on a way three times as long or less, nor before another part of the same fracture.
/// None without a net. Of `types` the kind counts. Source of the limits: docs/accuracy.md, "Where stress concentrates".
[[nodiscard]] std::vector<std::string> coarse_places(const GeometrySpec& geometry, const CutReport& report,
                                                     const std::vector<InterfaceType>& types);

} // namespace kluft

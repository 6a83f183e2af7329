// Results as layers of a map, for geographic information systems.
#pragma once

#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/maps/map_layer.hpp"
#include "kluft/output/vtu.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The layers `blocks` (polygons) and `interfaces` (lines) at their places before loading, in scene coordinates. Attributes
/// are those of docs/files.md, "Maps"; stresses and tractions in Pa and positive in compression, lengths in m.
[[nodiscard]] std::vector<MapLayer> result_layers(const BlockSystem& system, const FieldRecord& fields,
                                                  const FieldNames& names, const std::string& crs);

} // namespace kluft

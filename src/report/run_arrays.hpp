// The body of a run and its states as arrays of a page.
#pragma once

#include "kluft/blocks/block_system.hpp"
#include "kluft/report/packed_arrays.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The body before loading. Of its vertices, block after block: `x`, `y` (local coordinates, m); `first`: of each block its
/// first vertex, and their number; `loops`: the first vertex of each loop, and their number; `loop_block`: of each loop; `material`
/// of each block; `outline`: pairs of vertices. Of its interfaces `block_a`, `block_b`, `vertex_i`, `vertex_j` (the ends of a's
/// edge), `type`, `fracture` (-1: none).
[[nodiscard]] PackedArrays shape_arrays(const BlockSystem& system);

/// A state. `ux`, `uy` of the vertices (m); `xx`, `yy`, `xy` of the blocks (Pa, positive in compression); of the interfaces
/// `flags` (0 open, 1 sliding, 2 locked; + 4 bonded; + 8 failed in tension, + 16 in shear), `normal_traction` (Pa, positive in
/// compression), `shear_traction` (Pa), `gap`, `slip` (m).
[[nodiscard]] PackedArrays state_arrays(const BlockSystem& system, const FieldRecord& fields);

/// Size of a state's arrays before compression.
[[nodiscard]] std::size_t bytes_of_state(const BlockSystem& system);

} // namespace kluft

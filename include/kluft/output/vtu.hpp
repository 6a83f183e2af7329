// Fields for ParaView: VTU files with raw appended arrays.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// The blocks as polygons at their places before loading (scene coordinates, m; warp by `displacement` to see them
/// deformed). Point field `displacement` (m); cell fields `stress_xx, stress_yy, stress_xy` (Pa, positive in tension),
/// `sigma_1 >= sigma_3` (Pa, in-plane principal stresses positive in compression), `material`, `block`. The file says
/// signs and units in its field data `about`, and `step`, `axial_strain` and `material_names` beside it. A value that
/// is not a finite number is written as 0 and counted in the field data `replaced_values`.
[[nodiscard]] std::string blocks_vtu(const BlockSystem& system, const FieldRecord& fields,
                                     const std::vector<std::string>& material_names, const StepRecord& record);

/// The interfaces as lines at their places before loading, displaced by the mean of their sides. Cell fields `state`
/// (0 open, 1 sliding, 2 locked), `bonded` (0, 1), `crack_mode` (0 none, 1 tension, 2 shear), `normal_traction`
/// (Pa, positive in tension), `shear_traction` (Pa), `gap` (m, positive when open), `slip` (m), `mapped_fracture`
/// (index, -1 on a tessellation edge), `interface`.
[[nodiscard]] std::string interfaces_vtu(const BlockSystem& system, const FieldRecord& fields,
                                         const StepRecord& record);

/// In-plane principal stresses of a Cauchy stress that is positive in tension; positive in compression, first the
/// larger (Pa).
[[nodiscard]] std::pair<double, double> principal_compression(const Mat2& stress);

} // namespace kluft

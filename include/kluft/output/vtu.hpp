// Fields for ParaView: VTU files with compressed appended arrays.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What numbers in the files stand for.
struct FieldNames {
    std::vector<std::string> materials;
    std::vector<std::string> interface_types;
    std::vector<std::string> fractures; ///< mapped ones
};

/// The blocks as polygons at their places before loading (scene coordinates, m; warp by `displacement` to see them
/// deformed). Point field `displacement` (m); cell fields `stress` (Pa, 3 x 3 by rows, positive in compression),
/// `sigma_1 >= sigma_3` (Pa, in-plane principal stresses positive in compression), `material`, `block`. Names and units
/// stand in the names of field data, which readers without arrays of texts know too: `material: sandstone` has the number of
/// that material, `unit of stress: Pa, positive in compression` is 1; `step`, `stage`, `load_factor`, `axial_strain`
/// beside them. A value that is not a finite number is written as 0 and counted in the field data `replaced_values`.
[[nodiscard]] std::string blocks_vtu(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names,
                                     const StepRecord& record);

/// The interfaces as lines at their places before loading, displaced by the mean of their sides. Cell fields `state`
/// (0 open, 1 sliding, 2 locked), `bonded` (0, 1), `crack_mode` (0 none, 1 tension, 2 shear), `normal_traction`
/// (Pa, positive in compression), `shear_traction` (Pa), `gap` (m, positive when open), `slip` (m), the vectors
/// `relative_displacement` of side b against side a (m) and `contact_force` on side a (N/m), `block_a`, `block_b` (the
/// normal of tractions points from a to b), `interface_type`, `mapped_fracture` (index, -1 on a tessellation edge), `interface`. Names and units as above.
[[nodiscard]] std::string interfaces_vtu(const BlockSystem& system, const FieldRecord& fields, const FieldNames& names,
                                         const StepRecord& record);

/// In-plane principal stresses of a Cauchy stress that is positive in tension; positive in compression, first the
/// larger (Pa).
[[nodiscard]] std::pair<double, double> principal_compression(const Mat2& stress);

} // namespace kluft

// Fields for ParaView: VTU files with raw appended arrays, and the PVD series over them.
#pragma once

#include <filesystem>
#include <string>
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
/// (Pa, positive in tension), `shear_traction` (Pa), `gap` (m, positive when open), `slip` (m), `block_a`, `block_b` (the
/// normal of tractions points from a to b), `mapped_fracture` (index, -1 on a tessellation edge), `interface`.
[[nodiscard]] std::string interfaces_vtu(const BlockSystem& system, const FieldRecord& fields,
                                         const StepRecord& record);

/// In-plane principal stresses of a Cauchy stress that is positive in tension; positive in compression, first the
/// larger (Pa).
[[nodiscard]] std::pair<double, double> principal_compression(const Mat2& stress);

/// The series of field files in a results directory: `fields.pvd` over `fields/blocks_<step>.vtu` (part 0) and
/// `fields/interfaces_<step>.vtu` (part 1), with the load step as time.
class FieldSeries {
public:
    /// A series without files in `directory`; field files of an earlier run are removed. Throws ResourceError.
    [[nodiscard]] static FieldSeries create(const std::filesystem::path& directory);
    /// Goes on with the files up to `last_step`; later ones are removed. Throws ResourceError.
    [[nodiscard]] static FieldSeries resume(const std::filesystem::path& directory, int last_step);
    /// Removes all that a series owns in `directory`. Throws ResourceError.
    static void remove(const std::filesystem::path& directory);

    /// Writes the two files of a load step, then the series with them in it. Throws ResourceError.
    void add(const BlockSystem& system, const FieldRecord& fields, const std::vector<std::string>& material_names,
             const StepRecord& record);

    [[nodiscard]] const std::vector<int>& steps() const { return steps_; }

private:
    explicit FieldSeries(std::filesystem::path directory);
    void write_series() const;

    std::filesystem::path directory_;
    std::vector<int> steps_; ///< ascending
};

} // namespace kluft

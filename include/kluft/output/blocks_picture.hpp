// Pictures of the body: before and after a run side by side, and its geometry before any run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/geometry/polygon.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/output/summary.hpp"
#include "kluft/simulation/run_report.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What a picture of the body says beside the blocks themselves.
struct BlocksPlot {
    std::string title;
    std::string after = "after"; ///< above the deformed body
    double magnification = 1.0;  ///< of displacements
    std::vector<std::string> material_names;
    std::vector<bool> bonded_types;   ///< one per interface type: whether it is a potential crack; for draw_geometry
    std::vector<FallingBlock> moving; ///< marked in the deformed body, with where they go
};

/// The words above the deformed body after the given load steps: with the factor of safety that the summary has, if there is one,
/// or else where a platen moves the axial strain.
[[nodiscard]] std::string after_title(const std::vector<StepRecord>& history, bool moves_platen,
                                      const std::optional<RunSummary>& summary);

/// A field of blocks by which a picture is coloured.
struct ColouredField {
    std::string label;          ///< with its unit
    std::vector<double> values; ///< one per block, in that unit
};
/// The fields that blocks can be coloured by: sigma_1, sigma_3, stress_xx, stress_yy, stress_xy, stress_zz, displacement,
/// displacement_x, displacement_y.
[[nodiscard]] std::vector<std::string> block_field_names();
/// Stresses in MPa, positive in compression; displacements are means of the corners, in mm. Throws InputError for any other
/// name.
[[nodiscard]] ColouredField block_field(const BlockSystem& system, const FieldRecord& fields, const std::string& name);

/// What a picture of one state says.
struct StatePlot {
    std::string title;
    std::string heading;        ///< above the body
    double magnification = 1.0; ///< of displacements
    ColouredField field;
    std::optional<Box> window; ///< the part of the body that is shown, local coordinates (m); without: all of it
};
/// The deformed body in one panel, blocks filled by the field, with fractures and cracks as in draw_blocks.
/// Throws InputError where no block reaches into the window, and for an SVG or PDF of too many blocks.
[[nodiscard]] std::string draw_state(const BlockSystem& system, const FieldRecord& fields, const StatePlot& plot,
                                     PictureFormat format);

/// Bodies with more blocks than this are drawn as PNG only: an SVG would take longer to open than to compute.
inline constexpr int most_blocks_in_svg = 20000;

/// Before loading and after, side by side at one scale. After: deformed blocks filled by their major principal stress
/// (positive in compression) with a colour bar; fractures dark, sliding ones on amber; cracks red (tension) and blue
/// (shear), the thicker the more they have opened and slipped; an arrow on each block that moves on, with the sense of its turn where it
/// only turns.
/// Throws InputError for an SVG of too many blocks.
[[nodiscard]] std::string draw_blocks(const BlockSystem& system, const FieldRecord& fields, const BlocksPlot& plot,
                                      PictureFormat format);

/// The body before any run: blocks by material, mapped fractures, potential cracks, boundaries with their names.
[[nodiscard]] std::string draw_geometry(const BlockSystem& system, const BlocksPlot& plot, PictureFormat format);

/// The same, written in the format that the extension names. Throw InputError, ResourceError.
void write_blocks(const std::filesystem::path& path, const BlockSystem& system, const FieldRecord& fields,
                  const BlocksPlot& plot);
void write_geometry(const std::filesystem::path& path, const BlockSystem& system, const BlocksPlot& plot);

} // namespace kluft

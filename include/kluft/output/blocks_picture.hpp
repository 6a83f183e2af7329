// Pictures of the body: before and after a run side by side, and its geometry before any run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kluft/blocks/block_system.hpp"
#include "kluft/output/canvas.hpp"
#include "kluft/simulation/step_record.hpp"

namespace kluft {

/// What a picture of the body says beside the blocks themselves.
struct BlocksPlot {
    std::string title;
    std::string after = "after"; ///< above the deformed body
    double magnification = 1.0;  ///< of displacements
    std::vector<std::string> material_names;
    std::vector<bool> bonded_types; ///< one per interface type: whether it is a potential crack; for draw_geometry
};

/// The words above the deformed body after the given load steps.
[[nodiscard]] std::string after_title(const std::vector<StepRecord>& history);

/// Bodies with more blocks than this are drawn as PNG only: an SVG would take longer to open than to compute.
inline constexpr int most_blocks_in_svg = 20000;

/// Before loading and after, side by side at one scale. After: deformed blocks filled by their major principal stress
/// (positive in compression) with a colour bar; fractures dark, sliding ones on amber; cracks red (tension) and blue
/// (shear), the thicker the more they have opened and slipped.
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
